#include "core/arrangement/plane_arrangement.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "core/arrangement/plane_triangulation.h"
#include "core/data/vec3.h"

namespace raycone {
namespace {

using Number = ExactPoints::Number;
using Segment = std::pair<Number, Number>;
using PointTriple = std::array<Number, 3>;

std::vector<Segment> all_segments(const PlaneGroup& group) {
  std::vector<Segment> segments = group.segments;
  for (const PlaneGroup::Face& face : group.faces) {
    for (std::size_t i = 0; i < 3; ++i) segments.emplace_back(face.corners[i], face.corners[(i + 1) % 3]);
  }
  for (auto& [from, to] : segments) {
    if (from > to) std::swap(from, to);
  }
  std::ranges::sort(segments);
  segments.erase(std::unique(segments.begin(), segments.end()), segments.end());
  return segments;
}

bool are_apart(const Segment& line, const Segment& ends, int axis, const ExactPoints& points) {
  return points.turn(axis, line.first, line.second, ends.first) *
             points.turn(axis, line.first, line.second, ends.second) <
         0;
}

bool cross_each_other(const Segment& s, const Segment& t, int axis, const ExactPoints& points) {
  return are_apart(s, t, axis, points) && are_apart(t, s, axis, points);
}

// Rounding keeps the order of numbers, so that segments that meet have boxes that do.
struct BoxedSegment {
  double left, right, lower, upper;
  Segment segment;
};

std::vector<BoxedSegment> boxed(std::span<const Segment> segments, int axis, const ExactPoints& points) {
  const int right = (axis + 1) % 3, up = (axis + 2) % 3;
  std::vector<BoxedSegment> boxes;
  for (const auto& [from, to] : segments) {
    const Vec3 &a = points.rounded(from), &b = points.rounded(to);
    const auto [left_end, right_end] = std::minmax({a[right], b[right]});
    const auto [lower, upper] = std::minmax({a[up], b[up]});
    boxes.push_back({left_end, right_end, lower, upper, {from, to}});
  }
  std::ranges::sort(boxes, [](const BoxedSegment& s, const BoxedSegment& t) {
    return std::tie(s.left, s.segment) < std::tie(t.left, t.segment);
  });
  return boxes;
}

// How many times more the boundaries of all faces pass along an edge in its direction than against it.
class EdgeCounts {
 public:
  void add(std::span<const Number> chain) {
    for (std::size_t i = 1; i < chain.size(); ++i) {
      const bool is_forward = chain[i - 1] < chain[i];
      counts_[std::minmax(chain[i - 1], chain[i])] += is_forward ? 1 : -1;
    }
  }
  [[nodiscard]] int along(Number from, Number to) const {
    const auto found = counts_.find(std::minmax(from, to));
    if (found == counts_.end()) return 0;  // no boundary passes
    return from < to ? found->second : -found->second;
  }

 private:
  std::map<Segment, int> counts_;
};

// For each face of the triangulation, how many more faces of the group run to the left around it than to the right. On
// the left of an edge of a boundary it is one more than on its right.
std::vector<int> multiplicities(const PlaneTriangulation& triangulation, const EdgeCounts& counts) {
  const std::vector<PlaneTriangulation::Face>& faces = triangulation.faces();
  std::vector<int> result(faces.size(), 0);
  std::vector<bool> is_known(faces.size(), false);
  std::vector<std::uint32_t> to_do{triangulation.outer_face()};
  is_known[to_do.front()] = true;
  while (!to_do.empty()) {
    const std::uint32_t face = to_do.back();
    to_do.pop_back();
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t other = faces[face].beyond[i];
      if (other == PlaneTriangulation::kNone || is_known[other]) continue;
      const Number from = triangulation.point(faces[face].corners[(i + 1) % 3]);
      const Number to = triangulation.point(faces[face].corners[(i + 2) % 3]);
      result[other] = result[face] - counts.along(from, to);
      is_known[other] = true;
      to_do.push_back(other);
    }
  }
  return result;
}

// The faces of a group, to be found by what is part of them.
class FacesOfGroup {
 public:
  FacesOfGroup(const PlaneGroup& group, int axis, const ExactPoints& points)
      : group_(group), axis_(axis), points_(points) {
    for (const PlaneGroup::Face& face : group.faces) boxes_.push_back(extent_of(face.corners));
  }

  // The first face that a piece is part of. None if that takes too long to find.
  [[nodiscard]] std::optional<std::uint32_t> first_with(const PointTriple& piece, Effort& effort) const {
    constexpr std::size_t kPerStep = 64;  // boxes
    const Extent of_piece = extent_of(piece);
    for (std::size_t n = 0; n < boxes_.size(); ++n) {
      if (n % kPerStep == 0 && !effort.take()) return std::nullopt;
      if (!holds(boxes_[n], of_piece)) continue;
      if (!effort.take()) return std::nullopt;
      if (holds(group_.faces[n].corners, piece)) return group_.faces[n].number;
    }
    return std::nullopt;
  }

