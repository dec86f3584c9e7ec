// Representatives of vertices within a distance of each other.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/vec3.h"

namespace raycone {

// Vertices that stand for others, and for each vertex the one that stands for it.
struct Representatives {
  std::vector<Vec3> vertices;  // in lexicographic order
  std::vector<std::uint32_t> of;
};

// Greedily in lexicographic order of (x, y, z): a vertex joins the first representative that is_near() it, or becomes
// one. Vertices that are not finite are near nothing. `distance` is positive and finite. For n vertices it takes a time
// of n log n, wherever they are: at most 2^32 - 1 different ones.
[[nodiscard]] Representatives representatives_within(const std::vector<Vec3>& vertices, double distance);

// Whether the distance of a and b, as std::hypot() gives it, is at most `distance`, a positive number.
[[nodiscard]] bool is_near(const Vec3& a, const Vec3& b, double distance);

}  // namespace raycone
