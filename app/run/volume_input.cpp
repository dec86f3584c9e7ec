#include "app/run/volume_input.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>

#include "app/run/grid_reader.h"
#include "io/fields/read_image_lattice.h"
#include "io/fields/read_npz_lattice.h"

namespace raycone {
bool is_vdb(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;
  constexpr std::string_view kMagic(" BDV\0\0\0\0", 8);
  std::array<char, kMagic.size()> first{};
  std::ifstream file(path, std::ios::binary);
  file.read(first.data(), first.size());
  return file && std::string_view(first.data(), first.size()) == kMagic;
}

bool holds_values(const std::string& path) {
  if (path == "-") return false;
  // A damaged archive tells nothing but its name.
  return is_vdb(path) || is_image(path) || (is_npz(path) && (path.ends_with(".npz") || holds_arrays(path)));
}

VolumeFacts facts_of_file(const std::string& path) {
  return is_vdb(path) ? read_grid_facts(path) : read_volume_facts(path);
}

}  // namespace raycone
