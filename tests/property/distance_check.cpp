#include "tests/property/distance_check.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "core/distance/distance.h"
#include "core/distance/distance_band.h"
#include "core/distance/distance_tree.h"
#include "core/exact/direct_distance.h"
#include "core/exact/scale.h"
#include "core/machine/floating_point.h"
#include "tests/support/lattice_samples.h"

namespace raycone::test {
namespace {

std::string text(double x) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.17g", x);
  return digits;
}

bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

// The mesh and the lattice as they are searched; no rows where a sample is too far away for that.
struct Scaled {
  TriangleMesh mesh;
  LatticeRows rows;

  Scaled(const TriangleMesh& original, const Lattice& lattice) : mesh(original) {
    const PowerOfTwo to_unit(-largest_exponent(original));
    for (Vec3& p : mesh.vertices) p = to_unit(p);
    const std::array<std::vector<double>*, 3> axes{&rows.xs, &rows.ys, &rows.zs};
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      for (std::int64_t i = lattice.index_min[a]; i <= lattice.index_max(axis); ++i) {
        axes[a]->push_back(to_unit(lattice.coordinate(axis, i)));
      }
    }
  }

  [[nodiscard]] bool fits() const {
    const auto near = [](const std::vector<double>& xs) { return xs.front() >= -0x1p55 && xs.back() <= 0x1p55; };
    const double largest = largest_coordinate(bounding_box(mesh));
    return largest >= 0.5 && largest <= 1 && near(rows.xs) && near(rows.ys) && near(rows.zs);
  }
};

// Where `found` is not what the tree finds, though that is within the band.
std::optional<Failure> compare_with_tree(const Scaled& scaled, const DistanceTree& tree, double band,
                                         const std::vector<double>& found) {
  std::size_t n = 0;
  for (const double z : scaled.rows.zs) {
    for (const double y : scaled.rows.ys) {
      for (const double x : scaled.rows.xs) {
        const double expected = tree.squared_distance({x, y, z}), actual = found[n++];
        if (same_bits(expected, actual) || (std::sqrt(expected) >= band && std::sqrt(actual) >= band)) continue;
        return Failure{{x, y, z},
                       "blocks find the square " + text(actual) + ", the tree " + text(expected) +
                           ", of a mesh scaled to 1, band " + text(band)};
      }
    }
  }
  return std::nullopt;
}

std::optional<Failure> check_band(const TriangleMesh& mesh, const Lattice& lattice, double band) {
  const Scaled scaled(mesh, lattice);
  if (!scaled.fits()) return std::nullopt;
  const double unit_band = std::min(PowerOfTwo(-largest_exponent(mesh))(band), 0x1p57);
  std::vector<double> squares(scaled.rows.xs.size() * scaled.rows.size());
  for (const SimdLevel level : {SimdLevel::kSse4, SimdLevel::kAvx2, SimdLevel::kAvx512}) {
    const DistanceTree tree(scaled.mesh, level);
    fill_band(tree, scaled.rows, unit_band, squares);
    if (auto failure = compare_with_tree(scaled, tree, unit_band, squares)) return failure;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Failure> check_distances(const TriangleMesh& mesh, const std::vector<Vec3>& points,
                                       DistanceCounts& counts) {
  const DefaultFloatingPoint guard;
  std::vector<double> distances(points.size());
  DistanceEvaluator(mesh).evaluate(points, distances);
  for (std::size_t n = 0; n < points.size(); ++n) {
    const Quad exact = direct_distance(mesh, points[n]);
    const Quad difference = distances[n] > exact ? distances[n] - exact : exact - distances[n];
    const Quad largest = std::max(largest_coordinate(bounding_box(mesh)), largest_coordinate(points[n]));
    // What is not a normal number is rounded to a multiple of the least one.
    const Quad allowed = std::max(Quad(1e-12) * exact, 4 * Quad(0x1p-53) * largest);
    ++counts.points;
    counts.on_surface += exact == 0;
    if (difference <= allowed + std::numeric_limits<double>::denorm_min()) continue;
    return Failure{points[n], "distance " + text(distances[n]) + ", by definition " + text(static_cast<double>(exact))};
  }
  return std::nullopt;
}

std::optional<Failure> check_lattice_distances(const TriangleMesh& mesh, const Lattice& lattice,
                                               DistanceCounts& counts) {
  const DefaultFloatingPoint guard;
  const DistanceEvaluator evaluator(mesh);
  const std::vector<Vec3> points = samples_of(lattice);
  std::vector<double> expected(points.size()), distances(points.size());
  evaluator.evaluate(points, expected);
  for (const double voxels : {0.01, 1.0, 3.0, 1e9}) {
    const double band = voxels * lattice.spacing.x;
    evaluator.evaluate(lattice, whole(lattice), band, distances);
    for (std::size_t n = 0; n < points.size(); ++n) {
      ++counts.samples;
      counts.in_band += expected[n] < band;
      if (same_bits(distances[n], std::min(expected[n], band))) continue;
      return Failure{points[n], "distance as a sample " + text(distances[n]) + ", as a point " + text(expected[n]) +
                                    ", band " + text(band)};
    }
    if (auto failure = check_band(mesh, lattice, band)) return failure;
  }
  return std::nullopt;
}

Lattice any_lattice(const TriangleMesh& mesh, Random& random) {
  const auto vertex = [&] { return mesh.vertices[mesh.triangles[random() % mesh.triangles.size()][random() % 3]]; };
  const Box box = bounding_box(mesh);
  const Vec3 sides = box.upper - box.lower;
  const double side = std::max({sides.x, sides.y, sides.z, 1e-290});
  Lattice lattice;
  lattice.origin = vertex();
  double spacing = side * std::pow(10.0, uniform(random, -2, 0));
  if (random() % 2 == 0) {  // some step leads from vertex to vertex
    const auto axis = static_cast<int>(random() % 3);
    const double step = std::abs(vertex()[axis] - lattice.origin[axis]) / static_cast<double>(1 + random() % 8);
    if (step > 1e-3 * side) spacing = step;
  }
  if (random() % 8 == 0) spacing *= std::pow(10.0, uniform(random, 0, 20));
  if (random() % 8 == 0) spacing *= std::pow(10.0, uniform(random, -12, 0));
  lattice.spacing = {spacing, spacing, spacing};
  for (std::size_t a = 0; a < 3; ++a) {
    lattice.counts[a] = 1 + static_cast<std::int64_t>(random() % 14);
    lattice.index_min[a] = -static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(lattice.counts[a]));
  }
  return lattice;
}

}  // namespace raycone::test
