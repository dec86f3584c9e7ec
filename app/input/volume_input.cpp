#include "app/input/volume_input.h"

#include <string_view>

#include "app/input/grid_reader.h"
#include "io/fields/read_image_lattice.h"
#include "io/fields/read_npz_lattice.h"
#include "io/files/read_file.h"

namespace raycone {

bool is_vdb(const std::string& path) { return file_starts_with(path, std::string_view(" BDV\0\0\0\0", 8)); }

bool holds_values(const std::string& path) {
  if (path == "-") return false;
  // A damaged archive tells nothing but its name.
  return is_vdb(path) || is_image(path) || (is_npz(path) && (path.ends_with(".npz") || holds_arrays(path)));
}

VolumeFacts facts_of_file(const std::string& path) {
  return is_vdb(path) ? read_grid_facts(path) : read_volume_facts(path);
}

}  // namespace raycone
