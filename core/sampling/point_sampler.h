// Points drawn in a box, on a surface and near it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/sampling/random.h"

namespace raycone {

struct UniformSamples {
  std::uint64_t count = 0;  // in the closed box
};
struct NearSamples {
  std::uint64_t count = 0;  // on the surface by area, each coordinate then moved by normal noise
  double sigma = 0.0;       // its standard deviation, in diagonals of the mesh's box
};
struct SurfaceSamples {
  std::uint64_t count = 0;  // on the surface, by area
};
using SampleGroup = std::variant<UniformSamples, NearSamples, SurfaceSamples>;

// Group after group; each point depends on the mesh, the box, the group, the seed and its number alone. Thread-safe.
class PointSampler {
 public:
  // Precondition: at least one triangle.
  PointSampler(const TriangleMesh& mesh, const Box& box, std::vector<SampleGroup> groups, std::uint64_t seed);

  [[nodiscard]] std::uint64_t size() const { return size_; }
  // Whether there is a surface to draw from, if a group needs one: not all triangles are degenerate.
  [[nodiscard]] bool has_needed_area() const { return areas_.empty() || areas_.back() > 0.0; }

  // Whether every point is finite: no box and no noise is so large that coordinates overflow.
  [[nodiscard]] bool is_finite() const;

  // The points number first to first + points.size() - 1, up to size(). Needs is_finite() and
  // has_needed_area(). With sigma 0 they lie in their triangle's box, and in its plane but for a few u of its
  // coordinates. Faces without area have no points. Uses the threads that ThreadLimit allows.
  void draw(std::uint64_t first, std::span<Vec3> points) const;
  // The same, with the number of the triangle that each point of SurfaceSamples lies on; -1 of other groups.
  void draw(std::uint64_t first, std::span<Vec3> points, std::span<std::int64_t> faces) const;

  // Of the triangles that draw() tells of: of length 1, as they face; 0 for -1. Uses as many threads as draw().
  void set_normals(std::span<const std::int64_t> faces, std::span<Vec3> normals) const;

 private:
  // A point, and the number of the triangle that it lies on, or -1.
  struct Drawn {
    Vec3 point;
    std::int64_t face = -1;
  };
  [[nodiscard]] Drawn drawn(std::uint64_t number) const;
  [[nodiscard]] Drawn on_surface(Random& random) const;
  [[nodiscard]] std::size_t triangle_at(double area) const;
  [[nodiscard]] double noise_of(const NearSamples& near) const;

  TriangleMesh mesh_;  // none where no group needs its triangles
  Box box_, box_of_mesh_;
  double diagonal_;
  std::vector<SampleGroup> groups_;
  std::uint64_t seed_;
  std::uint64_t size_ = 0;
  std::vector<double> areas_;  // of the triangles up to each, in some unit; none where no group needs them
  // The areas cut into equal steps, as many as triangles: at each step the first triangle that reaches beyond it.
  std::vector<std::uint32_t> first_beyond_;
};

}  // namespace raycone
