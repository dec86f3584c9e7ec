// Each sampling yields an axis at a time; the padding in voxels comes last, so that it moves no sample.
#include "app/samples/lattice_choice.h"

#include <algorithm>
#include <cmath>

#include "app/process/usage_error.h"
#include "io/files/ascii.h"
#include "io/files/file_error.h"

namespace raycone {
namespace {

// Indices up to here are doubles, as the coordinates' formula needs.
constexpr double kMaxIndex = 0x1p53;

// Axis `axis` of `lattice`.
void set_axis(Lattice& lattice, int axis, double origin, double spacing, std::int64_t index_min, std::int64_t count) {
  const auto a = static_cast<std::size_t>(axis);
  lattice.origin[axis] = origin;
  lattice.spacing[axis] = spacing;
  lattice.index_min[a] = index_min;
  lattice.counts[a] = count;
}

std::int64_t index_from(double value) {
  if (!(std::abs(value) <= kMaxIndex)) {
    throw LimitError("the lattice would need the index " + with_digits(value, 6) + ", expected at most " +
                     with_digits(kMaxIndex, 6) + "; voxels are too small so far from the origin, see --voxel-size");
  }
  return static_cast<std::int64_t>(value);
}

Lattice sample(const Box& box, const LongestSide& request, bool centers) {
  const Vec3 sides = box.upper - box.lower;
  const double length = longest_side(box);
  const auto intervals = static_cast<double>(centers ? request.count : std::max<std::int64_t>(request.count - 1, 1));
  // A box without extent has one sample whatever the spacing.
  const double spacing = length > 0.0 ? length / intervals : 1.0;
  Lattice lattice;
  for (int axis = 0; axis < 3; ++axis) {
    const double side = sides[axis];
    const double covering = std::ceil(side / spacing - kRoundingSlack);
    if (side == 0.0) {
      set_axis(lattice, axis, box.lower[axis], spacing, 0, 1);
    } else if (centers) {
      set_axis(lattice, axis, box.lower[axis] + spacing / 2, spacing, 0, index_from(std::max(covering, 1.0)));
    } else if (request.count == 1) {
      set_axis(lattice, axis, box.lower[axis] + side / 2, spacing, 0, 1);
    } else {
      set_axis(lattice, axis, box.lower[axis], spacing, 0, 1 + index_from(covering));
    }
  }
  return lattice;
}

// The spacing of the shortest side that is not flat; 1 if all are.
double spacing_of_flat_sides(const Vec3& sides, const Vec3& spacing) {
  double shortest = 0.0;
  double result = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    if (sides[axis] == 0.0 || (shortest > 0.0 && sides[axis] >= shortest)) continue;
    shortest = sides[axis];
    result = spacing[axis];
  }
  return result;
}

// Sides that got one sample, and how many were asked for.
class FlatSides {
 public:
  void add(int axis, std::int64_t asked) {
    const std::string separator = axes_.empty() ? "" : " and ";
    axes_ += separator + "xyz"[axis];
    asked_ += separator + std::to_string(asked);
  }

  void warn(std::vector<Warning>& warnings) const {
    if (axes_.empty()) return;
    warnings.push_back(
        {"flat-box", "the box is flat along " + axes_ + ", and sampled once there, not " + asked_ + " times"});
  }

 private:
  std::string axes_, asked_;
};

Lattice sample(const Box& box, const SampleCounts& request, bool centers, std::vector<Warning>& warnings) {
  const Vec3 sides = box.upper - box.lower;
  Lattice lattice;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t count = request.counts[static_cast<std::size_t>(axis)];
    const std::int64_t intervals = centers ? count : std::max<std::int64_t>(count - 1, 1);
    const double spacing = sides[axis] / static_cast<double>(intervals);
    const bool ends_included = count > 1 && !centers;
    set_axis(lattice, axis, box.lower[axis] + (ends_included ? 0.0 : spacing / 2), spacing, 0, count);
  }
  const double flat_spacing = spacing_of_flat_sides(sides, lattice.spacing);
  FlatSides flat;
  for (int axis = 0; axis < 3; ++axis) {
    if (sides[axis] != 0.0) continue;
    set_axis(lattice, axis, box.lower[axis], flat_spacing, 0, 1);
    const std::int64_t asked = request.counts[static_cast<std::size_t>(axis)];
    if (asked > 1) flat.add(axis, asked);
  }
  flat.warn(warnings);
  return lattice;
}

