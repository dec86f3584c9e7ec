// Winding numbers of one open surface at samples, for the choice of its orientation: near exact, from afar a dipole.
#pragma once

#include <cmath>
#include <memory>
#include <numbers>
#include <span>
#include <vector>

#include "core/boundary/boundary.h"
#include "core/boundary/cone.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// What a surface looks like from afar (Barill, Dickson, Schmidt, Levin, Jacobson 2018, first order).
struct SurfaceDipole {
  Vec3 centre;
  Vec3 area;            // vector area
  double radius = 0.0;  // of a sphere about the centre that holds the surface

  // Winding number, turns; good from afar, 0 in the centre.
  [[nodiscard]] double at(const Vec3& q) const {
    const Vec3 r = centre - q;
    const double square = dot(r, r);
    constexpr double kCentre = 0x1p-600;  // square of a distance: any nearer, q counts as the centre
    if (!(square > kCentre)) return 0.0;
    return dot(area, r) / (4.0 * std::numbers::pi * square * std::sqrt(square));
  }
};

// The dipole about the middle of the surface's box; with `sign` -1, of the faces reversed. Coordinates in [0, 1]. Does
// not depend on the order of faces, whose areas are added up as integers.
[[nodiscard]] SurfaceDipole dipole_of(const std::vector<Triangle>& faces, const std::vector<Vec3>& vertices, int sign);

// A point, and where it lies on the surface itself: 0 not there, else as SurfaceSample::side.
struct FieldPoint {
  Vec3 at;
  int side = 0;
};

// Exact up to rounding nearby; does not depend on the order of faces.
class SurfaceField {
 public:
  // As for dipole_of().
  SurfaceField(const std::vector<Triangle>& faces, const std::vector<Vec3>& vertices, int sign = 1);

  // Beyond this many radii from its centre a surface is a dipole: it is then off by some percent of itself.
  static constexpr double kFar = 3.0;
  [[nodiscard]] bool is_far(const Vec3& q) const;

  // The winding number at each point, turns; where it is far, that of the dipole. On the surface itself it is the mean
  // of both sides. Uses the threads that ThreadLimit allows; needs DefaultFloatingPoint.
  [[nodiscard]] std::vector<double> winding_numbers(std::span<const FieldPoint> points) const;

 private:
  // A large surface: crossings, and the cone over its boundary.
  struct Large {
    explicit Large(TriangleMesh its_mesh);
    Large(const Large&) = delete;  // cone refers to boundary
    Large& operator=(const Large&) = delete;
    [[nodiscard]] std::vector<double> winding_numbers(std::span<const Vec3> points) const;
    [[nodiscard]] SurfaceDipole dipole() const;

    TriangleMesh mesh;
    Boundary boundary;
    Cone cone;
  };

  [[nodiscard]] double of_triangles(const Vec3& q) const;

  std::vector<Corners3> faces_;  // of a small surface, which is summed face by face
  std::unique_ptr<const Large> large_;
  SurfaceDipole dipole_;
};

}  // namespace raycone