 private:
  struct Extent {
    double left, right, lower, upper;
  };

  // Rounding keeps the order of numbers, so that what holds a piece has a box that does.
  [[nodiscard]] Extent extent_of(const PointTriple& corners) const {
    const int right = (axis_ + 1) % 3, up = (axis_ + 2) % 3;
    const Vec3 &a = points_.rounded(corners[0]), &b = points_.rounded(corners[1]), &c = points_.rounded(corners[2]);
    const auto [left_end, right_end] = std::minmax({a[right], b[right], c[right]});
    const auto [lower, upper] = std::minmax({a[up], b[up], c[up]});
    return {left_end, right_end, lower, upper};
  }
  static bool holds(const Extent& face, const Extent& piece) {
    return face.left <= piece.left && piece.right <= face.right && face.lower <= piece.lower &&
           piece.upper <= face.upper;
  }
  [[nodiscard]] bool holds(const PointTriple& face, const PointTriple& piece) const {
    const int direction = points_.turn(axis_, face[0], face[1], face[2]);
    for (std::size_t i = 0; i < 3; ++i) {
      for (const Number corner : piece) {
        if (points_.turn(axis_, face[i], face[(i + 1) % 3], corner) == -direction) return false;
      }
    }
    return true;
  }

  const PlaneGroup& group_;
  int axis_;
  const ExactPoints& points_;
  std::vector<Extent> boxes_;
};

// Of all points of the group, with segments and edges that are chains of edges. None if that takes too long.
std::optional<PlaneTriangulation> triangulated(const PlaneGroup& group, int axis, const ExactPoints& points,
                                               const TrianglesAround& around, Effort& effort) {
  const std::vector<Segment> segments = all_segments(group);
  std::vector<Number> corners = group.points;
  for (const auto& [from, to] : segments) corners.insert(corners.end(), {from, to});
  std::optional<PlaneTriangulation> triangulation(std::in_place, points, axis, around[axis], effort);
  for (const Number corner : corners) {
    if (!triangulation->insert(corner)) return std::nullopt;
  }
  for (const auto& [from, to] : segments) {
    if (!triangulation->connect(from, to)) return std::nullopt;
  }
  triangulation->make_delaunay();
  return triangulation;
}

}  // namespace

std::optional<std::vector<ExactPoints::Crossing>> crossings_of(const PlaneGroup& group, const ExactPoints& points,
                                                               Effort& effort) {
  const int axis = points.axis_to_see(group.faces.front().corners);
  const std::vector<BoxedSegment> boxes = boxed(all_segments(group), axis, points);
  std::vector<ExactPoints::Crossing> found;
  for (std::size_t n = 0; n < boxes.size(); ++n) {
    for (std::size_t m = n + 1; m < boxes.size() && boxes[m].left <= boxes[n].right; ++m) {
      if (!effort.take()) return std::nullopt;
      if (boxes[m].lower > boxes[n].upper || boxes[m].upper < boxes[n].lower) continue;
      const Segment &s = boxes[n].segment, &t = boxes[m].segment;
      if (cross_each_other(s, t, axis, points)) found.push_back({axis, s.first, s.second, t.first, t.second});
    }
  }
  return found;
}

std::optional<std::vector<PlanePiece>> cut(const PlaneGroup& group, const ExactPoints& points,
                                           const TrianglesAround& around, Effort& effort) {
  const int axis = points.axis_to_see(group.faces.front().corners);
  std::optional<PlaneTriangulation> triangulation = triangulated(group, axis, points, around, effort);
  if (!triangulation) return std::nullopt;
  EdgeCounts counts;
  for (const PlaneGroup::Face& face : group.faces) {
    for (std::size_t i = 0; i < 3; ++i) {
      counts.add(*triangulation->connect(face.corners[i], face.corners[(i + 1) % 3]));
    }
  }
  const std::vector<int> multiplicity = multiplicities(*triangulation, counts);
  const FacesOfGroup group_faces(group, axis, points);
  std::vector<PlanePiece> pieces;
  for (std::size_t n = 0; n < multiplicity.size(); ++n) {
    if (multiplicity[n] == 0) continue;
    PointTriple piece{};
    std::ranges::transform(triangulation->faces()[n].corners, piece.begin(),
                           [&](std::uint32_t corner) { return triangulation->point(corner); });
    if (multiplicity[n] < 0) std::swap(piece[1], piece[2]);
    const std::optional<std::uint32_t> face = group_faces.first_with(piece, effort);
    if (!face) return std::nullopt;
    pieces.push_back({piece, *face, std::abs(multiplicity[n])});
  }
  return pieces;
}

}  // namespace raycone
