#include "core/arrangement/plane_triangulation.h"

#include <cmath>
#include <deque>

#include "core/data/vec3.h"

namespace raycone {
namespace {

using Three = std::array<std::uint32_t, 3>;

constexpr std::size_t next(std::size_t place) { return (place + 1) % 3; }
constexpr std::size_t last(std::size_t place) { return (place + 2) % 3; }

}  // namespace

PlaneTriangulation::PlaneTriangulation(const ExactPoints& points, int axis, const std::array<Number, 3>& around,
                                       Effort& effort)
    : points_(&points), axis_(axis), effort_(&effort), points_of_(around.begin(), around.end()) {
  faces_.push_back({{0, 1, 2}, {kNone, kNone, kNone}});
  face_of_.assign(3, 0);
}

std::size_t PlaneTriangulation::place_in(std::uint32_t face, std::uint32_t corner) const {
  const Three& corners = faces_[face].corners;
  return corners[0] == corner ? 0 : corners[1] == corner ? 1 : 2;
}

void PlaneTriangulation::set_face(std::uint32_t face, const Three& corners, const Three& beyond) {
  faces_[face] = {corners, beyond};
  for (const std::uint32_t corner : corners) face_of_[corner] = face;
}

void PlaneTriangulation::replace_beyond(std::uint32_t face, std::uint32_t old_face, std::uint32_t new_face) {
  if (face == kNone) return;
  for (std::uint32_t& beyond : faces_[face].beyond) {
    if (beyond == old_face) beyond = new_face;
  }
}

// Walks towards the point. Which edge is looked at first changes as if by dice, so that the walk ends in any
// triangulation.
std::optional<std::uint32_t> PlaneTriangulation::face_with(Number point) {
  const auto is_outside = [&](std::uint32_t face, std::size_t across) {
    const Three& c = faces_[face].corners;
    return points_->turn(axis_, points_of_[c[next(across)]], points_of_[c[last(across)]], point) < 0;
  };
  std::uint32_t face = last_face_, dice = 1;
  for (bool moved = true; moved;) {
    if (!effort_->take()) return std::nullopt;
    moved = false;
    dice = dice * 1664525U + 1013904223U;
    for (std::size_t n = 0; n < 3 && !moved; ++n) {
      const std::size_t across = ((dice >> 16) + n) % 3;
      if (!is_outside(face, across)) continue;
      face = faces_[face].beyond[across];
      moved = true;
    }
  }
  return last_face_ = face;
}

bool PlaneTriangulation::insert(Number point) {
  if (corner_of_.contains(point)) return true;
  const std::optional<std::uint32_t> found = face_with(point);
  if (!found) return false;
  const std::uint32_t face = *found;
  const auto corner = static_cast<std::uint32_t>(points_of_.size());
  corner_of_.emplace(point, corner);
  points_of_.push_back(point);
  face_of_.push_back(face);
  const auto second = static_cast<std::uint32_t>(faces_.size()), third = second + 1;
  faces_.resize(faces_.size() + 2);
  const auto [corners, beyond] = faces_[face];
  set_face(face, {corner, corners[1], corners[2]}, {beyond[0], second, third});
  set_face(second, {corner, corners[2], corners[0]}, {beyond[1], third, face});
  set_face(third, {corner, corners[0], corners[1]}, {beyond[2], face, second});
  replace_beyond(beyond[1], face, second);
  replace_beyond(beyond[2], face, third);
  std::vector<Edge> edges{{face, 0}, {second, 0}, {third, 0}};
  for (const std::uint32_t part : {face, second, third}) {  // a point on an edge leaves one of zero area
    const Three& c = faces_[part].corners;
    if (turn(c[0], c[1], c[2]) != 0) continue;
    const std::uint32_t other = faces_[part].beyond[0];
    flip({part, 0});
    edges.push_back({part, place_in(part, corner)});
    edges.push_back({other, place_in(other, corner)});
    break;
  }
  make_delaunay(std::move(edges));
  return true;
}

std::uint32_t PlaneTriangulation::corner_beyond(const Edge& edge) const {
  const Face& face = faces_[edge.face];
  const std::uint32_t other = face.beyond[edge.across];
  const std::size_t at_next = place_in(other, face.corners[next(edge.across)]);
  return faces_[other].corners[3 - at_next - place_in(other, face.corners[last(edge.across)])];
}

bool PlaneTriangulation::can_flip(const Edge& edge) const {
  const Face& face = faces_[edge.face];
  if (face.beyond[edge.across] == kNone) return false;
  const std::uint32_t a = face.corners[edge.across], b = face.corners[next(edge.across)],
                      c = face.corners[last(edge.across)];
  const std::uint32_t d = corner_beyond(edge);
  return turn(a, b, d) > 0 && turn(a, d, c) > 0;
}

// The edge b - c of the faces a, b, c and d, c, b becomes a - d of a, b, d and a, d, c.
void PlaneTriangulation::flip(const Edge& edge) {
  const std::uint32_t face = edge.face, other = faces_[face].beyond[edge.across];
  const Face from = faces_[face], across = faces_[other];
  const std::uint32_t a = from.corners[edge.across], b = from.corners[next(edge.across)],
                      c = from.corners[last(edge.across)];
  const std::size_t at_b = place_in(other, b), at_c = place_in(other, c), at_d = 3 - at_b - at_c;
  const std::uint32_t d = across.corners[at_d];
  const std::uint32_t beyond_bd = across.beyond[at_c], beyond_dc = across.beyond[at_b],
                      beyond_ca = from.beyond[next(edge.across)], beyond_ab = from.beyond[last(edge.across)];
  set_face(face, {a, b, d}, {beyond_bd, other, beyond_ab});
  set_face(other, {a, d, c}, {beyond_dc, beyond_ca, face});
  replace_beyond(beyond_bd, other, face);
  replace_beyond(beyond_ca, face, other);
}

// Whether the corner beyond the edge lies within the circle around the face, clearly, in doubles.
bool PlaneTriangulation::should_flip(const Edge& edge) const {
  const Face& face = faces_[edge.face];
  if (face.beyond[edge.across] == kNone) return false;
  const int right = (axis_ + 1) % 3, up = (axis_ + 2) % 3;
  const Vec3& origin = points_->rounded(points_of_[corner_beyond(edge)]);
  std::array<double, 3> x{}, y{}, squares{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3& p = points_->rounded(points_of_[face.corners[i]]);
    x[i] = p[right] - origin[right];
    y[i] = p[up] - origin[up];
    squares[i] = x[i] * x[i] + y[i] * y[i];
  }
  double within = 0.0, terms = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double left = x[next(i)] * y[last(i)], right_product = x[last(i)] * y[next(i)];
    within += squares[i] * (left - right_product);
    terms += squares[i] * (std::abs(left) + std::abs(right_product));
  }
  constexpr double kClearly = 1e-10;
  return within > kClearly * terms;
}

