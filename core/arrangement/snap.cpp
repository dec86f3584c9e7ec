#include "core/arrangement/snap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "core/arrangement/effort.h"
#include "core/data/keep_where.h"
#include "core/data/vec3.h"
#include "core/machine/threads.h"
#include "core/mesh/near_vertices.h"
#include "core/mesh/used_part.h"

namespace raycone {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;  // the lower vertex first
using Splits = std::map<Edge, std::uint32_t>;          // by which vertex

void merge_near_vertices(RuleBorder& border, double distance) {
  Representatives near = representatives_within(border.mesh.vertices, distance);
  border.mesh.vertices = std::move(near.vertices);
  std::vector<Triangle>& triangles = border.mesh.triangles;
  for (Triangle& t : triangles) {
    for (std::uint32_t& corner : t) corner = near.of[corner];
  }
  keep_where([&](std::size_t face) { return !is_collapsed(triangles[face]); }, triangles, border.sources);
}

// The place of the corner that is so near to the opposite side, which is the longest one.
std::optional<std::size_t> flat_corner(const TriangleMesh& mesh, const Triangle& t, double distance) {
  const auto side = [&](std::size_t n) { return mesh.vertices[t[(n + 2) % 3]] - mesh.vertices[t[(n + 1) % 3]]; };
  const std::array lengths{safe_norm(side(0)), safe_norm(side(1)), safe_norm(side(2))};
  const auto apex = static_cast<std::size_t>(std::ranges::max_element(lengths) - lengths.begin());
  const Vec3 direction = (1.0 / lengths[apex]) * side(apex);
  const double height = safe_norm(cross(direction, side((apex + 1) % 3)));
  if (height > distance) return std::nullopt;
  return apex;
}

Splits splits_at_flat_triangles(const TriangleMesh& mesh, double distance) {
  Splits splits;
  for (const Triangle& t : mesh.triangles) {
    if (const std::optional<std::size_t> apex = flat_corner(mesh, t, distance))
      splits.try_emplace(std::minmax(t[(*apex + 1) % 3], t[(*apex + 2) % 3]), t[*apex]);
  }
  return splits;
}

// Where the side opposite to a corner is split.
Splits::const_iterator split_opposite(const Splits& splits, const Triangle& t, std::size_t corner) {
  return splits.find(std::minmax(t[(corner + 1) % 3], t[(corner + 2) % 3]));
}

// Whether a side is split at the corner opposite to it: then it goes along the two others, and nothing is left between.
bool is_gone(const Splits& splits, const Triangle& t) {
  for (std::size_t i = 0; i < 3; ++i) {
    const auto split = split_opposite(splits, t, i);
    if (split != splits.end() && split->second == t[i]) return true;
  }
  return is_collapsed(t);
}

// Adds the parts of a triangle whose sides are split, but for those without area. Whether that was possible: rounding
// may let splits go around.
bool add_parts(const Triangle& triangle, std::uint32_t source, const Splits& splits, Effort& effort,
               RuleBorder& result) {
  std::vector<Triangle> parts{triangle};
  while (!parts.empty()) {
    if (!effort.take()) return false;
    const Triangle t = parts.back();
    parts.pop_back();
    if (is_gone(splits, t)) continue;
    std::size_t i = 0;
    while (i < 3 && split_opposite(splits, t, i) == splits.end()) ++i;
    if (i < 3) {
      const std::uint32_t apex = t[i], from = t[(i + 1) % 3], to = t[(i + 2) % 3];
      const std::uint32_t at = split_opposite(splits, t, i)->second;
      parts.push_back({apex, from, at});
      parts.push_back({apex, at, to});
      continue;
    }
    result.mesh.triangles.push_back(t);
    result.sources.push_back(source);
  }
  return true;
}

// Of each vertex the others that it shares a triangle with, one after the other.
class Neighbours {
 public:
  explicit Neighbours(const TriangleMesh& mesh) : first_(mesh.vertices.size() + 1) {
    for (const Triangle& t : mesh.triangles) {
      for (const std::uint32_t corner : t) first_[corner + 1] += 2;
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    others_.resize(first_.back());
    end_ = first_;
    for (const Triangle& t : mesh.triangles) {
      for (std::size_t n = 0; n < 3; ++n) {
        others_[end_[t[n]]++] = t[(n + 1) % 3];
        others_[end_[t[n]]++] = t[(n + 2) % 3];
      }
    }
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      const std::span<std::uint32_t> all = std::span(others_).subspan(first_[v], end_[v] - first_[v]);
      std::ranges::sort(all);
      end_[v] = first_[v] + static_cast<std::size_t>(std::unique(all.begin(), all.end()) - all.begin());
    }
  }
  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t vertex) const {
    return std::span(others_).subspan(first_[vertex], end_[vertex] - first_[vertex]);
  }

 private:
  std::vector<std::size_t> first_, end_;  // of each vertex's in others_
  std::vector<std::uint32_t> others_;
};

// Which points are no farther from a triangle's plane than a distance, and over its inside, farther than that from its
// sides.
class NearInside {
 public:
  NearInside(const TriangleMesh& mesh, const Triangle& t, double distance)
      : corners_(corners_of(mesh, t)), area_(cross(corners_[1] - corners_[0], corners_[2] - corners_[0])) {
    const double size = safe_norm(area_);
    off_plane_ = size > 0.0 ? distance * size : -1.0;
    for (std::size_t n = 0; n < 3; ++n) off_side_[n] = distance * size * safe_norm(corners_[(n + 1) % 3] - corners_[n]);
  }

