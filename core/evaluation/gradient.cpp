#include "core/evaluation/gradient.h"

#include <quadmath.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>

#include "core/boundary/sample_tile.h"
#include "core/exact/exact_determinant.h"
#include "core/exact/quad.h"
#include "core/machine/floating_point.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

double within_doubles(Quad x) {
  constexpr double kMost = std::numeric_limits<double>::max();
  if (absolute(x) > Quad(kMost)) return x < 0 ? -kMost : kMost;
  return static_cast<double>(x);
}

Vec3 within_doubles(const Vec3& v) {
  constexpr double kMost = std::numeric_limits<double>::max();
  return {std::clamp(v.x, -kMost, kMost), std::clamp(v.y, -kMost, kMost), std::clamp(v.z, -kMost, kMost)};
}

// What an edge adds, for queries next to it and for numbers whose products leave the doubles.
QuadVec3 careful_part(const Vec3& from, const Vec3& to, double weight, const Vec3& q) {
  const QuadVec3 a = quad_difference(from, q), b = quad_difference(to, q);
  const Quad la = sqrtq(dot(a, a)), lb = sqrtq(dot(b, b)), ab = dot(a, b);
  const QuadVec3 normal = cross_of_differences(from, to, q);
  const Quad square = dot(normal, normal);
  if (square == 0) return {0, 0, 0};
  const Quad opening = ab < 0 ? square / (la * lb - ab) : la * lb + ab;
  const Quad factor = weight * ((la + lb) / (la * lb * opening));
  return factor * normal;
}

// Infinite where no double holds it.
Vec3 careful_part_of(const GradientSegment& segment, const Vec3& q) {
  const QuadVec3 part = careful_part(segment.from, segment.to, segment.weight, q);
  return {static_cast<double>(part.x), static_cast<double>(part.y), static_cast<double>(part.z)};
}

PowerOfTwo scale_of(const TriangleMesh& mesh) {
  const DefaultFloatingPoint guard;
  return unit_scale(mesh);
}

constexpr Vec3 kNoMinusZero{0.0, 0.0, 0.0};  // to be added

}  // namespace

GradientEvaluator::GradientEvaluator(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges, SimdLevel level)
    : scale_(scale_of(mesh)), inverse_(-scale_.exponent()), sum_parts_(gradient_kernel(level)) {
  const DefaultFloatingPoint guard;
  segments_.reserve(edges.size());
  for (const ExteriorEdge& edge : edges) {
    const Vec3 from = scale_(mesh.vertices[edge.from]), to = scale_(mesh.vertices[edge.to]);
    const bool joined = !segments_.empty() && from == segments_.back().to;
    segments_.push_back({from, to, to - from, edge.multiplicity / (4.0 * std::numbers::pi), joined});
  }
}

// For queries that leave the doubles where the mesh is scaled, or whose parts do: these may cancel. Scaling the mesh
// lost nothing, so that it can be undone.
Vec3 GradientEvaluator::sum_unscaled(const Vec3& point) const {
  QuadVec3 sum{0, 0, 0};
  for (const GradientSegment& s : segments_) {
    sum = sum + careful_part(inverse_(s.from), inverse_(s.to), s.weight, point);
  }
  return Vec3{within_doubles(sum.x), within_doubles(sum.y), within_doubles(sum.z)} + kNoMinusZero;
}

// Of kTile points at most. value(n) is where that of point n belongs.
template <class Point, class Value>
void GradientEvaluator::evaluate_tile(std::size_t count, const Point& point, const Value& value) const {
  constexpr double kFar = 0x1p400;  // beyond, parts lose bits by underflow
  SampleTile tile;
  std::array<std::size_t, kTile> numbers;
  for (std::size_t n = 0; n < count; ++n) {
    const Vec3 p = point(n), q = scale_(p);
    if (!is_finite(q)) {
      value(n) = {};  // so far away that the gradient is no double but 0
    } else if (largest_coordinate(q) < kFar && scale_.keeps(p.x) && scale_.keeps(p.y) && scale_.keeps(p.z)) {
      numbers[tile.count] = n;
      tile.add(q);
    } else {
      value(n) = sum_unscaled(p);
    }
  }
  if (tile.count == 0) return;
  tile.fill_up();
  GradientTile sums;
  sum_parts_(segments_, tile, careful_part_of, sums);
  for (std::size_t i = 0; i < tile.count; ++i) {
    const Vec3 sum{sums.x[i], sums.y[i], sums.z[i]};
    value(numbers[i]) = is_finite(sum) ? within_doubles(scale_(sum)) + kNoMinusZero : sum_unscaled(point(numbers[i]));
  }
}

template <class Point>
void GradientEvaluator::evaluate_each(const Point& point, std::span<Vec3> values,
                                      std::atomic<std::uint64_t>* done) const {
  if (segments_.empty()) std::ranges::fill(values, Vec3{});
  const std::size_t tiles = (values.size() + kTile - 1) / kTile;
  parallel_for(tiles, 1, [&](std::size_t begin, std::size_t end) {
    const std::size_t first = begin * kTile, last = std::min(end * kTile, values.size());
    for (std::size_t at = first; at < last && !segments_.empty(); at += kTile) {
      evaluate_tile(
          std::min(kTile, last - at), [&](std::size_t n) { return point(at + n); },
          [&](std::size_t n) -> Vec3& { return values[at + n]; });
    }
    if (done) done->fetch_add(last - first, std::memory_order_relaxed);
  });
}

void GradientEvaluator::evaluate(const Lattice& lattice, const LatticeBlock& block, std::span<Vec3> values,
                                 std::atomic<std::uint64_t>* done) const {
  evaluate_each([&](std::size_t n) { return lattice.position(block.index_of(n)); }, values, done);
}

void GradientEvaluator::evaluate(std::span<const Vec3> points, std::span<Vec3> values,
                                 std::atomic<std::uint64_t>* done) const {
  evaluate_each([&](std::size_t n) { return points[n]; }, values, done);
}

}  // namespace raycone
