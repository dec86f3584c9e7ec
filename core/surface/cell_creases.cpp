#include "core/surface/cell_creases.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <tuple>

#include "core/surface/edge_crossing.h"
#include "core/surface/planes_point.h"

namespace raycone {
namespace {

constexpr double kFlat = 0.99999847691328772;   // cos 0.1 degrees
constexpr double kBlunt = 0.96592582628906829;  // cos 15 degrees

constexpr double kTouch = 1e-9;  // of barycentric coordinates, where a crease only touches a tetrahedron

// A triangle's side, from the lower vertex to the higher one or back.
struct SideUse {
  std::uint32_t low, high, triangle;
  std::uint8_t side;
  bool forward;
};

std::vector<SideUse> uses_of(const TriangleMesh& mesh) {
  std::vector<SideUse> uses;
  uses.reserve(3 * mesh.triangles.size());
  for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
    const Triangle& t = mesh.triangles[triangle];
    for (std::uint8_t side = 0; side < 3; ++side) {
      const std::uint32_t a = t[side], b = t[(side + 1U) % 3U];
      if (a != b) uses.push_back({std::min(a, b), std::max(a, b), triangle, side, a < b});
    }
  }
  std::ranges::sort(uses, {}, [](const SideUse& use) { return std::tuple(use.low, use.high, use.triangle, use.side); });
  return uses;
}

Vec3 normal_of(const TriangleMesh& mesh, std::uint32_t triangle) {
  const Triangle& t = mesh.triangles[triangle];
  return unit_normal(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
}

// Of the angle between two triangles at an edge of both.
double cosine_at(const TriangleMesh& mesh, const SideUse& a, const SideUse& b) {
  const double cosine = dot(normal_of(mesh, a.triangle), normal_of(mesh, b.triangle));
  return a.forward == b.forward ? -cosine : cosine;
}

// The part of a line that is within a tetrahedron, as a range of its parameter from 0 to 1.
struct LinePart {
  double begin = 0.0, end = 1.0;

  // Cuts off where a weight that goes from `first` to `last` is negative by more than rounding.

  void cut(double first, double last) {
    if (first < 0.0) begin = last > 0.0 ? std::max(begin, first / (first - last)) : 2.0;
    if (last < 0.0) end = first > 0.0 ? std::min(end, first / (first - last)) : -1.0;
  }
};

// Of some points the one that is nearest to another; the first of equal ones.
class Nearest {
 public:
  explicit Nearest(const Vec3& to) : to_(to) {}

  void add(const Vec3& p) {
    const Vec3 off = p - to_;
    if (!(dot(off, off) < least_)) return;
    least_ = dot(off, off);
    point_ = p;
  }
  [[nodiscard]] const std::optional<Vec3>& point() const { return point_; }

 private:
  Vec3 to_;
  double least_ = std::numeric_limits<double>::infinity();
  std::optional<Vec3> point_;
};

}  // namespace

CellCreases::CellCreases(const TriangleMesh& mesh, const CellTriangles& triangles)
    : mesh_(&mesh), triangles_(&triangles), sides_(mesh.triangles.size(), 0) {
  const std::vector<SideUse> uses = uses_of(mesh);
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    const SideUse& first = uses[begin];
    while (end < uses.size() && uses[end].low == first.low && uses[end].high == first.high) ++end;
    const double cosine = end - begin == 2 ? cosine_at(mesh, first, uses[begin + 1]) : 0.0;
    const unsigned bits = (cosine > kFlat ? 0U : 1U) | (cosine > kBlunt ? 0U : 1U << kSharpBit);
    sides_[first.triangle] = static_cast<std::uint8_t>(sides_[first.triangle] | bits << first.side);
  }
}

template <class Visit>
void CellCreases::for_each_hit(std::uint32_t cell, Which which, const std::array<Vec3, 3>& corners,
                               const Visit& visit) const {
  for_each(cell, which, [&](const Vec3& a, const Vec3& b) {
    const std::optional<double> at = segment_hit(a, b, corners[0], corners[1], corners[2]);
    if (at) visit(a + *at * (b - a));
  });
}

bool CellCreases::has_hit_near(std::uint32_t cell, const std::array<Vec3, 3>& corners, const Vec3& p,
                               double distance) const {
  bool has = false;
  for_each_hit(cell, Which::kAll, corners,
               [&](const Vec3& hit) { has = has || dot(hit - p, hit - p) <= distance * distance; });
  return has;
}

std::optional<Vec3> CellCreases::farthest_hit(std::uint32_t cell, const std::array<Vec3, 3>& corners, const Vec3& p,
                                              const Vec3& q) const {
  std::optional<Vec3> farthest;
  double most = -1.0;
  for_each_hit(cell, Which::kSharp, corners, [&](const Vec3& hit) {
    const Vec3 off = cross(q - p, hit - p);
    const double distance = dot(off, off);
    if (!(distance > most)) return;
    most = distance;
    farthest = hit;
  });
  return farthest;
}

std::optional<Vec3> CellCreases::nearest_within(std::uint32_t cell, const std::array<Vec3, 4>& corners,
                                                const Vec3& near) const {
  Nearest nearest(near);
  for_each(cell, Which::kAll, [&](const Vec3& a, const Vec3& b) {
    const Vec3 from = a - corners[0], step = b - a;
    const std::array<double, 4> first = barycentric(corners, from), last = barycentric(corners, b - corners[0]);
    LinePart part;
    for (std::size_t i = 0; i < first.size(); ++i) part.cut(first[i] + kTouch, last[i] + kTouch);
    if (!(part.begin <= part.end)) return;
    const double at = std::clamp(dot(near - from, step) / dot(step, step), part.begin, part.end);
    nearest.add(from + at * step);
  });
  return nearest.point();
}

std::optional<Vec3> CellCreases::nearest_end_within(std::uint32_t cell, const std::array<Vec3, 4>& corners,
                                                    const Vec3& near, double margin) const {
  Nearest nearest(near);
  for_each(cell, Which::kAll, [&](const Vec3& a, const Vec3& b) {
    for (const Vec3& end : {a, b}) {
      if (is_within(corners, end - corners[0], margin)) nearest.add(end - corners[0]);
    }
  });
  return nearest.point();
}

}  // namespace raycone
