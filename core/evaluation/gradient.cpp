#include "core/evaluation/gradient.h"

#include <quadmath.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/exact/quad.h"
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

QuadVec3 quad_difference(const Vec3& a, const Vec3& b) { return {Quad(a.x) - b.x, Quad(a.y) - b.y, Quad(a.z) - b.z}; }

// As GradientEvaluator::part(), for queries next to the segment and for numbers whose products leave the doubles.
Vec3 careful_part(const Vec3& from, const Vec3& to, double weight, const Vec3& q) {
  const QuadVec3 a = quad_difference(from, q), b = quad_difference(to, q);
  const Quad la = sqrtq(dot(a, a)), lb = sqrtq(dot(b, b)), ab = dot(a, b);
  const QuadVec3 normal = cross(la < lb ? a : b, quad_difference(to, from));
  const Quad square = dot(normal, normal);
  if (square == 0) return {};
  const Quad opening = ab < 0 ? square / (la * lb - ab) : la * lb + ab;
  const Quad factor = weight * ((la + lb) / (la * lb * opening));
  return {within_doubles(factor * normal.x), within_doubles(factor * normal.y), within_doubles(factor * normal.z)};
}

}  // namespace

GradientEvaluator::GradientEvaluator(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges)
    : scale_(unit_scale(mesh)), inverse_(-scale_.exponent()) {
  segments_.reserve(edges.size());
  for (const ExteriorEdge& edge : edges) {
    const Vec3 from = scale_(mesh.vertices[edge.from]), to = scale_(mesh.vertices[edge.to]);
    segments_.push_back({from, to, to - from, edge.multiplicity / (4.0 * std::numbers::pi)});
  }
}

// (a x b) (|a| + |b|) / (|a| |b| (|a| |b| + a b)) for the ends a, b as the query sees them. Where the angle between
// them is obtuse, the last factor is |a x b|^2 / (|a| |b| - a b).
Vec3 GradientEvaluator::part(const Segment& segment, const Vec3& q) {
  constexpr double kLeast = 0x1p-400, kMost = 0x1p400;  // of squares
  constexpr double kNear = 0x1p-16;                     // of a sine's square: the cross product loses eight bits
  const Vec3 a = segment.from - q, b = segment.to - q;
  const double aa = dot(a, a), bb = dot(b, b), ab = dot(a, b);
  const Vec3 normal = cross(aa < bb ? a : b, segment.step);
  const double square = dot(normal, normal);
  const bool in_range = std::min(aa, bb) >= kLeast && std::max(aa, bb) <= kMost;
  if (!in_range || square < kNear * (std::min(aa, bb) * dot(segment.step, segment.step))) {
    return careful_part(segment.from, segment.to, segment.weight, q);
  }
  const double la = std::sqrt(aa), lb = std::sqrt(bb), lab = la * lb;
  const double opening = ab < 0.0 ? square / (lab - ab) : lab + ab;
  return segment.weight * ((la + lb) / (lab * opening)) * normal;
}

Vec3 GradientEvaluator::sum_in_scale(const Vec3& point) const {
  const Vec3 q = scale_(point);
  // So far away that the gradient is no double but 0.
  if (!std::isfinite(q.x) || !std::isfinite(q.y) || !std::isfinite(q.z)) return {};
  Vec3 sum;
  for (const Segment& segment : segments_) sum = sum + part(segment, q);
  return scale_(within_doubles(sum));
}

// Scaling the mesh lost nothing, so that it can be undone.
Vec3 GradientEvaluator::sum_unscaled(const Vec3& point) const {
  Vec3 sum;
  for (const Segment& s : segments_) sum = sum + careful_part(inverse_(s.from), inverse_(s.to), s.weight, point);
  return sum;
}

Vec3 GradientEvaluator::at(const Vec3& point) const {
  const bool fits = scale_.keeps(point.x) && scale_.keeps(point.y) && scale_.keeps(point.z);
  return within_doubles(fits ? sum_in_scale(point) : sum_unscaled(point)) + Vec3{0.0, 0.0, 0.0};  // no -0
}

template <class Point>
void GradientEvaluator::evaluate_each(const Point& point, std::span<Vec3> values,
                                      std::atomic<std::uint64_t>* done) const {
  constexpr std::size_t kTerms = std::size_t{1} << 16;  // per task
  const std::size_t grain = std::max<std::size_t>(1, kTerms / (segments_.size() + 1));
  parallel_for(values.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) values[n] = segments_.empty() ? Vec3{} : at(point(n));
    if (done) done->fetch_add(end - begin, std::memory_order_relaxed);
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
