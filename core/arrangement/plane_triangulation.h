// Triangulations of points in a plane, with segments that must be chains of its edges.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/arrangement/effort.h"
#include "core/exact/exact_points.h"

namespace raycone {

// Of points of a mesh, and a triangle far around them (ExactPoints::add_triangle_around()). Every face turns left,
// exactly. Faces are nearly Delaunay's (Lawson 1977) before segments are forced in; that is not exact, and only keeps
// walks short. Needs DefaultFloatingPoint.
class PlaneTriangulation {
 public:
  using Number = ExactPoints::Number;
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  struct Face {
    std::array<std::uint32_t, 3> corners;  // point() tells which these are
    std::array<std::uint32_t, 3> beyond;   // the face across from each corner; kNone outside
  };

  // `points` and `effort` must outlive this. Seen along `axis`.
  PlaneTriangulation(const ExactPoints& points, int axis, const std::array<Number, 3>& around, Effort& effort);

  // False if that takes too long. Precondition: the point is within the triangle `around`.
  [[nodiscard]] bool insert(Number point);
  // Makes the segment between two inserted points a chain of edges. Returns the points along it, both ends included.
  // Segments that were forced in before stay, if it crosses none of them. None if that takes too long.
  [[nodiscard]] std::optional<std::vector<Number>> connect(Number from, Number to);
  // Makes faces nearly Delaunay's again, by flipping edges that are of no segment: so none is flatter than its corners
  // make it. Ends early where the effort is spent.
  void make_delaunay();

  [[nodiscard]] const std::vector<Face>& faces() const { return faces_; }
  [[nodiscard]] Number point(std::uint32_t corner) const { return points_of_[corner]; }
  // A face with a corner of the triangle `around`.
  [[nodiscard]] std::uint32_t outer_face() const { return face_of_[0]; }

 private:
  // An edge of a face: that across from a corner.
  struct Edge {
    std::uint32_t face;
    std::size_t across;
  };
  // What a segment crosses on its way from a corner: edges, each with its right end and its left end.
  struct Way {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> crossed;
    std::uint32_t target;  // the first corner on the segment
  };

  [[nodiscard]] int turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return points_->turn(axis_, points_of_[a], points_of_[b], points_of_[c]);
  }
  [[nodiscard]] std::size_t place_in(std::uint32_t face, std::uint32_t corner) const;
  [[nodiscard]] std::optional<std::uint32_t> face_with(Number point);
  [[nodiscard]] Edge edge_between(std::uint32_t a, std::uint32_t b) const;
  void set_face(std::uint32_t face, const std::array<std::uint32_t, 3>& corners,
                const std::array<std::uint32_t, 3>& beyond);
  void replace_beyond(std::uint32_t face, std::uint32_t old_face, std::uint32_t new_face);
  // Precondition: there is a face.
  [[nodiscard]] std::uint32_t corner_beyond(const Edge& edge) const;
  [[nodiscard]] bool can_flip(const Edge& edge) const;
  void flip(const Edge& edge);
  [[nodiscard]] bool should_flip(const Edge& edge) const;
  void make_delaunay(std::vector<Edge> edges);
  [[nodiscard]] Way way_from(std::uint32_t from, std::uint32_t to) const;
  [[nodiscard]] bool clear(const Way& way, std::uint32_t from);

  const ExactPoints* points_;
  int axis_;
  Effort* effort_;
  std::vector<Face> faces_;
  std::vector<Number> points_of_;
  std::vector<std::uint32_t> face_of_;  // one at each corner
  std::unordered_map<Number, std::uint32_t> corner_of_;
  std::uint32_t last_face_ = 0;
  std::set<std::pair<std::uint32_t, std::uint32_t>> of_segments_;  // edges, the lower corner first
};

}  // namespace raycone
