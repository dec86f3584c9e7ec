// raycone_accuracy: the largest difference between the evaluator and the oracle on real meshes, as a Markdown table.
//
//   raycone_accuracy [--quick] MESH ...
//
// Per mesh: 200 random points in the box of the mesh, 100 points at 1e-3 to 1e-9 of the box diagonal from its faces,
// edges and vertices, 100 points whose ray passes exactly through a vertex or meets an edge, and 2000 random nodes of
// the lattice of 50 x 50 x 50 samples of the box. Points exactly on the surface, where w jumps, are counted and left
// out. --quick takes a tenth of each. Exit status 1 if a difference exceeds 1e-10 or a closed mesh gives a value that
// is not an integer.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "core/lattice.h"
#include "core/threads.h"
#include "core/weld.h"
#include "core/winding_number.h"
#include "io/read_mesh.h"
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

std::vector<Vec3> points_in_box(const TriangleMesh& mesh, Random& random, int count) {
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) points.push_back(test::uniform_point(random, bounding_box(mesh)));
  return points;
}

// At 1e-3 to 1e-9 of the box diagonal from a point inside a face, on an edge, or from a vertex, in turns.
std::vector<Vec3> points_near_surface(const TriangleMesh& mesh, Random& random, int count) {
  const Box box = bounding_box(mesh);
  const Vec3 diagonal = box.upper - box.lower;
  const double length = std::hypot(diagonal.x, diagonal.y, diagonal.z);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
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
std::vector<Vec3> points_with_degenerate_rays(const TriangleMesh& mesh, Random& random, int count) {
  const Box box = bounding_box(mesh);
  const double width = box.upper.x - box.lower.x;
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
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

std::vector<Vec3> random_nodes(const TriangleMesh& mesh, Random& random, int count) {
  const Lattice lattice = lattice_of(mesh, 50);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
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

  [[nodiscard]] double mean() const { return values ? sum / static_cast<double>(values) : 0.0; }
};

Errors compare(const TriangleMesh& mesh, const WindingNumberEvaluator& evaluator, const std::vector<Vec3>& points) {
  std::vector<double> values(points.size()), differences(points.size(), -1.0);
  parallel_for(points.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Tally tally = evaluator.evaluate({&points[i], 1}, {&values[i], 1});
      if (tally.on_surface) continue;
      differences[i] = std::abs(values[i] - test::direct_winding_number(mesh, points[i]));
    }
  });
  Errors errors;
  for (std::size_t i = 0; i < points.size(); ++i) {
    errors.not_integer += values[i] != std::nearbyint(values[i]);
    if (differences[i] < 0) {
      ++errors.on_surface;
      continue;
    }
    ++errors.values;
    errors.sum += differences[i];
    errors.largest = std::max(errors.largest, differences[i]);
  }
  return errors;
}

// Rows of the lattice whose ray meets an edge or vertex exactly.
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

bool report(const std::string& path, int divisor) {
  const TriangleMesh mesh = weld(read_mesh(path).parsed.mesh, {});
  const WindingNumberEvaluator evaluator(mesh);
  Random random(mesh.triangles.size());
  const Errors box = compare(mesh, evaluator, points_in_box(mesh, random, 200 / divisor));
  const Errors near = compare(mesh, evaluator, points_near_surface(mesh, random, 100 / divisor));
  const Errors rays = compare(mesh, evaluator, points_with_degenerate_rays(mesh, random, 100 / divisor));
  const Errors nodes = compare(mesh, evaluator, random_nodes(mesh, random, 2000 / divisor));
  const bool closed = evaluator.exterior_edges() == 0;
  const bool good = std::max({box.largest, near.largest, rays.largest, nodes.largest}) <= kAllowed &&
                    !(closed && box.not_integer + near.not_integer + rays.not_integer + nodes.not_integer > 0);
  std::printf("| %s | %zu | %llu | %.1e | %.1e | %.1e | %.1e | %.1e | %llu | %llu |%s\n",
              std::filesystem::path(path).filename().c_str(), mesh.triangles.size(),
              static_cast<unsigned long long>(evaluator.exterior_edges()), box.largest, near.largest, rays.largest,
              nodes.largest, nodes.mean(), static_cast<unsigned long long>(count_degenerate_rows(mesh, evaluator)),
              static_cast<unsigned long long>(box.on_surface + near.on_surface + rays.on_surface + nodes.on_surface),
              good ? "" : " **WRONG**");
  std::fflush(stdout);
  return good;
}

}  // namespace
}  // namespace raycone

int main(int argc, char** argv) {
  int divisor = 1, wrong = 0, meshes = 0;
  std::printf(
      "| mesh | faces | exterior edges | in the box | near the surface | degenerate rays | 50³ nodes | 50³ mean | "
      "degenerate rows of 50³ | on the surface |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--quick") == 0) {
      divisor = 10;
      continue;
    }
    try {
      ++meshes;
      wrong += !raycone::report(argv[i], divisor);
    } catch (const std::exception& error) {
      ++wrong;
      std::printf("| %s | **failed**: %s |\n", argv[i], error.what());
    }
  }
  std::printf("\n%d meshes, %d with a difference above %g or a closed mesh without integers.\n", meshes, wrong,
              raycone::kAllowed);
  return wrong == 0 ? 0 : 1;
}