  [[nodiscard]] bool holds(const Vec3& p) const {
    if (!(std::abs(dot(corners_[0] - p, area_)) <= off_plane_)) return false;
    for (std::size_t n = 0; n < 3; ++n) {
      if (!(dot(cross(corners_[n] - p, corners_[(n + 1) % 3] - p), area_) > off_side_[n])) return false;
    }
    return true;
  }

 private:
  Corners3 corners_;
  Vec3 area_;
  double off_plane_;                // by how much they may be, times the length of area_; nothing has no area
  std::array<double, 3> off_side_;  // by how much they must be, times that and the side's length
};

// For each triangle, a vertex on it that shares a triangle with one of its corners, but is none of them; none where
// there is no such vertex.
std::vector<std::optional<std::uint32_t>> corners_on_triangles(const TriangleMesh& mesh, double distance) {
  const Neighbours neighbours(mesh);
  std::vector<std::optional<std::uint32_t>> found(mesh.triangles.size());
  parallel_for_each(found.size(), 256, [&](std::size_t face) {
    const Triangle& t = mesh.triangles[face];
    const NearInside inside(mesh, t, distance);
    for (const std::uint32_t corner : t) {
      const std::span<const std::uint32_t> others = neighbours.of(corner);
      const auto on = std::ranges::find_if(others, [&](std::uint32_t v) {
        return inside.holds(mesh.vertices[v]) && std::ranges::find(t, v) == t.end();
      });
      if (on == others.end()) continue;
      found[face] = *on;
      return;
    }
  });
  return found;
}

// Cuts triangles in three at the neighbours of their corners that are on them. Whether there were any.
bool split_at_corners_on_triangles(RuleBorder& border, double distance) {
  const std::vector<std::optional<std::uint32_t>> corners = corners_on_triangles(border.mesh, distance);
  for (std::size_t face = 0; face < corners.size(); ++face) {
    if (!corners[face]) continue;
    const std::uint32_t v = *corners[face];
    const Triangle t = border.mesh.triangles[face];
    border.mesh.triangles[face] = {t[0], t[1], v};
    border.mesh.triangles.insert(border.mesh.triangles.end(), {{t[1], t[2], v}, {t[2], t[0], v}});
    border.sources.insert(border.sources.end(), 2, border.sources[face]);
  }
  return border.sources.size() > corners.size();
}

// Cuts triangles at corners of flat ones. Whether it did: not where there are none, nor where that makes too many.
bool split_at_flat_triangles(RuleBorder& border, double distance) {
  constexpr std::uint64_t kMostTimes = 8;
  const Splits splits = splits_at_flat_triangles(border.mesh, distance);
  if (splits.empty()) return false;
  Effort effort(kMostTimes * border.sources.size());
  RuleBorder split{{border.mesh.vertices, {}}, {}};
  for (std::size_t face = 0; face < border.sources.size(); ++face) {
    const Triangle& t = border.mesh.triangles[face];
    if (!add_parts(t, border.sources[face], splits, effort, split)) return false;
  }
  border = std::move(split);
  return true;
}

// Takes out pairs of triangles with the same corners in opposite directions: of all triangles with the same corners,
// the first ones of the direction that has more are left.
void cancel(RuleBorder& border) {
  struct Sorted {
    Triangle corners;  // in order
    std::uint32_t face;
    int direction;  // 1 of an even permutation, else -1
  };
  std::vector<Sorted> faces;
  faces.reserve(border.sources.size());
  for (Triangle t : border.mesh.triangles) {
    const bool is_even = (t[0] < t[1]) == ((t[1] < t[2]) == (t[0] < t[2]));
    std::ranges::sort(t);
    faces.push_back({t, static_cast<std::uint32_t>(faces.size()), is_even ? 1 : -1});
  }
  std::ranges::sort(faces, {}, [](const Sorted& s) { return std::tie(s.corners, s.face); });
  std::vector<bool> stays(faces.size(), false);
  for (std::size_t begin = 0, end = 0; begin < faces.size(); begin = end) {
    int more = 0;
    for (; end < faces.size() && faces[end].corners == faces[begin].corners; ++end) more += faces[end].direction;
    for (std::size_t n = begin; n < end; ++n) {
      if (more * faces[n].direction <= 0) continue;
      more -= faces[n].direction;
      stays[faces[n].face] = true;
    }
  }
  keep_where([&](std::size_t n) { return stays[n]; }, border.mesh.triangles, border.sources);
}

}  // namespace

void snap(RuleBorder& border, double distance) {
  constexpr int kRounds = 8;
  merge_near_vertices(border, distance);
  bool had_corners = false;
  for (int round = 0; round < kRounds; ++round) {
    const bool had_flat = split_at_flat_triangles(border, distance);
    cancel(border);
    had_corners = split_at_corners_on_triangles(border, distance);
    if (!had_corners && !had_flat) break;
  }
  if (had_corners) cancel(border);
  border.mesh = used_part(border.mesh.vertices, std::move(border.mesh.triangles));
}

}  // namespace raycone
