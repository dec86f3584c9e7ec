// What errors say.
#pragma once

#include <string>

namespace raycone::test {

// What the Error that an action throws says; empty where it throws none.
template <class Error, class Action>
[[nodiscard]] std::string error_text(const Action& action) {
  try {
    static_cast<void>(action());
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace raycone::test
