#include "core/orientation/crossing_votes.h"

#include <array>
#include <cmath>

#include "core/crossings/crossings.h"
#include "core/crossings/projected_grid.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// With `axis` along x.
Vec3 turned_to_x(const Vec3& p, int axis) { return {p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]}; }

Vec3 unit_normal(const CanonicalFace& face) {
  const Vec3 normal = face.sign * cross(face.corners[1] - face.corners[0], face.corners[2] - face.corners[0]);
  const double length = std::sqrt(dot(normal, normal));
  return length > 0.0 ? (1.0 / length) * normal : Vec3{};
}

class AxisRays {
 public:
  AxisRays(const std::vector<Triangle>& faces, const std::vector<Vec3>& vertices, int axis)
      : vertices_(vertices), axis_(axis), mesh_(turned(faces, vertices, axis)), grid_(mesh_) {}

  [[nodiscard]] double vote(const SurfaceSample& sample) const {
    const double across = unit_normal(sample.face)[axis_];
    const Vec3 q = turned_to_x(sample.at, axis_);
    constexpr double kBeforeAll = -2.0;
    const std::array<double, 2> xs{kBeforeAll, q.x};
    const Row row{q.y, q.z, xs, 0.0};
    std::size_t ahead = 0, behind = 0;
    grid_.for_each_candidate(row.query(0), [&](std::uint32_t triangle) {
      const Triangle& t = mesh_.triangles[triangle];
      const TriangleCrossing crossing =
          triangle_crossing(mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]], row, nullptr);
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

}  // namespace

std::vector<double> crossing_votes(const std::vector<Triangle>& faces, const std::vector<Vec3>& vertices,
                                   const std::vector<SurfaceSample>& samples) {
  constexpr std::size_t kSamplesPerTask = 64;
  std::vector<double> votes(samples.size(), 0.0);
  for (int axis = 0; axis < 3; ++axis) {
    const AxisRays rays(faces, vertices, axis);
    parallel_for(samples.size(), kSamplesPerTask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) votes[k] += rays.vote(samples[k]);
    });
  }
  return votes;
}

}  // namespace raycone
