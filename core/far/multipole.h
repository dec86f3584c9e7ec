// The winding number of triangles as seen from afar: a multipole expansion about a centre.
//
// With y = v - centre of a triangle's points and r = q - centre, both in some unit, w is the sum over n >= 1 and |m| <=
// n of M_n^m I_n^m(r), where
//   M_n^m = -(1 / 4 pi) times the integral of normal . grad of the conjugate of R_n^m(y) over the triangles,
// and R and I are the regular and the irregular solid harmonics (of Condon and Shortley's sign, R_0^0 = 1, R_n^n =
// (-(x + iy) / 2)^n / n!). It holds where r is longer than all y. Epton and Dembart 1995 have the formulas.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/boundary/solid_angle_kernel.h"
#include "core/data/vec3.h"
#include "core/far/moment_kernel.h"

namespace raycone {

inline constexpr int kMultipoleOrder = 22;  // of an expansion at most
inline constexpr std::size_t kMultipoleTerms = std::size_t{(kMultipoleOrder + 1) * (kMultipoleOrder + 2) / 2};

// Where (n, m), 0 <= m <= n <= order, is among the terms of an expansion of that order: m by m.
[[nodiscard]] constexpr std::size_t multipole_index(int n, int m, int order = kMultipoleOrder) {
  const int place = m * (2 * order + 3 - m) / 2 + (n - m);
  return static_cast<std::size_t>(place);
}

// M_n^m for m >= 0 and n <= order, in the order of multipole_index(n, m); M_n^-m = (-1)^m times the conjugate. No
// lengths: with `unit` for the unit of length.
struct Multipole {
  int order = kMultipoleOrder;
  std::array<double, kMultipoleTerms> re{}, im{};
  // Of degree n: no potential at a distance of 1 is off by more, as integrals are by a rule of few points, and moments
  // are rounded (docs/method.md, "Far field").
  std::array<double, kMultipoleOrder + 1> error{};
};

// A ball, in the unit of an expansion about its centre.
struct MultipoleBall {
  Vec3 centre;
  double unit;    // a power of two
  double radius;  // in units, at most 1
};

// Of triangles in the ball; 1 <= order <= kMultipoleOrder. Where sides of triangles are short, integrals along them are
// off by about `precision` of what they may be, seen from two units away, which `error` includes; 0: by no more than
// what rounds. The result does not depend on the kernel.
[[nodiscard]] Multipole multipole_of(std::span<const SolidTriangle> triangles, const MultipoleBall& ball, int order,
                                     double precision, const MomentKernel& kernel = moment_kernel(SimdLevel::kBest));

// Adds an expansion of the same order that is about a centre that lies `shift` away, in units of the sum, and whose
// unit is `ratio` such units, a power of two. The result does not depend on the kernel.
void add_shifted(Multipole& sum, const Multipole& part, const Vec3& shift, double ratio,
                 const MomentKernel& kernel = moment_kernel(SimdLevel::kBest));

// What bounds the error of an expansion that is cut off behind degree p, at a distance of 1 / rho units: at most the
// sum of evaluation[n] rho^(n+1) over n <= p and of size[n] rho^(n+1) over p < n <= order, and of beyond_multipoles().
struct MultipoleBounds {
  int order = kMultipoleOrder;
  std::array<double, kMultipoleOrder + 1> size{}, evaluation{};
};
[[nodiscard]] MultipoleBounds bounds_of(const Multipole& multipole);

// Of all degrees above `order`, for triangles of `area` square units within `radius` units. Infinite where rho * radius
// is 1 or more.
[[nodiscard]] double beyond_multipoles(double area, double radius, int order, double rho);

// Where the coefficient of (n, m) is among those of an evaluation: degree by degree, so that what a low degree needs
// comes first.
[[nodiscard]] constexpr std::size_t coefficient_index(int n, int m) {
  const int place = n * (n + 1) / 2 + m;
  return static_cast<std::size_t>(place);
}

// The coefficients of the terms b_n^m in the evaluation, for n <= order, which is at most the multipole's, in the order
// of coefficient_index(n, m): re, im, re, im ...
//   w = Re of the sum over m of ((x + iy) / r^2)^m times the sum over n of coefficient b_n^m, divided by |r|,
//   b_m^m = 1, b_(n+1)^m = z / r^2 b_n^m - multipole_step(n, m) / r^2 b_(n-1)^m.
void set_coefficients(const Multipole& multipole, int order, std::span<double> coefficients);
[[nodiscard]] constexpr double multipole_step(int n, int m) {
  return static_cast<double>(n * n - m * m) / static_cast<double>((2 * n + 1) * (2 * n - 1));
}

}  // namespace raycone
