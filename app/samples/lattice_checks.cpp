#include "app/samples/lattice_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/process/usage_error.h"
#include "io/files/ascii.h"
#include "io/files/file_error.h"
#include "io/files/half.h"

namespace raycone {
namespace {

// A level set has one voxel size.
void check_cubic(const char* field, const PlacedLattice& lattice, const std::string& remedy) {
  const bool turned = !world_order(lattice).has_value();
  if (lattice.is_cubic(turned ? 1e-5 : 1e-12)) return;  // of matrices in 32 bits; of sides divided by counts
  const Vec3& spacing = lattice.grid.spacing;
  const std::string sides =
      with_digits(spacing.x, 9) + " x " + with_digits(spacing.y, 9) + " x " + with_digits(spacing.z, 9);
  const char* const axes = lattice.is_orthogonal(1e-5) ? "" : " whose axes are not at right angles";
  throw UsageError("--field " + std::string(field) + ": voxels of " + sides + axes + ", expected cubic ones (" +
                   remedy + ')');
}

// The largest number that `format` holds.
double largest_stored(FieldFormat format, const OutputDescription& description) {
  const bool any = is_text(format) || format == FieldFormat::kNone;
  if (any || description.is(Precision::kDouble)) return std::numeric_limits<double>::infinity();
  return description.is(Precision::kHalf) ? kLargestHalf : std::numeric_limits<float>::max();
}

// Below, numbers of `format` lose digits.
double least_stored(FieldFormat format, const OutputDescription& description) {
  const double largest = largest_stored(format, description);
  if (std::isinf(largest)) return 0.0;
  return largest == kLargestHalf ? kLeastHalf : std::numeric_limits<float>::min();
}

std::string expected_instead_of(int bits) {
  return "; expected --dtype f" + std::to_string(2 * bits) + ", or another --scale";
}

}  // namespace

void check_axes(const PlacedLattice& lattice, const FieldOptions& field, const std::string& remedy) {
  if (field.has(Field::kDistance)) check_cubic("sdf", lattice, remedy);
  if (!field.has(Field::kSolid)) return;
  check_cubic("solid", lattice, remedy);
  if (world_order(lattice)) return;  // the surface is made along these axes
  throw UsageError("--field solid: a lattice whose axes are not the world's, expected --field sdf, or another --like");
}

bool cuts_off(double band, const Lattice& lattice) {
  return band < static_cast<double>(std::ranges::max(lattice.counts));
}

void check_digits(const std::string& output, const PlacedLattice& lattice, const FieldOptions& field,
                  FieldFormat format, const OutputDescription& description) {
  if (!field.has_distance()) return;
  const double largest = largest_stored(format, description), most = field.band * lattice.grid.spacing.x;
  const bool half = largest == kLargestHalf;
  const int bits = half ? 16 : 32;
  if (most > largest && (!half || cuts_off(field.band, lattice.grid))) {
    throw OutputError(output + ": distances of up to " + with_digits(most, 6) + " are beyond " +
                      with_digits(largest, 6) + ", the range of " + std::to_string(bits) + " bits" +
                      expected_instead_of(bits));
  }
  const double least = least_stored(format, description), voxel = lattice.grid.least_spacing();
  if (format == FieldFormat::kVdb || voxel >= least) return;  // VDB has its own limits (io/vdb/check_lattice.h)
  throw OutputError(output + ": a voxel of " + with_digits(voxel, 2) + " is below " + with_digits(least, 2) +
                    ", where distances of " + std::to_string(bits) + " bits lose digits" + expected_instead_of(bits));
}

}  // namespace raycone
