// raycone_accuracy: the largest difference between the evaluator and the oracle on real meshes, as a Markdown table.
//
//   raycone_accuracy [--quick] MESH ...
//
// Per mesh: 200 random points in the box of the mesh, 100 points at 1e-3 to 1e-9 of the box diagonal from its faces,
// edges and vertices, 100 points whose ray passes exactly through a vertex or meets an edge, and 2000 random nodes of
// the lattice of 50 x 50 x 50 samples of the box. Points exactly on the surface, where w jumps, are counted and left
// out. --quick takes a tenth of each. Exit status 1 if a difference exceeds 1e-10, a closed mesh gives a value that
// is not an integer, or there is no mesh.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "core/data/lattice.h"
#include "core/evaluation/winding_number.h"
#include "core/machine/threads.h"
#include "core/mesh/weld.h"
#include "io/mesh/read_mesh.h"
#include "tests/support/differences.h"
#include "tests/support/direct_winding_number.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::Random;
using test::uniform;

constexpr double kAllowed = 1e-10;

const Triangle& random_triangle(const TriangleMesh& mesh, Random& random) {
  return mesh.triangles[random() % mesh.triangles.size()];
}

Vec3 random_direction(Random& random) {
  for (;;) {
    const Vec3 d = test::uniform_point(random, {{-1, -1, -1}, {1, 1, 1}});
    const double length = std::sqrt(dot(d, d));
    if (length > 0.1 && length <= 1.0) return (1.0 / length) * d;
  }
}

std::vector<Vec3> points_in_box(const TriangleMesh& mesh, Random& random, std::size_t count) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back(test::uniform_point(random, bounding_box(mesh)));
  return points;
}

// At 1e-3 to 1e-9 of the box diagonal from a point inside a face, on an edge, or from a vertex, in turns.
std::vector<Vec3> points_near_surface(const TriangleMesh& mesh, Random& random, std::size_t count) {
  const Box box = bounding_box(mesh);
  const Vec3 diagonal = box.upper - box.lower;
  const double length = std::hypot(diagonal.x, diagonal.y, diagonal.z);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const Triangle& t = random_triangle(mesh, random);
    const double u = i % 3 == 2 ? 0.0 : uniform(random, 0, 1);
    const double v = i % 3 == 0 ? uniform(random, 0, 1 - u) : 0.0;
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const double distance = length * std::pow(10.0, -uniform(random, 3, 9));
    points.push_back(a + u * (b - a) + v * (c - a) + distance * random_direction(random));
  }
  return points;
}

// Level with a vertex (the ray meets it exactly), or with a point of an edge as close as doubles get.
std::vector<Vec3> points_with_degenerate_rays(const TriangleMesh& mesh, Random& random, std::size_t count) {
  const Box box = bounding_box(mesh);
  const double width = box.upper.x - box.lower.x;
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const Triangle& t = random_triangle(mesh, random);
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]];
    const Vec3 on_ray = i % 2 == 0 ? a : 0.5 * a + 0.5 * b;
    points.push_back({uniform(random, box.lower.x - 0.1 * width, box.upper.x), on_ray.y, on_ray.z});
  }
  return points;
}

Lattice lattice_of(const TriangleMesh& mesh, std::int64_t n) {
  const Box box = bounding_box(mesh);
  Lattice lattice{box.lower, {1, 1, 1}, {0, 0, 0}, {n, n, n}};
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = box.upper[axis] - box.lower[axis];
    if (extent > 0) {
      lattice.spacing[axis] = extent / static_cast<double>(n - 1);
    } else {
      lattice.counts[static_cast<std::size_t>(axis)] = 1;
    }
  }
  return lattice;
}

std::vector<Vec3> random_nodes(const TriangleMesh& mesh, Random& random, std::size_t count) {
  const Lattice lattice = lattice_of(mesh, 50);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) {
      const auto samples = static_cast<std::uint64_t>(lattice.counts[static_cast<std::size_t>(axis)]);
      p[axis] = lattice.coordinate(axis, static_cast<std::int64_t>(random() % samples));
    }
    points.push_back(p);
  }
  return points;
}

struct Errors {
  double largest = 0.0;
  double sum = 0.0;
  std::uint64_t values = 0;
  std::uint64_t on_surface = 0;
  std::uint64_t not_integer = 0;
  std::vector<double> bounds;

  [[nodiscard]] double mean() const { return values ? sum / static_cast<double>(values) : 0.0; }
};

struct Sample {
  double value = 0.0;
  std::int64_t crossings = 0;
  std::int64_t degenerate = 0;
  std::uint8_t on_surface = 0;
  double error_bound = 0.0;
  double difference = 0.0;
};

Sample evaluate(const WindingNumberEvaluator& evaluator, const Vec3& q) {
  Sample s;
  const Diagnostics diagnostics{{&s.crossings, 1}, {&s.degenerate, 1}, {&s.on_surface, 1}, {&s.error_bound, 1}};
  evaluator.evaluate({&q, 1}, {&s.value, 1}, nullptr, &diagnostics);
  return s;
}

Errors compare(const TriangleMesh& mesh, const WindingNumberEvaluator& evaluator, const std::vector<Vec3>& points) {
  std::vector<Sample> samples(points.size());
  parallel_for(points.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      samples[i] = evaluate(evaluator, points[i]);
      if (samples[i].on_surface) continue;
      samples[i].difference = std::abs(samples[i].value - test::direct_winding_number(mesh, points[i]));
    }
  });
  Errors errors;
  for (const Sample& s : samples) {
    errors.not_integer += s.value != std::nearbyint(s.value);
    errors.bounds.push_back(s.error_bound);
    if (s.on_surface) {
      ++errors.on_surface;
      continue;
    }
    ++errors.values;
    errors.sum += s.difference;
    errors.largest = test::larger_difference(errors.largest, s.difference);
  }
  return errors;
}

