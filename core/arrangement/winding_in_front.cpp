#include "core/arrangement/winding_in_front.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <limits>

#include "core/data/vec3.h"
#include "core/machine/threads.h"
#include "core/mesh/ray_grid.h"

namespace raycone {
namespace {

using Number = ExactPoints::Number;
using Weights = std::array<std::uint32_t, 3>;

// A point within a triangle, from which a ray goes along an axis.
struct Probe {
  std::size_t triangle;  // its place among those that are asked about
  Number point;
  bool looks_along;  // the front of the triangle does, as the ray
};

// How a ray meets a face.
struct Meeting {
  int leaves = 0;  // 1 through its front, -1 through its back
  bool at_edge = false;
};

Meeting meeting_of(Number from, int axis, const Corners3& face, const ExactPoints& points) {
  bool is_left = false, is_right = false, at_edge = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const int turn = points.turn(axis, face[i], face[(i + 1) % 3], from);
    is_left = is_left || turn > 0;
    is_right = is_right || turn < 0;
    at_edge = at_edge || turn == 0;
  }
  if (is_left && is_right) return {};
  if (at_edge) return {0, true};
  const int along = is_left ? 1 : -1;  // where the front looks
  return {points.side(face, from) == -along ? along : 0, false};
}

class Rays {
 public:
  Rays(const std::vector<std::uint32_t>& triangles, Arrangement& arrangement, const TriangleMesh& mesh)
      : triangles_(triangles), arrangement_(arrangement), mesh_(mesh), found_(triangles.size()) {}

  // For each triangle whose winding number is not known yet, sends a ray from the point with these weights. Returns
  // whether any is still not known, as its ray met an edge.
  bool send(const Weights& weights) {
    std::array<std::vector<Probe>, 3> probes;  // by axis
    for (std::size_t n = 0; n < triangles_.size(); ++n) {
      if (!found_[n]) add_probe(n, weights, probes);
    }
    for (int axis = 0; axis < 3; ++axis) send(axis, probes[static_cast<std::size_t>(axis)]);
    return std::ranges::any_of(found_, [](const auto& winding) { return !winding; });
  }

  [[nodiscard]] std::vector<std::int64_t> windings() const {
    std::vector<std::int64_t> result;
    for (const std::optional<std::int64_t>& winding : found_) result.push_back(*winding);
    return result;
  }

 private:
  void add_probe(std::size_t n, const Weights& weights, std::array<std::vector<Probe>, 3>& probes) {
    const Triangle& t = arrangement_.triangles()[triangles_[n]];
    std::array<Number, 3> corners{};
    std::ranges::transform(t, corners.begin(), [&](std::uint32_t corner) { return arrangement_.point(corner); });
    const int axis = arrangement_.points().axis_to_see(corners);
    const int turn = arrangement_.points().turn(axis, corners[0], corners[1], corners[2]);
    const Number point = arrangement_.points().add_between(corners, weights);
    probes[static_cast<std::size_t>(axis)].push_back({n, point, turn > 0});
  }

  void send(int axis, const std::vector<Probe>& probes) {
    constexpr std::size_t kGrain = 4096;
    if (probes.empty()) return;
    const ExactPoints& points = arrangement_.points();
    const auto turned = [axis](const Vec3& p) { return Vec3{p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]}; };
    std::vector<Vec3> places;
    for (const Probe& probe : probes) places.push_back(turned(points.rounded(probe.point)));
    const RayGrid grid(places);  // rounding keeps the order of coordinates, by which it finds rays
    std::vector<std::atomic<std::int64_t>> sums(probes.size());
    std::vector<std::atomic<bool>> at_edges(probes.size());
    parallel_for_each(mesh_.triangles.size(), kGrain, [&](std::size_t n) {
      const Corners3 face = corners_of(mesh_, mesh_.triangles[n]);
      constexpr double kAll = -std::numeric_limits<double>::infinity();
      grid.for_each_ray(turned(face[0]), turned(face[1]), turned(face[2]), kAll, [&](std::size_t i) {
        const Meeting meeting = meeting_of(probes[i].point, axis, face, points);
        sums[i] += meeting.leaves;
        if (meeting.at_edge) at_edges[i] = true;
      });
    });
    for (std::size_t i = 0; i < probes.size(); ++i) {
      const auto& [n, point, looks_along] = probes[i];
      if (!at_edges[i]) found_[n] = sums[i] - (looks_along ? 0 : arrangement_.multiplicity(triangles_[n]));
    }
  }

  const std::vector<std::uint32_t>& triangles_;
  Arrangement& arrangement_;
  const TriangleMesh& mesh_;
  std::vector<std::optional<std::int64_t>> found_;
};

}  // namespace

std::optional<std::vector<std::int64_t>> windings_in_front(const std::vector<std::uint32_t>& triangles,
                                                           Arrangement& arrangement, const TriangleMesh& mesh) {
  // Such that no lattice and no symmetry of a mesh has them.
  constexpr std::array<Weights, 8> kWeights{{{101, 89, 97},
                                             {61, 83, 139},
                                             {151, 71, 43},
                                             {59, 149, 113},
                                             {31, 137, 163},
                                             {167, 29, 73},
                                             {17, 23, 191},
                                             {193, 11, 19}}};
  Rays rays(triangles, arrangement, mesh);
  const bool is_done = std::ranges::any_of(kWeights, [&](const Weights& weights) { return !rays.send(weights); });
  if (!is_done) return std::nullopt;
  return rays.windings();
}

}  // namespace raycone
