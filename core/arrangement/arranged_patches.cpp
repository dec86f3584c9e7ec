#include "core/arrangement/arranged_patches.h"

#include <span>
#include <utility>

#include "core/data/vec3.h"
#include "core/mesh/disjoint_sets.h"
#include "core/mesh/face_edges.h"

namespace raycone {
namespace {

// How many more triangles have an edge forward than backward.
std::int64_t forward(std::span<const FaceEdge> edge, const Arrangement& arrangement) {
  std::int64_t sum = 0;
  for (const FaceEdge& of_face : edge) {
    const std::int64_t multiplicity = arrangement.multiplicity(of_face.face);
    sum += of_face.is_forward ? multiplicity : -multiplicity;
  }
  return sum;
}

// In doubles: only which point of a patch is looked at depends on it.
double doubled_area(const Triangle& triangle, const Arrangement& arrangement) {
  const Vec3 a = arrangement.rounded(triangle[0]);
  return safe_norm(cross(arrangement.rounded(triangle[1]) - a, arrangement.rounded(triangle[2]) - a));
}

// Patches with the numbers of their triangles, of which the first ones are in order.
ArrangedPatches with_largest(std::vector<std::uint32_t> of_triangle, const Arrangement& arrangement) {
  ArrangedPatches patches{std::move(of_triangle), {}};
  std::vector<double> largest_areas;
  for (std::uint32_t triangle = 0; triangle < patches.of_triangle.size(); ++triangle) {
    const std::uint32_t patch = patches.of_triangle[triangle];
    const double area = doubled_area(arrangement.triangles()[triangle], arrangement);
    if (patch == patches.largest.size()) {
      patches.largest.push_back(triangle);
      largest_areas.push_back(area);
    } else if (area > largest_areas[patch]) {
      patches.largest[patch] = triangle;
      largest_areas[patch] = area;
    }
  }
  return patches;
}

}  // namespace

std::optional<ArrangedPatches> patches_of(const Arrangement& arrangement) {
  const std::vector<Triangle>& triangles = arrangement.triangles();
  DisjointSets<> patches(triangles.size());
  bool is_closed = true;
  const std::vector<FaceEdge> edges = face_edges(triangles);
  for_each_edge(edges, [&](std::span<const FaceEdge> edge) {
    is_closed = is_closed && forward(edge, arrangement) == 0;
    if (edge.size() == 2) patches.join(edge[0].face, edge[1].face);
  });
  if (!is_closed) return std::nullopt;
  return with_largest(patches.indices(), arrangement);
}

}  // namespace raycone
