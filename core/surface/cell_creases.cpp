#include "core/surface/cell_creases.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>
#include <tuple>

#include "core/surface/edge_crossing.h"
#include "core/surface/planes_point.h"

namespace raycone {
namespace {

constexpr double kFine = 0.99999847691328772;  // cos 0.1 degrees
constexpr double kFlat = 0.999999999999995;    // cos 1e-7

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

// Of the angle between two triangles at an edge of both.
double cosine_at(const TriangleNormals& normals, const SideUse& a, const SideUse& b) {
  const double cosine = dot(normals.of(a.triangle), normals.of(b.triangle));
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

template <std::size_t count>
Box box_of(const std::array<Vec3, count>& points) {
  Box box{points[0], points[0]};
  for (std::size_t i = 1; i < count; ++i) {
    const Vec3& p = points[i];
    box.lower = {std::min(box.lower.x, p.x), std::min(box.lower.y, p.y), std::min(box.lower.z, p.z)};
    box.upper = {std::max(box.upper.x, p.x), std::max(box.upper.y, p.y), std::max(box.upper.z, p.z)};
  }
  return box;
}

// By far more than what touches, or rounds.
Box widened(const Box& box) {
  constexpr double kPart = 0x1p-6;
  const Vec3 by = kPart * (box.upper - box.lower);
  return {box.lower - by, box.upper + by};
}

bool holds(const Box& box, const Vec3& p) {
  return p.x >= box.lower.x && p.x <= box.upper.x && p.y >= box.lower.y && p.y <= box.upper.y && p.z >= box.lower.z &&
         p.z <= box.upper.z;
}

bool meets(const CellCreases::Crease& crease, const Vec3& lower, const Vec3& upper) {
  return crease.lower.x <= upper.x && crease.upper.x >= lower.x && crease.lower.y <= upper.y &&
         crease.upper.y >= lower.y && crease.lower.z <= upper.z && crease.upper.z >= lower.z;
}

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

CellCreases::CellCreases(const TriangleMesh& mesh, const TriangleNormals& normals, const CellTriangles& triangles,
                         const SurfaceCells& cells)
    : mesh_(&mesh),
      normals_(&normals),
      triangles_(&triangles),
      sides_(mesh.triangles.size(), 0),
      beyond_(mesh.triangles.size()),
      parts_(mesh.triangles.size()) {
  std::iota(parts_.begin(), parts_.end(), 0U);
  const std::vector<SideUse> uses = uses_of(mesh);
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    const SideUse& first = uses[begin];
    while (end < uses.size() && uses[end].low == first.low && uses[end].high == first.high) ++end;
    const double cosine = end - begin == 2 ? cosine_at(normals, first, uses[begin + 1]) : 0.0;
    const unsigned bits = (cosine > kFlat ? 0U : 1U) | (cosine > kFine ? 0U : 1U << kCreaseBit) |
                          (cosine > kSharpCosine ? 0U : 1U << kSharpBit);
    sides_[first.triangle] = static_cast<std::uint16_t>(sides_[first.triangle] | bits << first.side);
    beyond_[first.triangle][first.side] = end - begin == 2 ? uses[begin + 1].triangle : first.triangle;
    if (bits == 0) unite(first.triangle, uses[begin + 1].triangle);
  }
  for (std::uint32_t& part : parts_) part = parts_[part];  // lower ones know theirs
  find_ends(cells);
}

void CellCreases::find_ends(const SurfaceCells& cells) {
  constexpr double kReach = 0x1p-4, kRounding = 0x1p-8;  // of a cell's side
  end_reach_ = kReach * cells.lattice().least_spacing();
  near_ends_.assign(cells.cells().size(), 0);
  std::vector<bool> is_end(mesh_->vertices.size(), false);
  for (std::size_t triangle = 0; triangle < sides_.size(); ++triangle) {
    for (unsigned side = 0; side < 3; ++side) {
      if ((sides_[triangle] >> side & 1U) == 0) continue;
      is_end[mesh_->triangles[triangle][side]] = is_end[mesh_->triangles[triangle][(side + 1) % 3]] = true;
    }
  }
  for (std::size_t v = 0; v < is_end.size(); ++v) {
    if (is_end[v])
      cells.for_each_near(mesh_->vertices[v], kReach + kRounding, [&](auto cell) { near_ends_[cell] = 1; });
  }
}

void CellCreases::find(std::uint32_t cell, std::vector<Crease>& found) const {
  found.clear();
  if (!triangles_) return;
  for (const std::uint32_t triangle : triangles_->of(cell)) {
    if (sides_[triangle] == 0) continue;
    const Triangle& t = mesh_->triangles[triangle];
    for (unsigned side = 0; side < t.size(); ++side) {
      if ((sides_[triangle] >> side & 1U) == 0) continue;
      const Vec3 &a = mesh_->vertices[t[side]], &b = mesh_->vertices[t[(side + 1) % t.size()]];
      const Box box = box_of(std::array{a, b});
      const auto has = [&](unsigned bit) { return (sides_[triangle] >> (side + bit) & 1U) != 0; };
      found.push_back(
          {a, b, box.lower, box.upper, has(kSharpBit), !has(kCreaseBit), {triangle, beyond_[triangle][side]}});
    }
  }
}

// Each takes the number of a lower one of its part, until that is its own.
void CellCreases::unite(std::uint32_t a, std::uint32_t b) {
  const auto lowest_of = [&](std::uint32_t t) {
    while (parts_[t] != t) t = parts_[t] = parts_[parts_[t]];
    return t;
  };
  const std::uint32_t of_a = lowest_of(a), of_b = lowest_of(b);
  parts_[std::max(of_a, of_b)] = std::min(of_a, of_b);
}

// A hit is in the crease's box, but for rounding.
bool CreasesHere::has_hit_near(const std::array<Vec3, 3>& corners, const Vec3& p, double distance, CreaseKinds kinds) {
  const Vec3 reach{2.0 * distance, 2.0 * distance, 2.0 * distance};
  const Vec3 lower = p - reach, upper = p + reach;
  return std::ranges::any_of(all(), [&](const Crease& crease) {
    if ((crease.is_fine && kinds == CreaseKinds::kNotFine) || !meets(crease, lower, upper)) return false;
    const std::optional<double> at = segment_hit(crease.from, crease.to, corners[0], corners[1], corners[2]);
    if (!at) return false;
    const Vec3 off = crease.from + *at * (crease.to - crease.from) - p;
    return dot(off, off) <= distance * distance;
  });
}

std::optional<Vec3> CreasesHere::farthest_hit(const std::array<Vec3, 3>& corners, const Vec3& p, const Vec3& q) {
  const Box box = box_of(corners);
  std::optional<Vec3> farthest;
  double most = -1.0;
  for (const Crease& crease : all()) {
    if (!crease.is_sharp || !meets(crease, box.lower, box.upper)) continue;
    const std::optional<double> at = segment_hit(crease.from, crease.to, corners[0], corners[1], corners[2]);
    if (!at) continue;
    const Vec3 hit = crease.from + *at * (crease.to - crease.from), off = cross(q - p, hit - p);
    const double distance = dot(off, off);
    if (!(distance > most)) continue;
    most = distance;
    farthest = hit;
  }
  return farthest;
}

// What a flat part that is convex has in common with a plane is a piece of a straight line, with two ends: from the
// crease where it is entered it leads to one other crease at most.
CreasesHere::Section CreasesHere::section(const std::array<Vec3, 3>& corners, std::uint32_t from, std::uint32_t to) {
  const Box box = box_of(corners);
  hits_.clear();
  for (const Crease& crease : all()) {
    if (!meets(crease, box.lower, box.upper)) continue;
    const std::optional<double> at = segment_hit(crease.from, crease.to, corners[0], corners[1], corners[2]);
    if (at) hits_.push_back({crease.from + *at * (crease.to - crease.from), crease.triangles});
  }
  Section section;
  for (std::uint32_t here = creases_.part_of(from); here != creases_.part_of(to); ++section.size) {
    const auto is_of = [&](const CreaseHit& hit) {
      return std::ranges::any_of(hit.triangles, [&](std::uint32_t t) { return creases_.part_of(t) == here; });
    };
    const auto hit = std::ranges::find_if(hits_, is_of);
    if (section.size == Section::kMost || hit == hits_.end() || std::any_of(hit + 1, hits_.end(), is_of)) return {};
    const std::uint32_t beyond = hit->triangles[creases_.part_of(hit->triangles[0]) == here ? 1 : 0];
    section.corners[section.size] = {hit->position, beyond};
    here = creases_.part_of(beyond);
    hits_.erase(hit);
  }
  return section;
}

std::optional<Vec3> CreasesHere::nearest_within(const BarycentricCoordinates& within, const Vec3& near,
                                                CreaseKinds kinds) {
  const Vec3& first_corner = within.corners()[0];
  const Box box = widened(box_of(within.corners()));
  Nearest nearest(near);
  for (const Crease& crease : all()) {
    if ((crease.is_fine && kinds == CreaseKinds::kNotFine) || !meets(crease, box.lower, box.upper)) continue;
    const Vec3 from = crease.from - first_corner, step = crease.to - crease.from;
    const std::array<double, 4> first = within.of(from), last = within.of(crease.to - first_corner);
    LinePart part;
    for (std::size_t i = 0; i < first.size(); ++i) part.cut(first[i] + kTouch, last[i] + kTouch);
    if (!(part.begin <= part.end)) continue;
    const double at = std::clamp(dot(near - from, step) / dot(step, step), part.begin, part.end);
    nearest.add(from + at * step);
  }
  return nearest.point();
}

std::optional<Vec3> CreasesHere::nearest_end_within(const BarycentricCoordinates& within, const Vec3& near,
                                                    double margin) {
  const Box box = widened(box_of(within.corners()));
  Nearest nearest(near);
  for (const Crease& crease : all()) {
    if (crease.is_fine) continue;
    for (const Vec3& end : {crease.from, crease.to}) {
      if (!holds(box, end)) continue;
      const Vec3 from_first = end - within.corners()[0];
      if (within.is_within(from_first, margin)) nearest.add(from_first);
    }
  }
  return nearest.point();
}

CreasesHere::Ends CreasesHere::ends_within(const Vec3& lower, const Vec3& upper, double off, CreaseKinds kinds) {
  if (!creases_.may_end_near(cell_, off)) return {};
  const Vec3 by{off, off, off};
  const Box around{lower - by, upper + by}, within{lower + by, upper - by};
  Ends ends;
  for (const Crease& crease : all()) {
    if ((crease.is_fine && kinds == CreaseKinds::kNotFine) || !meets(crease, around.lower, around.upper)) continue;
    for (const Vec3& end : {crease.from, crease.to}) {
      if (!holds(around, end)) continue;
      if (!holds(within, end) || (ends.one && *ends.one != end)) return {std::nullopt, true};
      ends.one = end;
    }
  }
  return ends;
}

}  // namespace raycone
