#include "io/vdb/check_lattice.h"

#include <cmath>
#include <cstdio>

#include "io/fields/index_range.h"
#include "io/files/file_error.h"
#include "io/files/half.h"

namespace raycone::vdb {
namespace {

// Of the voxel that OpenVDB gives to copies of a grid, also while it writes one: the difference of two positions.
double copied_volume(PlacedLattice lattice) {
  for (Vec3& step : lattice.steps) step = (lattice.origin + step) - lattice.origin;
  return std::abs(lattice.signed_volume());
}

// OpenVDB takes a transform whose determinant is below 3e-15 for singular, however well scaled it is.
void check_voxels(const PlacedLattice& lattice, const std::string& name) {
  constexpr double kLeastVolume = 3e-15;
  const Vec3& spacing = lattice.grid.spacing;
  const double volume = std::abs(lattice.signed_volume());
  char message[200];
  if (volume < kLeastVolume) {
    const double mean_exponent = (std::log10(spacing.x) + std::log10(spacing.y) + std::log10(spacing.z)) / 3;
    std::snprintf(message, sizeof message,
                  ": voxel volume %.2g is below 3e-15, which OpenVDB cannot represent; scale the mesh (--scale 1e%.0f)",
                  volume, -std::floor(mean_exponent));
    throw OutputError(name + message);
  }
  if (!(copied_volume(lattice) >= kLeastVolume)) {  // infinity times 0 is refused, too
    std::snprintf(message, sizeof message,
                  ": voxels of %.2g x %.2g x %.2g at (%.2g, %.2g, %.2g) are too small beside their coordinates, which "
                  "OpenVDB cannot represent; expected larger ones, or bounds nearer to 0",
                  spacing.x, spacing.y, spacing.z, lattice.origin.x, lattice.origin.y, lattice.origin.z);
    throw OutputError(name + message);
  }
}

void check_half(const OutputDescription& description, const Lattice& lattice, const std::string& name) {
  if (!description.is(Precision::kHalf)) return;
  for (const FieldDescription& field : description.fields) {
    if (field.kind != FieldKind::kDistance) continue;
    if (lattice.spacing.x >= kLeastHalf && field.background <= kLargestHalf) continue;
    char message[160];
    std::snprintf(
        message, sizeof message,
        ": distances from one voxel, %.2g, to the band's %.2g are not in the range 6.2e-5 to 65504 of --half; "
        "scale the mesh (--scale)",
        lattice.spacing.x, field.background);
    throw OutputError(name + message);
  }
}

}  // namespace

void check_lattice(const PlacedLattice& lattice, const OutputDescription& description, const std::string& name) {
  check_32_bit_indices(lattice.grid, "OpenVDB", name);
  check_voxels(lattice, name);
  check_half(description, lattice.grid, name);
}

}  // namespace raycone::vdb
