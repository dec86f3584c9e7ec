#include "app/input/grid_lattice.h"

#include <filesystem>
#include <optional>
#include <string>
#include <system_error>

#include "app/input/grid_reader.h"
#include "app/input/volume_input.h"
#include "app/process/usage_error.h"
#include "io/fields/read_image_lattice.h"
#include "io/fields/read_npz_lattice.h"

namespace raycone {

PlacedLattice lattice_of_grid(const GridReference& grid) {
  if (is_image(grid.path)) return read_image_lattice(grid.path);
  if (is_npz(grid.path)) return read_npz_lattice(grid.path);
  std::error_code error;  // of what is no file, the reader says why
  if (std::filesystem::is_regular_file(grid.path, error) && !is_vdb(grid.path)) fail_as_unknown_volume(grid.path);
  return read_grid_lattice(grid.path, grid.name);
}

Lattice world_lattice_of_grid(const GridReference& grid, const char* purpose) {
  const std::optional<WorldOrder> order = world_order(lattice_of_grid(grid));
  if (order) return order->lattice;
  throw UsageError(std::string(purpose) + ": --like " + grid.path +
                   ": the grid's axes are turned, expected those of the world");
}

}  // namespace raycone
