// Sizes in messages.
#pragma once

#include <cstddef>
#include <cstdio>
#include <iterator>
#include <string>

namespace raycone {

// "8 GB", "34 GB", "1.5 MB": powers of 1024, as --memory-limit reads them.
[[nodiscard]] inline std::string readable_bytes(double bytes) {
  constexpr const char* kUnits[] = {"bytes", "kB", "MB", "GB", "TB", "PB", "EB"};
  std::size_t unit = 0;
  for (; bytes >= 1024.0 && unit + 1 < std::size(kUnits); ++unit) bytes /= 1024.0;
  char text[64];
  if (bytes == 1.0 && unit == 0) return "1 byte";
  std::snprintf(text, sizeof text, bytes < 10.0 && unit > 0 ? "%.2g %s" : "%.0f %s", bytes, kUnits[unit]);
  return text;
}

}  // namespace raycone
