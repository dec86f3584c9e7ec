#include "core/cells/cell_creases.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>

#include "core/cells/edge_crossing.h"
#include "core/cells/planes_point.h"
#include "core/mesh/disjoint_sets.h"
#include "core/mesh/face_edges.h"

namespace raycone {
namespace {

constexpr double kFine = 0.99999847691328772;  // cos 0.1 degrees
constexpr double kFlat = 0.999999999999995;    // cos 1e-7

constexpr double kTouch = 1e-9;  // of barycentric coordinates, where a crease only touches a tetrahedron

// Which side of its triangle an edge is, from 0 to 2.
unsigned side_number(const TriangleMesh& mesh, const FaceEdge& edge) {
  const Triangle& t = mesh.triangles[edge.face];
  const std::uint32_t from = edge.is_forward ? edge.low : edge.high, to = edge.is_forward ? edge.high : edge.low;
  return t[0] == from && t[1] == to ? 0 : t[1] == from && t[2] == to ? 1 : 2;
}

// Of the angle between two triangles at an edge of both.
double cosine_at(const TriangleNormals& normals, const FaceEdge& a, const FaceEdge& b) {
  const double cosine = dot(normals.of(a.face), normals.of(b.face));
  return a.is_forward == b.is_forward ? -cosine : cosine;
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

Box box_of(const std::array<Vec3, 4>& corners) {
  return hull(box_of(corners[0], corners[1]), box_of(corners[2], corners[3]));
}

// Widened by far more than what touches, or rounds.
Box with_room(const Box& box) {
  constexpr double kPart = 0x1p-6;
  const Vec3 by = kPart * (box.upper - box.lower);
  return {box.lower - by, box.upper + by};
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
  DisjointSets<> parts(mesh.triangles.size());
  for_each_edge(face_edges(mesh.triangles), [&](std::span<const FaceEdge> faces) {
    const FaceEdge &first = faces.front(), &last = faces.back();
    const bool are_two = faces.size() == 2;
    const double cosine = are_two ? cosine_at(normals, first, last) : 0.0;
    const unsigned bits = (cosine > kFlat ? 0U : 1U) | (cosine > kFine ? 0U : 1U << kCreaseBit) |
                          (cosine > kSharpCosine ? 0U : 1U << kSharpBit);
    const unsigned side = side_number(mesh, first);
    sides_[first.face] = static_cast<std::uint16_t>(sides_[first.face] | bits << side);
    beyond_[first.face][side] = are_two ? last.face : first.face;
    if (bits == 0) parts.join(first.face, last.face);
  });
  for (std::uint32_t triangle = 0; triangle < parts_.size(); ++triangle) parts_[triangle] = parts.lowest(triangle);
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
      const auto has = [&](unsigned bit) { return (sides_[triangle] >> (side + bit) & 1U) != 0; };
      found.push_back({a, b, box_of(a, b), has(kSharpBit), !has(kCreaseBit), {triangle, beyond_[triangle][side]}});
    }
  }
}

// A hit is in the crease's box, but for rounding.
bool CreasesHere::has_hit_near(const Corners3& corners, const Vec3& p, double distance, CreaseKinds kinds) {
  const Vec3 reach{2.0 * distance, 2.0 * distance, 2.0 * distance};
  const Box near{p - reach, p + reach};
  return std::ranges::any_of(all(), [&](const Crease& crease) {
    if ((crease.is_fine && kinds == CreaseKinds::kNotFine) || !overlap(crease.box, near)) return false;
    const std::optional<double> at = segment_hit(crease.from, crease.to, corners);
    if (!at) return false;
    const Vec3 off = crease.from + *at * (crease.to - crease.from) - p;
    return dot(off, off) <= distance * distance;
  });
}

std::optional<Vec3> CreasesHere::farthest_hit(const Corners3& corners, const Vec3& p, const Vec3& q) {
  const Box box = box_of(corners);
  std::optional<Vec3> farthest;
  double most = -1.0;
  for (const Crease& crease : all()) {
    if (!crease.is_sharp || !overlap(crease.box, box)) continue;
    const std::optional<double> at = segment_hit(crease.from, crease.to, corners);
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
CreasesHere::Section CreasesHere::section(const Corners3& corners, std::uint32_t from, std::uint32_t to) {
  const Box box = box_of(corners);
  hits_.clear();
  for (const Crease& crease : all()) {
    if (!overlap(crease.box, box)) continue;
    const std::optional<double> at = segment_hit(crease.from, crease.to, corners);
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
  const Box box = with_room(box_of(within.corners()));
  Nearest nearest(near);
  for (const Crease& crease : all()) {
    if ((crease.is_fine && kinds == CreaseKinds::kNotFine) || !overlap(crease.box, box)) continue;
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
  const Box box = with_room(box_of(within.corners()));
  Nearest nearest(near);
  for (const Crease& crease : all()) {
    if (crease.is_fine) continue;
    for (const Vec3& end : {crease.from, crease.to}) {
      if (!contains(box, end)) continue;
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
    if ((crease.is_fine && kinds == CreaseKinds::kNotFine) || !overlap(crease.box, around)) continue;
    for (const Vec3& end : {crease.from, crease.to}) {
      if (!contains(around, end)) continue;
      if (!contains(within, end) || (ends.one && *ends.one != end)) return {std::nullopt, true};
      ends.one = end;
    }
  }
  return ends;
}

}  // namespace raycone