Lattice sample(const Box& box, const VoxelSize& request, bool centers) {
  Lattice lattice;
  for (int axis = 0; axis < 3; ++axis) {
    const double size = request.size[axis];
    const std::int64_t first = index_from(std::floor(box.lower[axis] / size));
    const std::int64_t end = index_from(std::ceil(box.upper[axis] / size));
    const std::int64_t last = centers ? std::max(first, end - 1) : end;
    set_axis(lattice, axis, centers ? size / 2 : 0.0, size, first, last - first + 1);
  }
  return lattice;
}

Lattice sample(const Box& box, const LatticeRequest& request, std::vector<Warning>& warnings) {
  if (const auto* longest_side = std::get_if<LongestSide>(&request.sampling)) {
    return sample(box, *longest_side, request.centers);
  }
  if (const auto* counts = std::get_if<SampleCounts>(&request.sampling)) {
    return sample(box, *counts, request.centers, warnings);
  }
  return sample(box, std::get<VoxelSize>(request.sampling), request.centers);
}

void add_samples(Lattice& lattice, const Layers& layers) {
  for (std::size_t a = 0; a < 3; ++a) {
    lattice.index_min[a] -= layers[a];
    lattice.counts[a] += 2 * layers[a];
  }
}

void add_samples(Lattice& lattice, const VoxelPadding& padding) {
  if (std::abs(static_cast<double>(padding.samples)) > kMaxIndex / 4) {
    throw LimitError("--padding " + std::to_string(padding.samples) + "v: too many samples");
  }
  add_samples(lattice, Layers{padding.samples, padding.samples, padding.samples});
  for (std::size_t a = 0; a < 3; ++a) {
    if (lattice.counts[a] >= 1) continue;
    throw UsageError("--padding " + std::to_string(padding.samples) + "v: leaves no sample along " + "xyz"[a]);
  }
}

void check_finite(const Box& box) {
  if (std::isfinite(longest_side(box))) return;
  throw LimitError("the box is too large for double precision; see --scale");
}

// Padding in voxels may lead out of the doubles.
void check_finite(const Lattice& lattice) {
  for (int axis = 0; axis < 3; ++axis) {
    const double first = lattice.coordinate(axis, lattice.index_min[static_cast<std::size_t>(axis)]);
    if (std::isfinite(first) && std::isfinite(lattice.coordinate(axis, lattice.index_max(axis)))) continue;
    throw LimitError("the lattice is too large for double precision; see --scale");
  }
}

void check_positive_spacing(const Lattice& lattice) {
  if (lattice.least_spacing() > 0.0) return;
  throw LimitError("the lattice's spacing is too small for double precision; see --scale");
}

}  // namespace

Box widened(Box box, const WorldPadding& padding) {
  const double width = padding.percent ? padding.width / 100.0 * longest_side(box) : padding.width;
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] -= width;
    box.upper[axis] += width;
    if (box.lower[axis] > box.upper[axis])
      throw UsageError("--padding " + with_digits(padding.width, 6) + (padding.percent ? "%" : "") +
                       ": leaves nothing of the box");
  }
  return box;
}

Lattice with_layers(Lattice lattice, const Layers& layers) {
  add_samples(lattice, layers);
  check_finite(lattice);
  return lattice;
}

Layers layers_around(const std::variant<LatticeRequest, GridReference>& asked) {
  const auto* const request = std::get_if<LatticeRequest>(&asked);
  const auto* const padding = request ? std::get_if<VoxelPadding>(&request->padding) : nullptr;
  const std::int64_t layers = padding && padding->samples > 0 ? 0 : 1;
  return {layers, layers, layers};
}

Lattice choose_lattice(const Box& mesh_box, const LatticeRequest& request, std::vector<Warning>& warnings) {
  Box box = request.bounds.value_or(mesh_box);
  if (const auto* padding = std::get_if<WorldPadding>(&request.padding)) box = widened(box, *padding);
  check_finite(box);
  Lattice lattice = sample(box, request, warnings);
  check_positive_spacing(lattice);
  if (const auto* padding = std::get_if<VoxelPadding>(&request.padding)) add_samples(lattice, *padding);
  check_finite(lattice);
  return lattice;
}

std::uint64_t sample_count(const Lattice& lattice) {
  const auto [x, y, z] = lattice.counts;
  const double samples = static_cast<double>(x) * static_cast<double>(y) * static_cast<double>(z);
  if (!(samples < 0x1p62))
    throw LimitError("the lattice would have " + with_digits(samples, 6) + " samples, expected less than 2^62");
  for (std::size_t a = 0; a < 3; ++a) {
    if (lattice.counts[a] <= kMaxBlockSide) continue;
    throw LimitError("the lattice would have " + std::to_string(lattice.counts[a]) + " samples along " + "xyz"[a] +
                     ", expected at most " + std::to_string(kMaxBlockSide));
  }
  return static_cast<std::uint64_t>(x) * static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(z);
}

}  // namespace raycone
