// Numbers in messages and titles.
#pragma once

#include <cstdio>
#include <string>

namespace raycone {

// With six significant digits.
[[nodiscard]] inline std::string six_digits(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", number);
  return text;
}

}  // namespace raycone
