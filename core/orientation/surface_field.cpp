#include "core/orientation/surface_field.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "core/boundary/sample_tile.h"
#include "core/machine/threads.h"
#include "core/orientation/canonical_face.h"
#include "core/orientation/ray_sums.h"

namespace raycone {
namespace {

// Integers can be added in any order.
constexpr double kAreaUnits = 0x1p60;
constexpr double kTurnUnits = 0x1p52;
constexpr std::size_t kLargeSurface = 32;  // faces: from here on the cone is faster than a sum over all of them

std::int64_t in_units(double value, double units) { return std::llround(value * units); }

// Van Oosterom and Strackee 1983, eq. 8. On the face: the mean of both sides.
double turns_of(const Corners3& corners, const Vec3& q) {
  const Vec3 a = corners[0] - q, b = corners[1] - q, c = corners[2] - q;
  constexpr double kOnFace = 1e-9;  // of the imaginary part beside the real one: far above rounding
  const double la = norm(a), lb = norm(b), lc = norm(c);
  const double real = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  const double imaginary = dot(a, cross(b, c));
  if (real < 0.0 && std::abs(imaginary) < -kOnFace * real) return 0.0;
  return std::atan2(imaginary, real) / (2.0 * std::numbers::pi);
}

// Whether two corners are at one place, as where they were moved together.
bool has_met_corners(const Triangle& t, const std::vector<Vec3>& vertices) {
  return vertices[t[0]] == vertices[t[1]] || vertices[t[1]] == vertices[t[2]] || vertices[t[2]] == vertices[t[0]];
}

// A mesh of these faces. Of a small part of a mesh, without the other vertices.
TriangleMesh mesh_of(const std::vector<Triangle>& faces, const std::vector<Vec3>& vertices, int sign) {
  TriangleMesh mesh{{}, faces};
  if (sign < 0) {
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  }
  if (faces.size() > vertices.size() / 16) {
    mesh.vertices = vertices;
    return mesh;
  }
  std::vector<std::uint32_t> used;
  for (const Triangle& t : faces) used.insert(used.end(), t.begin(), t.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  for (const std::uint32_t v : used) mesh.vertices.push_back(vertices[v]);
  for (Triangle& t : mesh.triangles) {
    for (std::uint32_t& v : t) {
      v = static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), v) - used.begin());
    }
  }
  return mesh;
}

// Without its area.
SurfaceDipole dipole_about(const Box& box) {
  SurfaceDipole dipole;
  dipole.centre = middle(box);
  dipole.radius = 0.5 * norm(box.upper - box.lower);
  return dipole;
}

}  // namespace

SurfaceDipole dipole_of(const std::vector<Triangle>& faces, const std::vector<Vec3>& vertices, int sign) {
  std::array<__int128, 3> area{};
  for (const Triangle& t : faces) {
    const CanonicalFace face = canonical_face(t, vertices);
    const Vec3 twice = cross(face.corners[1] - face.corners[0], face.corners[2] - face.corners[0]);
    for (int axis = 0; axis < 3; ++axis) {
      area[static_cast<std::size_t>(axis)] += sign * face.sign * in_units(0.5 * twice[axis], kAreaUnits);
    }
  }
  SurfaceDipole dipole = dipole_about(bounding_box(faces, vertices));
  dipole.area = {static_cast<double>(area[0]) / kAreaUnits, static_cast<double>(area[1]) / kAreaUnits,
                 static_cast<double>(area[2]) / kAreaUnits};
  return dipole;
}

SurfaceField::Large::Large(TriangleMesh its_mesh)
    : mesh(std::move(its_mesh)), boundary(mesh), cone(boundary, SimdLevel::kBest) {}

std::vector<double> SurfaceField::Large::winding_numbers(std::span<const Vec3> points) const {
  std::vector<std::int64_t> crossings;
  for (const RaySum& sum : ray_sums(mesh.triangles, mesh.vertices, points)) crossings.push_back(sum.winding);
  std::vector<double> values(crossings.begin(), crossings.end());
  if (boundary.exterior_edges() == 0) return values;
  const std::size_t tiles = (points.size() + kTile - 1) / kTile;
  parallel_for(tiles, 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t begin = first * kTile; begin < std::min(last * kTile, points.size()); begin += kTile) {
      const std::size_t count = std::min(kTile, points.size() - begin);
      SampleTile tile;
      for (std::size_t i = begin; i < begin + count; ++i) tile.add(points[i]);
      cone.winding_numbers(tile, std::span(crossings).subspan(begin, count), std::span(values).subspan(begin, count));
    }
  });
  return values;
}

// The vector area of a surface is that of any other one with its boundary, such as the cone over that.
SurfaceDipole SurfaceField::Large::dipole() const {
  SurfaceDipole dipole = dipole_about(bounding_box(mesh.triangles, mesh.vertices));
  for (const DirectedEdge& edge : boundary.directed_edges()) {
    dipole.area = dipole.area + 0.5 * edge.multiplicity * cross(edge.from - dipole.centre, edge.to - dipole.centre);
  }
  return dipole;
}

SurfaceField::SurfaceField(const std::vector<Triangle>& faces, const std::vector<Vec3>& vertices, int sign) {
  if (faces.size() >= kLargeSurface) {
    large_ = std::make_unique<const Large>(mesh_of(faces, vertices, sign));
    dipole_ = large_->dipole();
    return;
  }
  dipole_ = dipole_of(faces, vertices, sign);
  for (const Triangle& t : faces) {
    if (has_met_corners(t, vertices)) continue;  // no area, and an orientation that depends on the order of its corners
    const CanonicalFace face = canonical_face(t, vertices);
    faces_.push_back(face.corners);
    if (sign * face.sign < 0) std::swap(faces_.back()[1], faces_.back()[2]);
  }
}

bool SurfaceField::is_far(const Vec3& q) const {
  const Vec3 r = q - dipole_.centre;
  return dot(r, r) > kFar * kFar * dipole_.radius * dipole_.radius;
}

double SurfaceField::of_triangles(const Vec3& q) const {
  std::int64_t sum = 0;
  for (const auto& corners : faces_) sum += in_units(turns_of(corners, q), kTurnUnits);
  return static_cast<double>(sum) / kTurnUnits;
}

std::vector<double> SurfaceField::winding_numbers(std::span<const FieldPoint> points) const {
  std::vector<double> values(points.size());
  std::vector<Vec3> near;
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (is_far(points[i].at)) {
      values[i] = dipole_.at(points[i].at);
    } else if (!large_) {
      values[i] = of_triangles(points[i].at);
    } else {
      near.push_back(points[i].at);
      places.push_back(i);
    }
  }
  if (near.empty()) return values;
  const std::vector<double> of_near = large_->winding_numbers(near);
  for (std::size_t i = 0; i < near.size(); ++i) values[places[i]] = of_near[i] + 0.5 * points[places[i]].side;
  return values;
}

}  // namespace raycone
