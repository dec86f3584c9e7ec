#include "core/orientation/crossing_votes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/crossings/crossings.h"
#include "core/crossings/projected_grid.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// With `axis` along x.
Vec3 turned_to_x(const Vec3& p, int axis) { return {p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]}; }

// Of the angle between the front's normal and an axis; 0 where there is no area.
double cosine_to_axis(const CanonicalFace& face, int axis) {
  const Vec3 normal = face.sign * cross(face.corners[1] - face.corners[0], face.corners[2] - face.corners[0]);
  const double length = std::sqrt(dot(normal, normal));
  return length > 0.0 ? (1.0 / length) * normal[axis] : 0.0;
}

class AxisRays {
 public:
  AxisRays(const std::vector<Triangle>& faces, const std::vector<Vec3>& vertices, int axis)
      : vertices_(vertices), axis_(axis), mesh_(turned(faces, vertices, axis)), grid_(mesh_) {}

  [[nodiscard]] double vote(const SurfaceSample& sample) const {
    const double across = cosine_to_axis(sample.face, axis_);
    const Vec3 q = turned_to_x(sample.at, axis_);
    constexpr double kBeforeAll = -2.0;
    const std::array<double, 2> xs{kBeforeAll, q.x};
    const Row row{q.y, q.z, xs, 0.0};
    std::size_t ahead = 0, behind = 0;
    grid_.for_each_candidate(row.query(0), [&](std::uint32_t triangle) {
      const Triangle& t = mesh_.triangles[triangle];
      const auto [a, b, c] = corners_of(mesh_, t);
      const TriangleCrossing crossing = triangle_crossing(a, b, c, row);
      if (crossing.crossed == 0 || (canonical_face(t, vertices_) <=> sample.face) == 0) return;
      ++(crossing.crossed == xs.size() ? ahead : behind);
    });
    return (ahead % 2 == 0 ? across : -across) + (behind % 2 == 0 ? -across : across);
  }

 private:
  static TriangleMesh turned(const std::vector<Triangle>& faces, const std::vector<Vec3>& vertices, int axis) {
    TriangleMesh mesh{{}, faces};
    mesh.vertices.reserve(vertices.size());
    for (const Vec3& p : vertices) mesh.vertices.push_back(turned_to_x(p, axis));
    return mesh;
  }

  const std::vector<Vec3>& vertices_;
  int axis_;
  TriangleMesh mesh_;
  ProjectedGrid grid_;
};

// Faces whose box a ray along an axis meets, on average. By counting at some samples: what a grid finds may depend on
// the order of faces.
double faces_per_ray(const std::vector<Triangle>& faces, const std::vector<Vec3>& vertices,
                     const std::vector<SurfaceSample>& samples) {
  constexpr std::size_t kCounted = 64;
  const std::size_t step = samples.size() / kCounted + 1;
  std::uint64_t met = 0, rays = 0;
  for (std::size_t k = 0; k < samples.size(); k += step) {
    const Vec3& q = samples[k].at;
    rays += 3;
    for (const Triangle& t : faces) {
      std::array<bool, 3> within{};
      for (int axis = 0; axis < 3; ++axis) {
        const double a = vertices[t[0]][axis], b = vertices[t[1]][axis], c = vertices[t[2]][axis];
        const double least = std::min(std::min(a, b), c), most = std::max(std::max(a, b), c);
        within[static_cast<std::size_t>(axis)] = least <= q[axis] && q[axis] <= most;
      }
      const auto [x, y, z] = within;
      met += std::uint64_t{x && y} + std::uint64_t{y && z} + std::uint64_t{z && x};
    }
  }
  return static_cast<double>(met) / static_cast<double>(std::max<std::uint64_t>(rays, 1));
}

// All of them nearly always. Where many faces lie behind each other, as many as there is time for: rays through so many
// say little anyway.
std::size_t samples_that_vote(const std::vector<Triangle>& faces, const std::vector<Vec3>& vertices,
                              const std::vector<SurfaceSample>& samples) {
  constexpr double kMostTests = 1e8;  // some seconds
  const double most = kMostTests / (3 * std::max(faces_per_ray(faces, vertices, samples), 1.0));
  return static_cast<std::size_t>(std::min(most, static_cast<double>(samples.size())));
}

}  // namespace

std::vector<double> crossing_votes(const std::vector<Triangle>& faces, const std::vector<Vec3>& vertices,
                                   const std::vector<SurfaceSample>& samples) {
  constexpr std::size_t kSamplesPerTask = 64;
  std::vector<double> votes(samples.size(), 0.0);
  const std::size_t voting = samples_that_vote(faces, vertices, samples);
  for (int axis = 0; axis < 3; ++axis) {
    const AxisRays rays(faces, vertices, axis);
    parallel_for_each(voting, kSamplesPerTask, [&](std::size_t k) { votes[k] += rays.vote(samples[k]); });
  }
  return votes;
}

}  // namespace raycone
