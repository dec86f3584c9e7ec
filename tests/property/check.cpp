#include "tests/property/check.h"

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/evaluation/winding_number.h"
#include "core/machine/floating_point.h"
#include "tests/support/diagnosed.h"
#include "tests/support/direct_winding_number.h"
#include "tests/support/exact_predicates.h"

namespace raycone::test {
namespace {

using Quad = __float128;

std::vector<Answer> evaluate(const TriangleMesh& mesh, RayEngine engine, Summation summation,
                             const std::vector<Vec3>& queries, bool& closed) {
  const WindingNumberEvaluator evaluator(mesh, {.ray_engine = engine, .summation = summation});
  evaluator.prepare_points();
  const Diagnosed found = diagnosed(evaluator, queries);
  closed = evaluator.exterior_edges() == 0;
  std::vector<Answer> answers;
  for (std::size_t i = 0; i < queries.size(); ++i)
    answers.push_back({found.values[i], found.degenerate[i], found.on_surface[i] != 0, found.bounds[i]});
  return answers;
}

template <class Predicate>
bool any_triangle(const TriangleMesh& mesh, const Predicate& predicate) {
  return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
    return predicate(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
  });
}

bool is_on_surface(const TriangleMesh& mesh, const Vec3& q) {
  return any_triangle(mesh,
                      [&](const Vec3& a, const Vec3& b, const Vec3& c) { return exactly_on_triangle(a, b, c, q); });
}

// Ties by definition: per triangle whose closed box meets the closed ray, its edges with D = 0.
std::int64_t ties(const TriangleMesh& mesh, const Vec3& q) {
  std::int64_t count = 0;
  any_triangle(mesh, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto [low_y, high_y] = std::minmax({a.y, b.y, c.y});
    const auto [low_z, high_z] = std::minmax({a.z, b.z, c.z});
    if (low_y <= q.y && q.y <= high_y && low_z <= q.z && q.z <= high_z && q.x <= std::max({a.x, b.x, c.x})) {
      count += (exact_edge_side(a, b, q) == 0) + (exact_edge_side(b, c, q) == 0) + (exact_edge_side(c, a, q) == 0);
    }
    return false;
  });
  return count;
}

std::string text(const char* format, double a, double b, double c) {
  char line[256];
  std::snprintf(line, sizeof line, format, a, b, c);
  return line;
}

template <unsigned bits>
using Binary =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<bits, boost::multiprecision::digit_base_2>,
                                  boost::multiprecision::et_off>;

template <class Real>
struct Vector {
  Real x, y, z;
};

// The query moved by (e, e^2, e^3), e = 1e-55, in units of the mesh's extent along each axis: what the perturbation
// stands for, smaller than anything that doubles can tell apart (but for those next to 0).
template <class Real>
Vector<Real> moved(const Vec3& q, const Vec3& extent, bool perturbed) {
  const double largest = std::max({extent.x, extent.y, extent.z});
  const auto size = [&](double side) { return side > 0 ? side : largest; };
  const Real e = perturbed ? Real("1e-55") : Real(0);
  return {q.x + size(extent.x) * e, q.y + size(extent.y) * e * e, q.z + size(extent.z) * e * e * e};
}

// Half the solid angle; nothing where the precision does not do: |z| at distance d from an edge is of the order of d^2.
template <unsigned bits>
std::optional<long double> half_solid_angle_of(const Vec3& va, const Vec3& vb, const Vec3& vc,
                                               const Vector<Binary<bits>>& q) {
  using Real = Binary<bits>;
  const auto minus = [&](const Vec3& v) { return Vector<Real>{v.x - q.x, v.y - q.y, v.z - q.z}; };
  const auto dot = [](const Vector<Real>& a, const Vector<Real>& b) { return a.x * b.x + a.y * b.y + a.z * b.z; };
  const Vector<Real> a = minus(va), b = minus(vb), c = minus(vc);
  const Real la = sqrt(dot(a, a)), lb = sqrt(dot(b, b)), lc = sqrt(dot(c, c));
  const Real re = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  const Real im = a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
  const Real largest = std::max(Real(abs(re)), Real(abs(im)));
  const Real smallest = ldexp(Real(la * lb * lc), 100 - static_cast<int>(bits));
  // Next to an edge, or next to the triangle, where the sign of im is that of a half turn.
  if (largest <= smallest || (re < 0 && abs(im) <= smallest)) return std::nullopt;
  return std::atan2(static_cast<long double>(im / largest), static_cast<long double>(re / largest));
}

long double value_by_definition(const TriangleMesh& mesh, const Vec3& q, bool on_surface) {
  const Box box = bounding_box(mesh);
  const Vec3 extent = box.upper - box.lower;
  const auto few = moved<Binary<700>>(q, extent, on_surface);
  const auto many = moved<Binary<3000>>(q, extent, on_surface);
  long double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    if (exactly_collinear(a, b, c)) continue;
    const auto half_angle = half_solid_angle_of<700>(a, b, c, few);
    sum += half_angle ? *half_angle : half_solid_angle_of<3000>(a, b, c, many).value();
  }
  return sum / (2 * std::numbers::pi_v<long double>);
}

// Whether a vertex is closer to the query along some axis than a step can tell: next to 0 doubles get as close as
// 5e-324.
bool too_close_for_a_step(const TriangleMesh& mesh, const Vec3& q) {
  const Box box = bounding_box(mesh);
  return std::any_of(mesh.vertices.begin(), mesh.vertices.end(), [&](const Vec3& v) {
    for (int axis = 0; axis < 3; ++axis) {
      const double distance = std::abs(v[axis] - q[axis]), extent = box.upper[axis] - box.lower[axis];
      if (distance > 0 && distance < 1e-30 * extent) return true;
    }
    return false;
  });
}

