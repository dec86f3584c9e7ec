#include "core/exact/exact_points.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "core/exact/exact_integers.h"
#include "core/exact/scale.h"
#include "core/exact/sure_sign.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

using exact::IntegerVec3;

// The point `numerators` / `denominator`, in units of 2^-exponent of the table. Denominators are positive.
struct Fractions {
  IntegerVec3 numerators;
  mpz_class denominator;
};

const mpz_class& component(const IntegerVec3& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

Fractions with_positive_denominator(Fractions f) {
  if (sgn(f.denominator) < 0) f = {-1 * f.numerators, -f.denominator};
  return f;
}

bool are_equal(const Fractions& p, const Fractions& q) {
  const auto equal = [&](const mpz_class& a, const mpz_class& b) { return a * q.denominator == b * p.denominator; };
  return equal(p.numerators.x, q.numerators.x) && equal(p.numerators.y, q.numerators.y) &&
         equal(p.numerators.z, q.numerators.z);
}

// The nearest double to numerator / denominator * 2^-exponent.
double nearest_double(const mpz_class& numerator, const mpz_class& denominator, int exponent) {
  if (sgn(numerator) == 0) return 0.0;
  constexpr int kBits = exact::kDigits + 2;  // one to round by, one that says whether anything follows
  const auto bits = [](const mpz_class& n) { return static_cast<int>(mpz_sizeinbase(n.get_mpz_t(), 2)); };
  const int shift = kBits - bits(numerator) + bits(denominator);
  const mpz_class above = shift > 0 ? mpz_class(abs(numerator) << static_cast<mp_bitcnt_t>(shift)) : abs(numerator);
  const mpz_class below = shift < 0 ? mpz_class(denominator << static_cast<mp_bitcnt_t>(-shift)) : denominator;
  mpz_class quotient, rest;
  mpz_tdiv_qr(quotient.get_mpz_t(), rest.get_mpz_t(), above.get_mpz_t(), below.get_mpz_t());
  if (sgn(rest) != 0) mpz_setbit(quotient.get_mpz_t(), 0);
  const double magnitude = std::ldexp(static_cast<double>(mpz_get_ui(quotient.get_mpz_t())), -shift - exponent);
  return sgn(numerator) < 0 ? -magnitude : magnitude;
}

// The sign of the turn in doubles, where that is sure, else 0. The coordinates are rounded: each is off by 2^-53 times
// `most` at most, which is no less than any of them. So are differences by four times that, and the products and their
// difference by no more than what is trusted, with a factor of four to spare.
int sure_turn(double most, double ab_x, double ab_y, double ac_x, double ac_y) {
  const double value = ab_x * ac_y - ab_y * ac_x;
  const double sides = std::abs(ab_x) + std::abs(ab_y) + std::abs(ac_x) + std::abs(ac_y);
  const double trust = 0x1p-48 * most * (sides + 0x1p-48 * most) + 0x1p-1000;
  if (!std::isfinite(value)) return 0;
  return sure_sign(value, trust);
}

int sure_turn(int axis, const Vec3& a, const Vec3& b, const Vec3& c) {
  const int right = (axis + 1) % 3, up = (axis + 2) % 3;
  const double most = std::max(
      {std::abs(a[right]), std::abs(a[up]), std::abs(b[right]), std::abs(b[up]), std::abs(c[right]), std::abs(c[up])});
  return sure_turn(most, b[right] - a[right], b[up] - a[up], c[right] - a[right], c[up] - a[up]);
}

double sum_of(const Vec3& magnitudes) { return magnitudes.x + magnitudes.y + magnitudes.z; }

// sure_turn() for the side of a point that is rounded. Each of six products is off by what one factor is, as above,
// times the two others; they are not more than all of these, so trust has a factor of four to spare.
int sure_side(const Corners3& triangle, const Vec3& p) {
  double most = largest_coordinate(p);
  for (const Vec3& corner : triangle) most = std::max(most, largest_coordinate(corner));
  const Vec3 first = triangle[1] - triangle[0], second = triangle[2] - triangle[0], to = p - triangle[0];
  const double value = dot(cross(first, second), to);
  const double a = sum_of(absolute(first)), b = sum_of(absolute(second)), c = sum_of(absolute(to));
  const double off = 0x1p-46 * most;
  const double trust = off * (a * b + b * c + c * a + off * (a + b + c + off)) + 0x1p-1000;
  if (!std::isfinite(value)) return 0;  // of three products one may have overflowed, and not the largest
  return sure_sign(value, trust);
}

// The determinant of the points' coordinates along two axes and their denominators: the turn, times all of the latter.
mpz_class determinant(int axis, const Fractions& a, const Fractions& b, const Fractions& c) {
  const int right = (axis + 1) % 3, up = (axis + 2) % 3;
  const auto minor = [&](const Fractions& p, const Fractions& q) {
    return mpz_class(component(p.numerators, right) * component(q.numerators, up) -
                     component(p.numerators, up) * component(q.numerators, right));
  };
  return minor(a, b) * c.denominator + minor(b, c) * a.denominator + minor(c, a) * b.denominator;
}

}  // namespace

