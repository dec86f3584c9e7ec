#include "core/exact/scale.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycone {

PowerOfTwo::PowerOfTwo(int exponent)
    : exponent_(exponent),
      half_(std::ldexp(1.0, exponent / 2)),
      other_half_(std::ldexp(1.0, exponent - exponent / 2)),
      least_(exponent >= 0 ? 0.0 : std::ldexp(std::numeric_limits<double>::min(), -exponent)) {}

namespace {

// Of the coordinates of triangles. Not by lists, whose loops branch.
struct Magnitudes {
  double largest = 0.0;
  double least = std::numeric_limits<double>::infinity();  // but for zeros

  void add(double c) {
    const double magnitude = std::abs(c);
    largest = std::max(largest, magnitude);
    least = std::min(least, magnitude > 0.0 ? magnitude : least);
  }
};

Magnitudes magnitudes_of(const TriangleMesh& mesh) {
  Magnitudes magnitudes;
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) {
      for (int axis = 0; axis < 3; ++axis) magnitudes.add(mesh.vertices[v][axis]);
    }
  }
  return magnitudes;
}

// Whether triangles use them or not.
Magnitudes magnitudes_of_vertices(const TriangleMesh& mesh) {
  Magnitudes magnitudes;
  for (const Vec3& p : mesh.vertices) {
    magnitudes.add(p.x);
    magnitudes.add(p.y);
    magnitudes.add(p.z);
  }
  return magnitudes;
}

bool any_corner_reaches(const TriangleMesh& mesh, double magnitude) {
  return std::ranges::any_of(mesh.triangles, [&](const Triangle& triangle) {
    return std::ranges::any_of(triangle, [&](std::uint32_t v) {
      const Vec3& p = mesh.vertices[v];
      return largest_coordinate(p) >= magnitude;
    });
  });
}

int exponent_of(double value) {
  int exponent = 0;
  std::frexp(value, &exponent);
  return exponent;
}

// With the exponents of magnitudes_of(), or a lower one of the least. All vertices are looked at faster than those of
// all triangles, and nearly always a triangle is found soon that reaches as far.
Magnitudes magnitudes_quickly(const TriangleMesh& mesh) {
  const Magnitudes all = magnitudes_of_vertices(mesh);
  const bool known = std::isfinite(all.largest) && all.largest > 0.0 &&
                     any_corner_reaches(mesh, std::ldexp(1.0, exponent_of(all.largest) - 1));
  return known ? all : magnitudes_of(mesh);
}

}  // namespace

int largest_exponent(const TriangleMesh& mesh) { return exponent_of(magnitudes_quickly(mesh).largest); }

PowerOfTwo unit_scale(const TriangleMesh& mesh) {
  const Magnitudes magnitudes = magnitudes_quickly(mesh);
  const int exponent = exponent_of(magnitudes.largest);
  const PowerOfTwo scale(-exponent);
  constexpr int kNormal = -960;  // what is not below 2^-960 afterwards has kept all of its bits
  if (exponent <= 0 || exponent_of(magnitudes.least) - exponent > kNormal) return scale;  // scaling up loses nothing
  const PowerOfTwo inverse(exponent);
  const auto exact = [&](double c) { return inverse(scale(c)) == c; };
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) {
      const Vec3& p = mesh.vertices[v];
      if (!exact(p.x) || !exact(p.y) || !exact(p.z)) return PowerOfTwo(0);
    }
  }
  return scale;
}

}  // namespace raycone
