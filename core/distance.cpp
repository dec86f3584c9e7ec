#include "core/distance.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <vector>

#include "core/distance_band.h"
#include "core/distance_tree.h"
#include "core/floating_point.h"
#include "core/scale.h"
#include "core/threads.h"

namespace raycone {
namespace {

constexpr std::size_t kPointsPerTask = 256;

// From here on a mesh of coordinates up to 1 is a point at the origin, to the last bit.
constexpr double kFar = 0x1p55;
double largest_coordinate(const Vec3& p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); }

// Its squares neither overflow nor vanish.
double length(const Vec3& p) {
  int exponent = 0;
  std::frexp(largest_coordinate(p), &exponent);
  const Vec3 q = PowerOfTwo(-exponent)(p);
  return std::min(PowerOfTwo(exponent)(std::sqrt(dot(q, q))), std::numeric_limits<double>::max());
}

}  // namespace

struct DistanceEvaluator::Implementation {
  explicit Implementation(const TriangleMesh& original)
      : exponent(largest_exponent(original)), to_unit(-exponent), to_world(exponent), mesh(original) {
    for (Vec3& p : mesh.vertices) p = to_unit(p);
  }

  [[nodiscard]] const DistanceTree& nearest() const {
    std::call_once(tree_built, [this] { tree.emplace(mesh); });
    return *tree;
  }

  [[nodiscard]] double distance_at(const Vec3& point) const {
    const Vec3 p = to_unit(point);
    if (!(largest_coordinate(p) <= kFar)) return length(point);
    return to_world(std::sqrt(nearest().squared_distance(p)));
  }

  // The largest coordinate is brought into [1/2, 1): nothing overflows, and what gets lost at the other end is less
  // than 1e-300 of it.
  int exponent;
  PowerOfTwo to_unit, to_world;
  TriangleMesh mesh;

 private:
  mutable std::once_flag tree_built;
  mutable std::optional<DistanceTree> tree;
};

DistanceEvaluator::DistanceEvaluator(const TriangleMesh& mesh) {
  const DefaultFloatingPoint guard;
  implementation_ = std::make_unique<Implementation>(mesh);
}
DistanceEvaluator::~DistanceEvaluator() = default;
DistanceEvaluator::DistanceEvaluator(DistanceEvaluator&&) noexcept = default;
DistanceEvaluator& DistanceEvaluator::operator=(DistanceEvaluator&&) noexcept = default;

void DistanceEvaluator::evaluate(const Lattice& lattice, const LatticeBlock& block, double band,
                                 std::span<double> distances) const {
  assert(distances.size() == static_cast<std::size_t>(block.size()));
  const DefaultFloatingPoint guard;
  const Implementation& engine = *implementation_;
  LatticeRows rows;
  const std::array<std::vector<double>*, 3> axes{&rows.xs, &rows.ys, &rows.zs};
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    for (std::int64_t i = 0; i < block.counts[a]; ++i) {
      axes[a]->push_back(std::clamp(engine.to_unit(lattice.coordinate(axis, block.first[a] + i)), -kFar, kFar));
    }
    const double width = axes[a]->back() - axes[a]->front();
    const double per_unit = static_cast<double>(block.counts[a] - 1) / width;
    rows.samples_per_unit[axis] = std::isfinite(per_unit) ? per_unit : 0.0;
  }
  const double unit_band = std::min(engine.to_unit(band), kFar);
  if (descent_is_faster(engine.mesh, unit_band)) {
    descend_to_distances(engine.nearest(), rows, unit_band, distances);
  } else {
    rasterize_distances(engine.mesh, rows, unit_band, distances);
  }
  constexpr std::size_t kGrain = std::size_t{1} << 14;
  parallel_for(distances.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) distances[n] = std::min(engine.to_world(std::sqrt(distances[n])), band);
  });
}

void DistanceEvaluator::prepare_points() const { (void)implementation_->nearest(); }

void DistanceEvaluator::evaluate(std::span<const Vec3> points, std::span<double> distances) const {
  assert(distances.size() == points.size());
  parallel_for(points.size(), kPointsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) distances[n] = implementation_->distance_at(points[n]);
  });
}

}  // namespace raycone
