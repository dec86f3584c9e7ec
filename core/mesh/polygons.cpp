#include "core/mesh/polygons.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "core/exact/projection.h"
#include "core/machine/floating_point.h"
#include "core/machine/threads.h"
#include "core/mesh/polygon_cut.h"

namespace raycone {
namespace {

// --- Corners --------------------------------------------------------------------------------------------------------

// The corners of a polygon, seen along its area vector.
class Polygon {
 public:
  // Takes the place of what was here before, and its memory. Corners that repeat the one before are left out, and so is
  // a last one that repeats the first.
  void assign(const TriangleMesh& mesh, const PolygonFan& fan) {
    corners_.clear();
    vertices_.clear();
    add(mesh, mesh.triangles[fan.first][0]);
    add(mesh, mesh.triangles[fan.first][1]);
    for (std::uint64_t i = 0; i < fan.triangles; ++i) add(mesh, mesh.triangles[fan.first + i][2]);
    while (corners_.size() > 1 && corners_.back() == corners_.front()) {
      corners_.pop_back();
      vertices_.pop_back();
    }
    direction_ = area_direction(corners_);
  }

  // No two corners that follow each other are at one place.
  [[nodiscard]] std::size_t size() const { return corners_.size(); }
  [[nodiscard]] const std::vector<Vec3>& corners() const { return corners_; }
  [[nodiscard]] std::uint32_t vertex(std::size_t corner) const { return vertices_[corner]; }
  [[nodiscard]] bool has_area() const { return direction_ != Vec3{}; }

  // 1 where corners i, j, k turn left, -1 where they turn right, 0 where they lie on a line.
  [[nodiscard]] int turn(std::size_t i, std::size_t j, std::size_t k) const {
    return raycone::turn(direction_, corners_[i], corners_[j], corners_[k]);
  }

  // Starts the polygon at the corner that comes first in space, so that it matters little where a file starts it.
  void rotate_to_first() {
    const auto first = std::min_element(corners_.begin(), corners_.end(), [](const Vec3& a, const Vec3& b) {
      return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z};
    });
    const auto shift = first - corners_.begin();
    std::rotate(corners_.begin(), corners_.begin() + shift, corners_.end());
    std::rotate(vertices_.begin(), vertices_.begin() + shift, vertices_.end());
  }

 private:
  void add(const TriangleMesh& mesh, std::uint32_t vertex) {
    const Vec3& corner = mesh.vertices[vertex];
    if (!corners_.empty() && corners_.back() == corner) return;
    corners_.push_back(corner);
    vertices_.push_back(vertex);
  }

  std::vector<Vec3> corners_;
  std::vector<std::uint32_t> vertices_;  // of the mesh, at the corners
  Vec3 direction_;
};

// --- Convexity ------------------------------------------------------------------------------------------------------

bool never_turns_right(const Polygon& polygon) {
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i)
    if (polygon.turn(i, (i + 1) % n, (i + 2) % n) < 0) return false;
  return true;
}

// Whether the fan from the first corner turns around it in one direction by no more than half a turn: no triangle is
// turned over, those without area are the first ones or the last, and the corner does not come again.
bool fan_opens_once(const Polygon& polygon) {
  enum { kBefore, kWithin, kBehind } place = kBefore;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    if (polygon.corners()[i] == polygon.corners()[0]) return false;
    const int turn = polygon.turn(0, i, i + 1);
    if (turn < 0 || (turn > 0 && place == kBehind) || polygon.turn(0, 1, i + 1) < 0) return false;
    if (turn > 0) place = kWithin;
    if (turn == 0 && place == kWithin) place = kBehind;
  }
  return true;
}

bool is_on_a_line(const Polygon& polygon) {
  const std::vector<Vec3>& corners = polygon.corners();
  constexpr std::array kAxes{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  return std::all_of(corners.begin(), corners.end(), [&](const Vec3& corner) {
    return std::all_of(kAxes.begin(), kAxes.end(),
                       [&](const Vec3& axis) { return exact_turn(axis, corners[0], corners[1], corner) == 0; });
  });
}

// Whether the fan from the first corner is right as it is. A polygon on a line has no inside that a fan could leave.
bool is_convex(const Polygon& polygon) {
  if (polygon.size() <= 3) return true;
  if (!polygon.has_area()) return is_on_a_line(polygon);
  return never_turns_right(polygon) && fan_opens_once(polygon);
}

// --- Cutting --------------------------------------------------------------------------------------------------------

// Indices of the fans whose polygons are not convex.
std::vector<std::size_t> find_concave(const TriangleMesh& mesh, std::span<const PolygonFan> fans) {
  std::vector<char> concave(fans.size());
  constexpr std::size_t kGrain = 4096;
  parallel_for(fans.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    Polygon polygon;
    for (std::size_t i = begin; i < end; ++i) {
      polygon.assign(mesh, fans[i]);
      concave[i] = !is_convex(polygon);
    }
  });
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < fans.size(); ++i)
    if (concave[i]) found.push_back(i);
  return found;
}

std::optional<std::vector<Triangle>> cut(const TriangleMesh& mesh, const PolygonFan& fan) {
  Polygon polygon;
  polygon.assign(mesh, fan);
  if (!polygon.has_area()) return std::nullopt;
  polygon.rotate_to_first();
  // Anew, since where a sum starts decides how it is rounded.
  auto triangles = cut_polygon(polygon.corners(), area_direction(polygon.corners()));
  if (!triangles) return std::nullopt;
  for (Triangle& triangle : *triangles)
    for (std::uint32_t& corner : triangle) corner = polygon.vertex(corner);
  return triangles;
}

// Of the fans at these indices; absent where the polygon is not simple.
std::vector<std::optional<std::vector<Triangle>>> cut(const TriangleMesh& mesh, std::span<const PolygonFan> fans,
                                                      std::span<const std::size_t> indices) {
  std::vector<std::optional<std::vector<Triangle>>> parts(indices.size());
  constexpr std::size_t kGrain = 64;
  parallel_for_each(indices.size(), kGrain, [&](std::size_t i) { parts[i] = cut(mesh, fans[indices[i]]); });
  return parts;
}

}  // namespace

std::uint64_t cut_concave_polygons(TriangleMesh& mesh, std::span<const PolygonFan> fans,
                                   std::span<std::uint64_t> places) {
  const DefaultFloatingPoint default_environment;
  std::uint64_t bad = 0;
  std::vector<Triangle> result;
  std::uint64_t taken = 0;  // of the mesh's triangles, into the result
  const auto take_until = [&](std::uint64_t end) {
    const auto first = mesh.triangles.begin();
    std::size_t moved = 0;
    for (; moved < places.size() && places[moved] <= end; ++moved) places[moved] += result.size() - taken;
    places = places.subspan(moved);
    result.insert(result.end(), first + static_cast<std::ptrdiff_t>(taken), first + static_cast<std::ptrdiff_t>(end));
  };
  const std::vector<std::size_t> concave = find_concave(mesh, fans);
  const auto parts = cut(mesh, fans, concave);
  for (std::size_t i = 0; i < concave.size(); ++i) {
    if (!parts[i]) {
      ++bad;
      continue;
    }
    const PolygonFan& fan = fans[concave[i]];
    take_until(fan.first);
    result.insert(result.end(), parts[i]->begin(), parts[i]->end());
    taken = fan.first + fan.triangles;
  }
  if (taken == 0) return bad;
  take_until(mesh.triangles.size());
  mesh.triangles = std::move(result);
  return bad;
}

}  // namespace raycone
