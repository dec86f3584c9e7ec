// Which triangle of a mesh is nearest to a point.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/distance/triangle_distance.h"
#include "core/exact/scale.h"

namespace raycone {

class NearestTriangle {
 public:
  // Precondition: the mesh has a triangle, and the vertices that triangles use are finite.
  explicit NearestTriangle(const TriangleMesh& mesh);

  // Of those whose computed distances are least, the first. `guess`: the nearer that triangle is, the sooner it is
  // found. Thread-safe.
  [[nodiscard]] std::uint32_t of(const Vec3& p, std::uint32_t guess = 0) const;

 private:
  // Triangles [begin, end) of order_; what it is made of follows it, up to `next`.
  struct Branch {
    Box box;
    std::uint32_t begin, end, next;
  };
  void build(std::uint32_t begin, std::uint32_t end);

  PowerOfTwo scale_;
  std::vector<TriangleDistance> triangles_;  // scaled
  std::vector<Box> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Branch> branches_;
};

}  // namespace raycone
