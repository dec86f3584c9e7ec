// Points or vectors of other numbers than doubles: wider ones, or integers.
#pragma once

#include <type_traits>

namespace raycone {

template <class Number>
struct Vec3Of {
  Number x{}, y{}, z{};
};

template <class Number>
Vec3Of<Number> operator+(const Vec3Of<Number>& a, const Vec3Of<Number>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class Number>
Vec3Of<Number> operator-(const Vec3Of<Number>& a, const Vec3Of<Number>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class Number>
Vec3Of<Number> operator*(const std::type_identity_t<Number>& s, const Vec3Of<Number>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class Number>
Number dot(const Vec3Of<Number>& a, const Vec3Of<Number>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class Number>
Vec3Of<Number> cross(const Vec3Of<Number>& a, const Vec3Of<Number>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

}  // namespace raycone
