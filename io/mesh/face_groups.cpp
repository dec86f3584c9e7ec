#include "io/mesh/face_groups.h"

namespace raycone {

std::string cut_name(std::string_view name) {
  if (name.size() < kMostOfName) return std::string(name);
  name = name.substr(0, kMostOfName);
  constexpr std::size_t kMostBytes = 4;  // of a character
  for (std::size_t back = 1; back < kMostBytes; ++back) {
    const auto byte = static_cast<unsigned char>(name[name.size() - back]);
    if ((byte & 0xC0U) == 0x80) continue;  // neither its first nor its only one
    const std::size_t bytes = byte >= 0xF0 ? 4 : byte >= 0xE0 ? 3 : byte >= 0xC0 ? 2 : 1;
    if (bytes > back) name.remove_suffix(back);
    break;
  }
  return std::string(name);
}

}  // namespace raycone
