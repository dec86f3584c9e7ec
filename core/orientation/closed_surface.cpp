#include "core/orientation/closed_surface.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/orientation/canonical_face.h"

namespace raycone {
namespace {

constexpr double kMostParts = 16.0;  // of a side

struct SizedFace {
  double half_side;  // of its box, the longest one
  CanonicalFace face;

  bool operator<(const SizedFace& other) const {
    return half_side != other.half_side ? half_side > other.half_side : face < other.face;
  }
};

// All, or of more than `most` so many.
std::vector<SizedFace> largest_faces(const ClosedSurface& surface, const std::vector<Vec3>& vertices,
                                     std::size_t most) {
  std::vector<SizedFace> faces;
  faces.reserve(surface.faces.size());
  for (const Triangle& t : surface.faces) {
    const Box box = box_of(corners_of(vertices, t));
    faces.push_back({half_longest_side(box), canonical_face(t, vertices)});
  }
  if (faces.size() <= most) return faces;
  const auto last = faces.begin() + static_cast<std::ptrdiff_t>(most);
  std::nth_element(faces.begin(), last, faces.end());
  faces.erase(last, faces.end());
  return faces;
}

// The middles of the parts of a face whose sides are cut in so many.
void add_middles(const CanonicalFace& face, int parts, std::vector<Vec3>& points) {
  const Vec3 &a = face.corners[0], &b = face.corners[1], &c = face.corners[2];
  const auto add = [&](double i, double j) {
    const double u = i / parts, v = j / parts;
    points.push_back((1 - u - v) * a + u * b + v * c);
  };
  for (int i = 0; i < parts; ++i) {
    for (int j = 0; i + j < parts; ++j) {
      add(i + 1.0 / 3, j + 1.0 / 3);
      if (i + j + 1 < parts) add(i + 2.0 / 3, j + 2.0 / 3);
    }
  }
}

}  // namespace

double half_longest_side(const Box& box) {
  const Vec3 half = 0.5 * box.upper - 0.5 * box.lower;
  return std::max({half.x, half.y, half.z});
}

std::vector<Vec3> vertices_of(const ClosedSurface& surface, const std::vector<Vec3>& vertices) {
  std::vector<std::uint32_t> used;
  used.reserve(3 * surface.faces.size());
  for (const Triangle& t : surface.faces) used.insert(used.end(), t.begin(), t.end());
  std::ranges::sort(used);
  used.erase(std::unique(used.begin(), used.end()), used.end());
  std::vector<Vec3> points;
  points.reserve(used.size());
  for (const std::uint32_t v : used) points.push_back(vertices[v]);
  return points;
}

std::vector<Vec3> points_on_faces(const ClosedSurface& surface, const std::vector<Vec3>& vertices, const Box& box,
                                  std::size_t most) {
  std::vector<Vec3> points;
  const double extent = half_longest_side(box);
  if (!(extent > 0.0)) return points;
  const std::vector<SizedFace> faces = largest_faces(surface, vertices, most);
  const double share = std::floor(std::sqrt(static_cast<double>(most) / static_cast<double>(faces.size())));
  for (const SizedFace& face : faces) {
    const double parts = std::ceil(kMostParts * (face.half_side / extent));
    add_middles(face.face, static_cast<int>(std::clamp(parts, 1.0, std::clamp(share, 1.0, kMostParts))), points);
  }
  return points;
}

}  // namespace raycone
