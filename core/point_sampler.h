// Points drawn in a box and near a surface.
#pragma once

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "core/random.h"
#include "core/triangle_mesh.h"

namespace raycone {

struct UniformSamples {
  std::uint64_t count = 0;  // in the box
};
struct NearSamples {
  std::uint64_t count = 0;  // on the surface by area, each coordinate then moved by normal noise
  double sigma = 0.0;       // its standard deviation, in diagonals of the mesh's box
};
using SampleGroup = std::variant<UniformSamples, NearSamples>;

// Group after group; each point depends on the mesh, the box, the group, the seed and its number alone.
class PointSampler {
 public:
  PointSampler(const TriangleMesh& mesh, const Box& box, std::vector<SampleGroup> groups, std::uint64_t seed);

  [[nodiscard]] std::uint64_t size() const { return size_; }
  // Whether there is a surface to draw from: not all triangles are degenerate.
  [[nodiscard]] bool has_area() const { return !areas_.empty() && areas_.back() > 0.0; }

  // The points number first to first + points.size() - 1. Points near a surface need has_area(). Uses the threads that
  // ThreadLimit allows.
  void draw(std::uint64_t first, std::span<Vec3> points) const;

 private:
  [[nodiscard]] Vec3 point(std::uint64_t number) const;
  [[nodiscard]] Vec3 on_surface(Random& random) const;

  TriangleMesh mesh_;
  Box box_;
  double diagonal_;
  std::vector<SampleGroup> groups_;
  std::uint64_t seed_;
  std::uint64_t size_ = 0;
  std::vector<double> areas_;  // of the triangles up to each, in some unit
};

}  // namespace raycone