struct ExactPoints::Table {
  int exponent = 0;
  double above = 1.0;  // a power of two above all coordinates
  std::vector<Fractions> points;
  std::vector<Vec3> rounded;
  std::multimap<std::tuple<double, double, double>, Number> by_rounded;

  [[nodiscard]] IntegerVec3 integers(const Vec3& p) const {
    return {exact::integer(p.x, exponent), exact::integer(p.y, exponent), exact::integer(p.z, exponent)};
  }
  [[nodiscard]] Fractions fractions(const Vec3& p) const { return {integers(p), 1}; }

  // A point and the nearest doubles.
  struct Placed {
    Fractions exact;
    Vec3 nearest;
  };
  [[nodiscard]] Placed placed(Fractions point) const {
    point = with_positive_denominator(std::move(point));
    const auto nearest = [&](const mpz_class& numerator) {
      return nearest_double(numerator, point.denominator, exponent);
    };
    const IntegerVec3& n = point.numerators;
    const Vec3 at{nearest(n.x), nearest(n.y), nearest(n.z)};
    return {std::move(point), at};
  }

  Number add(Placed point) {
    const Vec3& at = point.nearest;
    const auto key = std::make_tuple(at.x, at.y, at.z);
    for (auto [same, end] = by_rounded.equal_range(key); same != end; ++same) {
      if (are_equal(points[same->second], point.exact)) return same->second;
    }
    const auto number = static_cast<Number>(points.size());
    by_rounded.emplace(key, number);
    points.push_back(std::move(point.exact));
    rounded.push_back(at);
    return number;
  }
  // make(n) for all n below `count`, by many threads, so many at once that it does not take much memory. Each point is
  // a block of its own: where memory is short that fails, and not the integers in it (integer_memory.h).
  template <class Make>
  std::vector<Number> add_each(std::size_t count, const Make& make) {
    constexpr std::size_t kAtOnce = 256, kGrain = 16;
    std::vector<Number> numbers;
    numbers.reserve(count);
    for (std::size_t begin = 0; begin < count; begin += kAtOnce) {
      std::vector<std::unique_ptr<Placed>> made(std::min(kAtOnce, count - begin));
      parallel_for_each(made.size(), kGrain, [&](std::size_t n) {
        made[n] = std::make_unique<Placed>();
        *made[n] = placed(make(begin + n));
      });
      for (const std::unique_ptr<Placed>& point : made) numbers.push_back(add(std::move(*point)));
    }
    return numbers;
  }
};

ExactPoints::ExactPoints(const TriangleMesh& mesh) : table_(std::make_unique<Table>()) {
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) {
      for (int axis = 0; axis < 3; ++axis) {
        table_->exponent = std::max(table_->exponent, exact::exponent_to_integer(mesh.vertices[v][axis]));
      }
    }
  }
  table_->above = std::ldexp(1.0, largest_exponent(mesh));
  table_->exponent = std::max(table_->exponent, exact::exponent_to_integer(table_->above));
}

ExactPoints::ExactPoints(ExactPoints&&) noexcept = default;
ExactPoints& ExactPoints::operator=(ExactPoints&&) noexcept = default;
ExactPoints::~ExactPoints() = default;

ExactPoints::Number ExactPoints::size() const { return static_cast<Number>(table_->points.size()); }

