// Numbers as the bytes of files.
#pragma once

#include <cstring>
#include <initializer_list>
#include <string>
#include <vector>

namespace raycone::test {

// In the byte order of this machine, or the other one.
template <class Number>
[[nodiscard]] std::string bytes_of(const std::vector<Number>& numbers, bool reversed = false) {
  std::string bytes;
  for (const Number number : numbers) {
    std::string one(sizeof number, '\0');
    std::memcpy(one.data(), &number, sizeof number);
    bytes += reversed ? std::string(one.rbegin(), one.rend()) : one;
  }
  return bytes;
}

template <class Number>
[[nodiscard]] std::string bytes_of(std::initializer_list<Number> numbers, bool reversed = false) {
  return bytes_of(std::vector<Number>(numbers), reversed);
}

}  // namespace raycone::test
