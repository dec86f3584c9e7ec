// A point or vector of three doubles.
#pragma once

#include <algorithm>
#include <cmath>
#include <compare>

namespace raycone {

struct Vec3 {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;

  double operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  double& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline double norm(const Vec3& a) { return std::sqrt(dot(a, a)); }
// The same where squares may over- or underflow, as those of areas do; slower.
inline double safe_norm(const Vec3& a) { return std::hypot(a.x, a.y, a.z); }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

inline Vec3 absolute(const Vec3& a) { return {std::abs(a.x), std::abs(a.y), std::abs(a.z)}; }
// The components of cross(a, b) with the magnitudes of their products added: what rounding is to be judged by.
inline Vec3 cross_terms(const Vec3& a, const Vec3& b) {
  return {std::abs(a.y * b.z) + std::abs(a.z * b.y), std::abs(a.z * b.x) + std::abs(a.x * b.z),
          std::abs(a.x * b.y) + std::abs(a.y * b.x)};
}

inline bool is_finite(const Vec3& a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

// The largest magnitude of a coordinate.
inline double largest_coordinate(const Vec3& a) { return std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z)}); }

// By x, then y, then z: a total order, also of non-finite vertices that no triangle uses.
inline std::strong_ordering lexicographic_order(const Vec3& a, const Vec3& b) {
  if (const auto order = std::strong_order(a.x, b.x); order != 0) return order;
  if (const auto order = std::strong_order(a.y, b.y); order != 0) return order;
  return std::strong_order(a.z, b.z);
}

}  // namespace raycone