const Vec3& ExactPoints::rounded(Number point) const { return table_->rounded[point]; }

ExactPoints::Number ExactPoints::add(const Vec3& vertex) {
  const Vec3 without_signs = vertex + Vec3{0.0, 0.0, 0.0};  // of zeros
  return table_->add({table_->fractions(without_signs), without_signs});
}

std::vector<ExactPoints::Number> ExactPoints::add(std::span<const OnPlane> points) {
  return table_->add_each(points.size(), [&](std::size_t n) -> Fractions {
    const auto& [a, b, plane] = points[n];
    const IntegerVec3 from = table_->integers(a), to = table_->integers(b), corner = table_->integers(plane[0]);
    const IntegerVec3 normal = cross(table_->integers(plane[1]) - corner, table_->integers(plane[2]) - corner);
    const mpz_class before = dot(normal, from - corner), behind = dot(normal, to - corner);
    return {before * to - behind * from, before - behind};
  });
}

std::vector<ExactPoints::Number> ExactPoints::add(std::span<const Crossing> points) {
  return table_->add_each(points.size(), [&](std::size_t n) -> Fractions {
    const auto& [axis, a, b, left, right] = points[n];
    const std::vector<Fractions>& known = table_->points;
    const Fractions &from = known[a], &to = known[b];
    const mpz_class before = determinant(axis, known[left], known[right], from);
    const mpz_class behind = determinant(axis, known[left], known[right], to);
    return {before * to.numerators - behind * from.numerators, to.denominator * before - from.denominator * behind};
  });
}

ExactPoints::Number ExactPoints::add_between(const std::array<Number, 3>& points,
                                             const std::array<std::uint32_t, 3>& weights) {
  Fractions mean{{0, 0, 0}, 0};
  for (std::size_t i = 0; i < 3; ++i) {
    const Fractions& point = table_->points[points[i]];
    const mpz_class factor =
        weights[i] * table_->points[points[(i + 1) % 3]].denominator * table_->points[points[(i + 2) % 3]].denominator;
    mean = {mean.numerators + factor * point.numerators, mean.denominator + point.denominator * factor};
  }
  return table_->add(table_->placed(std::move(mean)));
}

std::array<ExactPoints::Number, 3> ExactPoints::add_triangle_around(int axis) {
  const auto point = [&](double right, double up) {
    Vec3 p{0.0, 0.0, 0.0};
    p[(axis + 1) % 3] = right * table_->above;
    p[(axis + 2) % 3] = up * table_->above;
    return table_->add({table_->fractions(p), p});
  };
  return {point(-4.0, -2.0), point(4.0, -2.0), point(0.0, 6.0)};
}

int ExactPoints::turn(int axis, Number a, Number b, Number c) const {
  if (const int sign = sure_turn(axis, rounded(a), rounded(b), rounded(c)); sign != 0) return sign;
  return sgn(determinant(axis, table_->points[a], table_->points[b], table_->points[c]));
}

int ExactPoints::turn(int axis, const Vec3& a, const Vec3& b, Number c) const {
  if (const int sign = sure_turn(axis, a, b, rounded(c)); sign != 0) return sign;
  return sgn(determinant(axis, table_->fractions(a), table_->fractions(b), table_->points[c]));
}

int ExactPoints::axis_to_see(const std::array<Number, 3>& triangle) const {
  const Number a = triangle[0], b = triangle[1], c = triangle[2];
  const Vec3 area = absolute(cross(rounded(b) - rounded(a), rounded(c) - rounded(a)));
  std::array<int, 3> axes{0, 1, 2};
  std::ranges::stable_sort(axes, [&](int i, int j) { return area[i] > area[j]; });
  return *std::ranges::find_if(axes, [&](int axis) { return turn(axis, a, b, c) != 0; });
}

int ExactPoints::side(const Corners3& triangle, Number point) const {
  if (const int sign = sure_side(triangle, rounded(point)); sign != 0) return sign;
  const IntegerVec3 corner = table_->integers(triangle[0]);
  const IntegerVec3 normal = cross(table_->integers(triangle[1]) - corner, table_->integers(triangle[2]) - corner);
  const Fractions& p = table_->points[point];
  return sgn(dot(normal, p.numerators - p.denominator * corner));
}

}  // namespace raycone
