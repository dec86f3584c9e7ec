#include "app/fields/part_evaluator.h"

#include <limits>
#include <utility>

namespace raycone {
namespace {

// Outside of its box the winding number of a closed mesh is 0.
bool is_bounded(const MeshToEvaluate& part, const Rule& rule) { return part.edges.empty() && !holds(rule, 0.0); }

// The indices along an axis from the last one below `lower` to the first one above `upper`, as far as the lattice goes.
// Coordinates do not decrease with the index.
void restrict(LatticeBlock& block, const Lattice& lattice, int axis, double lower, double upper) {
  const auto a = static_cast<std::size_t>(axis);
  const auto first_where = [&](const auto& is_beyond) {
    std::int64_t begin = lattice.index_min[a], end = lattice.index_max(axis) + 1;
    while (begin < end) {
      const std::int64_t middle = begin + (end - begin) / 2;
      if (is_beyond(lattice.coordinate(axis, middle))) {
        end = middle;
      } else {
        begin = middle + 1;
      }
    }
    return begin;
  };
  const std::int64_t begin = first_where([&](double x) { return x >= lower; });
  const std::int64_t end = first_where([&](double x) { return x > upper; });
  block.first[a] = begin;
  block.counts[a] = end - begin;
}

}  // namespace

FieldOptions PartEvaluator::options_of(const FieldOptions& options) {
  FieldOptions of_part = options;
  of_part.fields = {Field::kInside};
  of_part.diagnostics = false;
  of_part.verify = 0;
  return of_part;
}

PartEvaluator::PartEvaluator(MeshToEvaluate part, const FieldOptions& options, double samples)
    : box_(bounding_box(part.mesh)),
      bounded_(is_bounded(part, options.rule)),
      evaluator_(std::move(part.mesh), options_of(options), &part.edges, samples) {}

LatticeBlock PartEvaluator::reach(const PlacedLattice& lattice, const MeshToEvaluate& part, const Rule& rule) {
  LatticeBlock block = whole(lattice.grid);
  if (!is_bounded(part, rule) || !lattice.along_axes()) return block;
  const Box box = bounding_box(part.mesh);
  for (int axis = 0; axis < 3; ++axis) restrict(block, lattice.grid, axis, box.lower[axis], box.upper[axis]);
  return block;
}

Interval PartEvaluator::reach_along_x() const {
  constexpr double kAll = std::numeric_limits<double>::infinity();
  return bounded_ ? Interval{box_.lower.x, box_.upper.x} : Interval{-kAll, kAll};
}

bool PartEvaluator::reaches(const Vec3& point) const {
  if (!bounded_) return true;
  for (int axis = 0; axis < 3; ++axis) {
    if (point[axis] < box_.lower[axis] || point[axis] > box_.upper[axis]) return false;
  }
  return true;
}

}  // namespace raycone