void PlaneTriangulation::make_delaunay(std::vector<Edge> edges) {
  while (!edges.empty() && effort_->take()) {
    const Edge edge = edges.back();
    edges.pop_back();
    const Face& face = faces_[edge.face];
    if (of_segments_.contains(std::minmax(face.corners[next(edge.across)], face.corners[last(edge.across)]))) continue;
    if (!should_flip(edge) || !can_flip(edge)) continue;
    const std::uint32_t other = face.beyond[edge.across];
    flip(edge);
    for (const std::uint32_t changed : {edge.face, other}) {
      for (std::size_t across = 0; across < 3; ++across) edges.push_back({changed, across});
    }
  }
}

void PlaneTriangulation::make_delaunay() {
  std::vector<Edge> edges;
  for (std::uint32_t face = 0; face < faces_.size(); ++face) {
    for (std::size_t across = 0; across < 3; ++across) edges.push_back({face, across});
  }
  make_delaunay(std::move(edges));
}

// The corners of the triangle around all are on no segment, and have no full circle of faces around them.
PlaneTriangulation::Edge PlaneTriangulation::edge_between(std::uint32_t a, std::uint32_t b) const {
  const std::uint32_t center = a > 2 ? a : b, other = a > 2 ? b : a;
  std::uint32_t face = face_of_[center];
  for (;;) {
    const std::size_t place = place_in(face, center);
    if (faces_[face].corners[next(place)] == other) return {face, last(place)};
    face = faces_[face].beyond[next(place)];
  }
}

PlaneTriangulation::Way PlaneTriangulation::way_from(std::uint32_t from, std::uint32_t to) const {
  std::uint32_t face = face_of_[from], right = kNone, left = kNone;
  for (;;) {
    const std::size_t place = place_in(face, from);
    right = faces_[face].corners[next(place)];
    left = faces_[face].corners[last(place)];
    if (right == to || left == to) return {{}, to};
    const int at_right = turn(from, right, to), at_left = turn(from, left, to);
    if (at_right == 0 && at_left < 0) return {{}, right};
    if (at_right > 0 && at_left < 0) break;
    face = faces_[face].beyond[next(place)];
  }
  Way way{{{right, left}}, kNone};
  std::uint32_t behind = faces_[face].beyond[place_in(face, from)];
  for (;;) {
    const std::size_t at_right = place_in(behind, right), at_left = place_in(behind, left);
    const std::uint32_t corner = faces_[behind].corners[3 - at_right - at_left];
    const int side = corner == to ? 0 : turn(from, to, corner);
    if (side == 0) {
      way.target = corner;
      return way;
    }
    behind = faces_[behind].beyond[side > 0 ? at_left : at_right];  // across from the end that is left behind
    (side > 0 ? left : right) = corner;
    way.crossed.emplace_back(right, left);
  }
}

// Flips what is crossed until nothing is (Sloan 1993).
bool PlaneTriangulation::clear(const Way& way, std::uint32_t from) {
  std::deque<std::pair<std::uint32_t, std::uint32_t>> crossed(way.crossed.begin(), way.crossed.end());
  while (!crossed.empty()) {
    if (!effort_->take()) return false;
    const auto [right, left] = crossed.front();
    crossed.pop_front();
    const Edge edge = edge_between(right, left);
    if (!can_flip(edge)) {
      crossed.emplace_back(right, left);
      continue;
    }
    const std::uint32_t a = faces_[edge.face].corners[edge.across], d = corner_beyond(edge);
    flip(edge);
    const auto is_end = [&](std::uint32_t corner) { return corner == from || corner == way.target; };
    if (is_end(a) || is_end(d)) continue;
    const int side = turn(from, way.target, a);
    if (side != turn(from, way.target, d)) crossed.emplace_back(side > 0 ? d : a, side > 0 ? a : d);
  }
  return true;
}

std::optional<std::vector<PlaneTriangulation::Number>> PlaneTriangulation::connect(Number from, Number to) {
  std::uint32_t at = corner_of_.at(from);
  const std::uint32_t end = corner_of_.at(to);
  std::vector<Number> chain{from};
  while (at != end) {
    const Way way = way_from(at, end);
    if (!clear(way, at)) return std::nullopt;
    of_segments_.insert(std::minmax(at, way.target));
    at = way.target;
    chain.push_back(points_of_[at]);
  }
  return chain;
}

}  // namespace raycone
