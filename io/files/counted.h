// Counts in messages.
#pragma once

#include <cstdint>
#include <string>

namespace raycone {

// "faces", "vertices", "meshes".
[[nodiscard]] inline std::string plural_of(const std::string& singular) {
  if (singular.ends_with("ex")) return singular.substr(0, singular.size() - 2) + "ices";
  return singular + (singular.ends_with("sh") ? "es" : "s");
}

// "1 face", "2 faces", "0 vertices".
[[nodiscard]] inline std::string counted(std::uint64_t count, const std::string& singular) {
  return std::to_string(count) + ' ' + (count == 1 ? singular : plural_of(singular));
}

}  // namespace raycone
