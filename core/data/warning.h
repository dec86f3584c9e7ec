// What a user should know about a mesh that is evaluated all the same.
#pragma once

#include <string>

namespace raycone {

struct Warning {
  std::string name;  // of its kind, for scripts: small letters and hyphens, such as "skipped-faces"
  std::string text;  // for people, with the count: "3 faces with fewer than three corners skipped"

  friend bool operator==(const Warning&, const Warning&) = default;
};

// "skipped-faces: 3 faces with fewer than three corners skipped"
[[nodiscard]] inline std::string line_of(const Warning& warning) { return warning.name + ": " + warning.text; }

}  // namespace raycone
