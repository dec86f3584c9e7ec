#include "core/exact/scale.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycone {

PowerOfTwo::PowerOfTwo(int exponent)
    : exponent_(exponent),
      half_(std::ldexp(1.0, exponent / 2)),
      other_half_(std::ldexp(1.0, exponent - exponent / 2)) {}

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

int exponent_of(double value) {
  int exponent = 0;
  std::frexp(value, &exponent);
  return exponent;
}

}  // namespace

int largest_exponent(const TriangleMesh& mesh) { return exponent_of(magnitudes_of(mesh).largest); }

PowerOfTwo unit_scale(const TriangleMesh& mesh) {
  const Magnitudes magnitudes = magnitudes_of(mesh);
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
