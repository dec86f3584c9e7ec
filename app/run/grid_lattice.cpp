#include "app/run/grid_lattice.h"

#include <optional>
#include <string>

#include "app/process/usage_error.h"
#include "app/run/grid_reader.h"
#include "io/fields/read_image_lattice.h"
#include "io/fields/read_npz_lattice.h"

namespace raycone {

PlacedLattice lattice_of_grid(const GridReference& grid) {
  if (is_image(grid.path)) return read_image_lattice(grid.path);
  return is_npz(grid.path) ? read_npz_lattice(grid.path) : read_grid_lattice(grid.path, grid.name);
}

Lattice world_lattice_of_grid(const GridReference& grid, const char* purpose) {
  const std::optional<WorldOrder> order = world_order(lattice_of_grid(grid));
  if (order) return order->lattice;
  throw UsageError(std::string(purpose) + ": --like " + grid.path +
                   ": the grid's axes are turned, expected those of the world");
}

}  // namespace raycone