std::optional<std::string> wrong_value(const TriangleMesh& mesh, const Vec3& q, const Answer& answer,
                                       CheckCounts& counts) {
  if (answer.on_surface && too_close_for_a_step(mesh, q)) {
    ++counts.undecided;
    return std::nullopt;
  }
  constexpr double kSure = 1e-20;
  // 113 bits where they do, which is mostly.
  const WithinQuad quad = winding_number_within(mesh, q);
  const bool sure = !answer.on_surface && quad.error < kSure;
  const Quad exact = sure ? quad.value : Quad(value_by_definition(mesh, q, answer.on_surface));
  const Quad difference = exact > answer.value ? exact - answer.value : answer.value - exact;
  // The sum over triangles itself has 64 bits.
  const Quad error = sure ? Quad(kSure) : Quad(1e-19) * static_cast<double>(mesh.triangles.size() + 1);
  if (difference <= Quad(answer.error_bound) + error) return std::nullopt;  // not so for NaN
  return text("value %.17g, by definition %.17g, error bound %g", answer.value, static_cast<double>(exact),
              answer.error_bound);
}

// The promise near exterior edges; elsewhere errors are far smaller.
constexpr double kPromised = 1e-12;

// The sum over triangles beside that over the cone, which is known to be right within its bound.
std::optional<std::string> wrong_sum(const Answer& cone, const Answer& triangles) {
  if (std::abs(cone.value - triangles.value) <= cone.error_bound + triangles.error_bound &&
      triangles.error_bound < kPromised) {
    return std::nullopt;
  }
  return text("value %.17g, over triangles %.17g with error bound %g", cone.value, triangles.value,
              triangles.error_bound);
}

std::optional<std::string> wrong_answer(const TriangleMesh& mesh, const Vec3& q, bool closed, const Answer& answer,
                                        CheckCounts& counts) {
  const double value = answer.value, bound = answer.error_bound;
  if (answer.on_surface != is_on_surface(mesh, q)) {
    return text("on_surface is %g, by definition %g (value %g)", answer.on_surface, !answer.on_surface, value);
  }
  const std::int64_t expected_ties = ties(mesh, q);
  if (answer.degenerate != expected_ties) {
    return text("degenerate is %g, by definition %g (value %g)", static_cast<double>(answer.degenerate),
                static_cast<double>(expected_ties), value);
  }
  if (closed && (value != std::nearbyint(value) || bound != 0.0)) {
    return text("value %.17g of a closed mesh with error bound %g is not an exact integer%.0s", value, bound, 0);
  }
  // A wrong value with an honest bound is still wrong.
  if (!(bound < kPromised)) return text("value %.17g has error bound %g%.0s", value, bound, 0);
  ++counts.values;
  counts.on_surface += answer.on_surface;
  counts.degenerate += answer.degenerate > 0;
  return wrong_value(mesh, q, answer, counts);
}

}  // namespace

std::vector<Answers> answers_of(const TriangleMesh& welded, const std::vector<Vec3>& queries) {
  const DefaultFloatingPoint guard;
  bool closed = false;
  const std::vector<Answer> grid = evaluate(welded, RayEngine::kScan, Summation::kCone, queries, closed);
  const std::vector<Answer> passes = evaluate(welded, RayEngine::kPasses, Summation::kCone, queries, closed);
  const std::vector<Answer> embree = evaluate(welded, RayEngine::kEmbree, Summation::kCone, queries, closed);
  const std::vector<Answer> triangles = evaluate(welded, RayEngine::kScan, Summation::kTriangles, queries, closed);
  std::vector<Answers> answers;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    answers.push_back({queries[i], grid[i], passes[i], embree[i], triangles[i], closed});
  }
  return answers;
}

std::optional<std::string> wrong(const TriangleMesh& mesh, const Answers& answers, CheckCounts& counts) {
  const DefaultFloatingPoint guard;
  const Answer& grid = answers.grid;
  if (!(grid == answers.passes && grid == answers.embree)) {
    return text("the grid gives %.17g, passes %.17g, Embree %.17g", grid.value, answers.passes.value,
                answers.embree.value);
  }
  if (auto what = wrong_answer(mesh, answers.query, answers.closed, grid, counts)) return what;
  return wrong_sum(grid, answers.over_triangles);
}

std::optional<Failure> check(const TriangleMesh& welded, const std::vector<Vec3>& queries, CheckCounts* counts) {
  CheckCounts unused;
  for (const Answers& answers : answers_of(welded, queries)) {
    if (const auto what = wrong(welded, answers, counts ? *counts : unused)) return Failure{answers.query, *what};
  }
  return std::nullopt;
}

TriangleMesh shrink(TriangleMesh mesh, const Vec3& query) {
  for (std::size_t i = 0; i < mesh.triangles.size() && mesh.triangles.size() > 1;) {
    TriangleMesh smaller = mesh;
    smaller.triangles.erase(smaller.triangles.begin() + static_cast<std::ptrdiff_t>(i));
    if (check(smaller, {query})) {
      mesh = std::move(smaller);
      i = 0;
    } else {
      ++i;
    }
  }
  return mesh;
}

std::string describe(const TriangleMesh& mesh, const Failure& failure) {
  std::string obj = "# " + failure.what + "\n" +
                    text("# query %.17g %.17g %.17g\n", failure.query.x, failure.query.y, failure.query.z);
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) {
      obj += text("v %.17g %.17g %.17g\n", mesh.vertices[v].x, mesh.vertices[v].y, mesh.vertices[v].z);
    }
    obj += "f -3 -2 -1\n";
  }
  return obj;
}

}  // namespace raycone::test