// Error bounds against true errors, in 113 bits.
struct Bounds {
  std::uint64_t violated = 0;
  double median_ratio = 0.0;  // of the bound to the error where there is one
};

Bounds compare_bounds(const TriangleMesh& mesh, const WindingNumberEvaluator& evaluator,
                      const std::vector<Vec3>& points) {
  std::vector<double> ratios(points.size(), 0.0);
  std::vector<std::uint8_t> violated(points.size(), 0);
  parallel_for(points.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Sample s = evaluate(evaluator, points[i]);
      if (s.on_surface) continue;
      const __float128 exact = test::direct_winding_number_quad(mesh, points[i]);
      const double error = static_cast<double>(exact > s.value ? exact - s.value : s.value - exact);
      violated[i] = !(error <= s.error_bound + 1e-25);  // what 113 bits leave of the sum; NaN violates
      if (error > 0) ratios[i] = s.error_bound / error;
    }
  });
  std::erase(ratios, 0.0);
  if (ratios.empty()) ratios.push_back(0.0);
  std::sort(ratios.begin(), ratios.end());
  return {static_cast<std::uint64_t>(std::count(violated.begin(), violated.end(), 1)), ratios[ratios.size() / 2]};
}

// Rows of the lattice with ties (docs/method.md, "Degenerate").
std::uint64_t count_degenerate_rows(const TriangleMesh& mesh, const WindingNumberEvaluator& evaluator) {
  const Lattice lattice = lattice_of(mesh, 50);
  std::uint64_t rows = 0;
  for (std::int64_t j = 0; j < lattice.counts[1]; ++j) {
    for (std::int64_t k = 0; k < lattice.counts[2]; ++k) {
      double value = 0;
      rows += evaluator.evaluate(lattice, {{0, j, k}, {1, 1, 1}}, {&value, 1}).degenerate > 0;
    }
  }
  return rows;
}

struct Totals {
  int meshes = 0;
  int wrong = 0;
  std::uint64_t bounds = 0;
  std::uint64_t bounds_above = 0;  // 1e-9
  double largest = 0.0;            // over the meshes, at lattice nodes
  double sum_of_largest = 0.0;
};

void report(const std::string& path, std::size_t divisor, Totals& totals) {
  const auto number = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
  const TriangleMesh mesh = weld(read_mesh(path).parsed.mesh, {});
  const WindingNumberEvaluator evaluator(mesh);
  Random random(mesh.triangles.size());
  const std::vector<Vec3> in_box = points_in_box(mesh, random, 200 / divisor);
  const Errors box = compare(mesh, evaluator, in_box);
  const Errors near = compare(mesh, evaluator, points_near_surface(mesh, random, 100 / divisor));
  const Errors rays = compare(mesh, evaluator, points_with_degenerate_rays(mesh, random, 100 / divisor));
  const Errors nodes = compare(mesh, evaluator, random_nodes(mesh, random, 2000 / divisor));
  const Bounds bounds =
      compare_bounds(mesh, evaluator, {in_box.begin(), in_box.begin() + 20 / static_cast<long>(divisor)});
  const bool closed = evaluator.exterior_edges() == 0;
  const bool good = std::max({box.largest, near.largest, rays.largest, nodes.largest}) <= kAllowed &&
                    !(closed && box.not_integer + near.not_integer + rays.not_integer + nodes.not_integer > 0) &&
                    bounds.violated == 0;
  std::printf("| %s |%zu|%llu|%.1e|%.1e|%.1e|%.1e|%.1e|%.2g|%llu|%llu|%s\n",
              std::filesystem::path(path).filename().c_str(), mesh.triangles.size(), number(evaluator.exterior_edges()),
              box.largest, near.largest, rays.largest, nodes.largest, nodes.mean(), bounds.median_ratio,
              number(count_degenerate_rows(mesh, evaluator)),
              number(box.on_surface + near.on_surface + rays.on_surface + nodes.on_surface), good ? "" : " **WRONG**");
  std::fflush(stdout);
  totals.wrong += !good;
  for (const Errors* errors : {&box, &near, &rays, &nodes}) {
    totals.bounds += errors->bounds.size();
    totals.bounds_above += static_cast<std::uint64_t>(
        std::count_if(errors->bounds.begin(), errors->bounds.end(), [](double b) { return !(b <= 1e-9); }));
  }
  totals.largest = std::max(totals.largest, nodes.largest);
  totals.sum_of_largest += nodes.largest;
}

}  // namespace
}  // namespace raycone

int main(int argc, char** argv) {
  std::size_t divisor = 1;
  raycone::Totals totals;
  std::printf(
      "| mesh | faces | edges | box | near | rays | nodes | mean | bound | rows | on |\n"
      "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--quick") == 0) {
      divisor = 10;
      continue;
    }
    ++totals.meshes;
    try {
      raycone::report(argv[i], divisor, totals);
    } catch (const std::exception& error) {
      ++totals.wrong;
      std::printf("| %s | **failed**: %s |\n", argv[i], error.what());
    }
  }
  std::printf(
      "\nOver all meshes, at 50³ nodes: largest difference %.2g, mean of the largest %.2g.\nError bounds above 1e-9: "
      "%llu of %llu.\n",
      totals.largest, totals.sum_of_largest / totals.meshes, static_cast<unsigned long long>(totals.bounds_above),
      static_cast<unsigned long long>(totals.bounds));
  std::printf(
      "\n%d meshes, %d with a difference above %g, a bound that does not hold, or a closed mesh without integers.\n",
      totals.meshes, totals.wrong, raycone::kAllowed);
  return totals.wrong == 0 && totals.meshes > 0 ? 0 : 1;
}
