#include "core/arrangement/arranged_patches.h"

#include <algorithm>
#include <numeric>
#include <span>

#include "core/data/vec3.h"
#include "core/mesh/face_edges.h"

namespace raycone {
namespace {

std::uint32_t root_of(std::vector<std::uint32_t>& parents, std::uint32_t face) {
  while (parents[face] != face) face = parents[face] = parents[parents[face]];
  return face;
}

// How many more triangles have an edge forward than backward.
std::int64_t forward(std::span<const FaceEdge> edge, const Arrangement& arrangement) {
  std::int64_t sum = 0;
  for (const FaceEdge& of_face : edge) {
    const std::int64_t multiplicity = arrangement.multiplicity(of_face.face);
    sum += of_face.is_forward ? multiplicity : -multiplicity;
  }
  return sum;
}

// As good as doubles are: only where a patch is looked at depends on it.
double area_of(const Triangle& triangle, const Arrangement& arrangement) {
  const Vec3 a = arrangement.rounded(triangle[0]);
  return safe_norm(cross(arrangement.rounded(triangle[1]) - a, arrangement.rounded(triangle[2]) - a));
}

// `roots`: of each triangle the first one of its patch.
ArrangedPatches numbered(const std::vector<std::uint32_t>& roots, const Arrangement& arrangement) {
  ArrangedPatches patches{std::vector<std::uint32_t>(roots.size()), {}};
  std::vector<double> largest_areas;
  for (std::uint32_t triangle = 0; triangle < roots.size(); ++triangle) {
    const std::uint32_t root = roots[triangle];
    const double area = area_of(arrangement.triangles()[triangle], arrangement);
    if (root == triangle) {
      patches.of_triangle[triangle] = static_cast<std::uint32_t>(patches.largest.size());
      patches.largest.push_back(triangle);
      largest_areas.push_back(area);
      continue;
    }
    const std::uint32_t patch = patches.of_triangle[triangle] = patches.of_triangle[root];
    if (area <= largest_areas[patch]) continue;
    patches.largest[patch] = triangle;
    largest_areas[patch] = area;
  }
  return patches;
}

}  // namespace

std::optional<ArrangedPatches> patches_of(const Arrangement& arrangement) {
  const std::vector<Triangle>& triangles = arrangement.triangles();
  std::vector<std::uint32_t> parents(triangles.size());
  std::iota(parents.begin(), parents.end(), 0);
  bool is_closed = true;
  const std::vector<FaceEdge> edges = face_edges(triangles);
  for_each_edge(edges, [&](std::span<const FaceEdge> edge) {
    is_closed = is_closed && forward(edge, arrangement) == 0;
    if (edge.size() != 2) return;
    const std::uint32_t a = root_of(parents, edge[0].face), b = root_of(parents, edge[1].face);
    parents[std::max(a, b)] = std::min(a, b);
  });
  if (!is_closed) return std::nullopt;
  for (std::uint32_t triangle = 0; triangle < parents.size(); ++triangle) {
    parents[triangle] = root_of(parents, triangle);
  }
  return numbered(parents, arrangement);
}

}  // namespace raycone
