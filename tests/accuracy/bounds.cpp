// raycone_bounds: whether the printed error bounds hold, and how close they are, on millions of values; and Figure 4 of
// "Fast and Exact Winding Numbers" as a slice.
//
//   raycone_bounds [--values N]      (default: 2000000 values, 2.7 us each per triangle of meshes of about a hundred)
//   raycone_bounds --far [N]         the same of bounded engines: far fields at points, blocks of lattices, at three
//                                    tolerances each, on 30 meshes (default: 1e7 values); beside the direct sum in 64
//                                    bits, which takes 0.14 us per triangle
//   raycone_bounds --slice MESH      the mesh's connectivity with uniformly random vertices, a slice of 2000^2 samples:
//                                    the same to the bit by scan conversion, by Embree and as points; 200 by the oracle
//
// Exit status 1 if a bound or a tolerance does not hold, if fewer than 99.9 % of the bounds of direct sums are below
// 1e-9, or if values differ.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/evaluation/winding_number.h"
#include "core/machine/threads.h"
#include "core/mesh/weld.h"
#include "io/mesh/read_mesh.h"
#include "tests/support/diagnosed.h"
#include "tests/support/differences.h"
#include "tests/support/direct_winding_number.h"
#include "tests/support/lattice_samples.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::Random;
using test::uniform;

// ---- Bounds ----------------------------------------------------------------------------------------------------

struct NamedMesh {
  std::string name;
  TriangleMesh mesh;
};

TriangleMesh without_first(TriangleMesh mesh, std::ptrdiff_t faces) {
  mesh.triangles.erase(mesh.triangles.begin(), mesh.triangles.begin() + faces);
  return mesh;
}

TriangleMesh scrambled(TriangleMesh mesh, Random& random) {
  for (Vec3& v : mesh.vertices) v = test::uniform_point(random, {{0, 0, 0}, {1, 1, 1}});
  return mesh;
}

// A strip rolled up three times ("Fast and Exact Winding Numbers", Fig. 5).
TriangleMesh swiss_roll() {
  constexpr std::uint32_t kSteps = 60;
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i <= kSteps; ++i) {
    const double t = static_cast<double>(i) / kSteps, phi = 6 * std::numbers::pi * t, r = 0.1 + t;
    for (const double z : {0.0, 1.0}) mesh.vertices.push_back({r * std::cos(phi), r * std::sin(phi), z});
  }
  for (std::uint32_t i = 0; i < 2 * kSteps; i += 2) {
    mesh.triangles.push_back({i, i + 2, i + 1});
    mesh.triangles.push_back({i + 1, i + 2, i + 3});
  }
  return mesh;
}

// Open ones: bounds of closed meshes are zero.
std::vector<NamedMesh> meshes() {
  Random random(1);
  return {{"sphere with a hole", without_first(test::sphere(6), 30)},
          {"scrambled sphere with a hole", scrambled(without_first(test::sphere(5), 20), random)},
          {"soup", test::soup(random, 80)},
          {"Swiss roll", swiss_roll()},
          {"fan about one edge", test::fan(60, 40)},
          {"box without a lid, far away", test::moved(test::open_box(), {10, 10, 3}, {5e5, 4.6e6, 120})}};
}

// A third of them anywhere, a third near faces, a third near exterior edges, at 1e-2 to 1e-9 of the size.
std::vector<Vec3> queries_about(const TriangleMesh& mesh, Random& random, std::size_t count) {
  const Box box = bounding_box(mesh);
  const Vec3 size = box.upper - box.lower;
  std::vector<Vec3> queries;
  for (std::size_t i = 0; i < count; ++i) {
    if (i % 3 == 0) {
      queries.push_back(test::uniform_point(random, {box.lower - 0.2 * size, box.upper + 0.2 * size}));
      continue;
    }
    const Triangle& t = mesh.triangles[random() % mesh.triangles.size()];
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const double u = uniform(random, 0, 1), v = i % 3 == 1 ? uniform(random, 0, 1 - u) : 0.0;
    const Vec3 step = std::pow(10.0, -uniform(random, 2, 9)) * test::uniform_point(random, {{-1, -1, -1}, {1, 1, 1}});
    queries.push_back(a + u * (b - a) + v * (c - a) + Vec3{step.x * size.x, step.y * size.y, step.z * size.z});
  }
  return queries;
}

struct Quality {
  std::size_t values = 0;
  std::size_t violated = 0;
  std::size_t undecided = 0;  // the oracle's own error is as large as the bound
  std::size_t above = 0;      // 1e-9
  double median_ratio = 0.0;
  double largest = 0.0;
};

Quality quality_of(const TriangleMesh& mesh, const std::vector<Vec3>& queries) {
  const std::size_t n = queries.size();
  std::vector<double> ratios(n);
  const test::Diagnosed found = test::diagnosed(WindingNumberEvaluator(mesh), queries);
  const std::vector<double>&values = found.values, &bounds = found.bounds;
  std::atomic<std::size_t> violated = 0, undecided = 0;
  parallel_for(n, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (found.on_surface[i] != 0) continue;
      const Vec3& q = queries[i];
      const test::WithinQuad exact = test::winding_number_within(mesh, q);
      using Quad = __float128;
      const Quad difference = Quad(values[i]) - exact.value, error = difference < 0 ? -difference : difference;
      if (!(error <= Quad(bounds[i]) + exact.error)) ++violated;  // NaN violates
      if (exact.error > Quad(bounds[i])) ++undecided;
      // A value cannot be better than its own rounding.
      ratios[i] = bounds[i] / std::max(static_cast<double>(error), std::abs(values[i]) * 0x1p-53);
    }
  });
  Quality quality{n, violated, undecided, 0, 0.0, *std::max_element(bounds.begin(), bounds.end())};
  quality.above = static_cast<std::size_t>(std::ranges::count_if(bounds, [](double b) { return !(b <= 1e-9); }));
  std::nth_element(ratios.begin(), ratios.begin() + static_cast<std::ptrdiff_t>(n / 2), ratios.end());
  quality.median_ratio = ratios[n / 2];
  return quality;
}

int check_bounds(std::size_t values) {
  Random random(2);
  std::size_t violated = 0, above = 0, total = 0;
  const std::vector<NamedMesh> all = meshes();
  std::printf("| mesh | faces | values | violated | oracle too coarse | median of bound / error | largest bound |\n");
  std::printf("|---|--:|--:|--:|--:|--:|--:|\n");
  for (const auto& [name, mesh] : all) {
    const Quality q = quality_of(weld(mesh, {}), queries_about(mesh, random, values / all.size()));
    std::printf("| %s | %zu | %zu | %zu | %zu | %.2g | %.2g |\n", name.c_str(), mesh.triangles.size(), q.values,
                q.violated, q.undecided, q.median_ratio, q.largest);
    std::fflush(stdout);
    violated += q.violated;
    above += q.above;
    total += q.values;
  }
  std::printf("\n%zu values, %zu bounds violated, %zu above 1e-9\n", total, violated, above);
  return violated > 0 || above * 1000 > total ? 1 : 0;
}

// ---- Bounded engines -------------------------------------------------------------------------------------------

// Triangles of a soup, each a tenth as large: most are far from most samples.
TriangleMesh dust(Random& random, int triangles) {
  TriangleMesh mesh = test::soup(random, triangles);
  for (const Triangle& t : mesh.triangles) {
    const Vec3 centre = mesh.vertices[t[0]];
    for (const std::uint32_t v : t) mesh.vertices[v] = centre + 0.1 * (mesh.vertices[v] - centre);
  }
  return mesh;
}

std::vector<NamedMesh> meshes_of_bounded_engines() {
  Random random(5);
  std::vector<NamedMesh> all;
  for (int n = 0; n < 5; ++n) {
    const std::string number = " " + std::to_string(n + 1);
    all.push_back({"sphere with holes" + number, test::with_holes(test::sphere(7 + n), random, 0.1 + 0.05 * n)});
    all.push_back({"loose sphere" + number, test::loosened(test::sphere(6), random, 0.004 * (n + 1))});
    all.push_back({"dust" + number, dust(random, 60 + 40 * n)});
    all.push_back({"soup on a lattice" + number, test::lattice_soup(random, 80 + 30 * n, 8 + 4 * n)});
    all.push_back({"scrambled sphere" + number, scrambled(test::with_holes(test::sphere(5), random, 0.2), random)});
    const double stretch = std::pow(10.0, n - 2);
    all.push_back({"rolled strip" + number, test::moved(swiss_roll(), {1, stretch, 1 / stretch}, {0, 0, 10.0 * n})});
  }
  return all;
}

struct Bounded {
  std::size_t values = 0, violated = 0, beyond_tolerance = 0;
  double largest_error = 0.0, largest_bound = 0.0;

  void add(double error, double bound, double tolerance) {
    constexpr double kOracle = 2e-14;  // what the oracle is off by at most, twice
    ++values;
    if (!(error <= bound + kOracle)) ++violated;  // nor NaN
    if (!(error <= tolerance + kOracle)) ++beyond_tolerance;
    largest_error = std::max(largest_error, error);
    largest_bound = std::max(largest_bound, bound);
  }
};

struct Sampled {
  std::vector<Vec3> points;
  test::Diagnosed found;
};

// What evaluates them.
enum class Engine { kFarField, kBlocksOfLattices, kBlocksOfPoints };

// A lattice of about `count` samples, or as many points.
Sampled sampled(const TriangleMesh& mesh, Engine engine, double tolerance, std::size_t count, Random& random) {
  const Box box = bounding_box(mesh);
  const Vec3 size = box.upper - box.lower;
  const auto side = static_cast<std::int64_t>(std::cbrt(static_cast<double>(count)));
  const Lattice lattice{
      box.lower - 0.1 * size, (1.2 / static_cast<double>(side - 1)) * size, {0, 0, 0}, {side, side, side}};
  const bool on_lattice = engine == Engine::kBlocksOfLattices;
  const std::size_t n = on_lattice ? static_cast<std::size_t>(whole(lattice).size()) : count;
  std::vector<Vec3> points = on_lattice ? test::samples_of(lattice) : std::vector<Vec3>();
  while (points.size() < n)
    points.push_back(test::uniform_point(random, {box.lower - 0.1 * size, box.upper + 0.1 * size}));
  const auto samples = static_cast<double>(n);
  const WindingNumberEvaluator evaluator(
      mesh, {.summation = engine == Engine::kFarField ? Summation::kFarField : Summation::kBlocks,
             .accuracy = {.tolerance = tolerance, .samples = samples, .points = on_lattice ? 0.0 : samples}});
  test::Diagnosed found =
      on_lattice ? test::diagnosed(evaluator, lattice, whole(lattice)) : test::diagnosed(evaluator, points);
  return {std::move(points), std::move(found)};
}

void compare(const TriangleMesh& mesh, const Sampled& all, double tolerance, Bounded& result) {
  std::vector<double> errors(all.points.size());
  parallel_for(errors.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      errors[i] = std::abs(all.found.values[i] - test::direct_winding_number(mesh, all.points[i]));
    }
  });
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (all.found.on_surface[i] != 0) continue;  // there the oracle is not defined
    result.add(errors[i], all.found.bounds[i], tolerance);
  }
}

int check_bounded_engines(std::size_t values) {
  const std::vector<NamedMesh> all = meshes_of_bounded_engines();
  constexpr std::array kTolerances{1e-4, 1e-7, 1e-10};
  Random random(6);
  Bounded total;
  std::printf("| mesh | faces | tolerance | values | violated | beyond tolerance | largest error | largest bound |\n");
  std::printf("|---|--:|--:|--:|--:|--:|--:|--:|\n");
  for (const auto& [name, raw] : all) {
    const TriangleMesh mesh = weld(raw, {});
    for (const double tolerance : kTolerances) {
      Bounded here;
      constexpr std::array kEngines{Engine::kFarField, Engine::kBlocksOfLattices, Engine::kBlocksOfPoints};
      for (const Engine engine : kEngines) {
        const std::size_t count = values / (kEngines.size() * kTolerances.size() * all.size());
        compare(mesh, sampled(mesh, engine, tolerance, count, random), tolerance, here);
      }
      std::printf("| %s | %zu | %.0e | %zu | %zu | %zu | %.2g | %.2g |\n", name.c_str(), mesh.triangles.size(),
                  tolerance, here.values, here.violated, here.beyond_tolerance, here.largest_error, here.largest_bound);
      std::fflush(stdout);
      total.values += here.values;
      total.violated += here.violated;
      total.beyond_tolerance += here.beyond_tolerance;
    }
  }
  std::printf("\n%zu values, %zu bounds violated, %zu beyond the tolerance\n", total.values, total.violated,
              total.beyond_tolerance);
  return total.violated + total.beyond_tolerance > 0 ? 1 : 0;
}

// ---- The slice -------------------------------------------------------------------------------------------------

int check_slice(const char* path) {
  constexpr std::int64_t kSide = 2000;
  Random random(4);
  const TriangleMesh mesh = weld(scrambled(weld(read_mesh(path).parsed.mesh, {}), random), {});
  const double h = 1.0 / (kSide - 1);
  const Lattice lattice{{0, 0, 0.5}, {h, h, 1}, {0, 0, 0}, {kSide, kSide, 1}};
  const auto samples = static_cast<std::size_t>(whole(lattice).size());
  std::vector<Vec3> points(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    const auto n = static_cast<std::int64_t>(i);
    points[i] = {lattice.coordinate(0, n % kSide), lattice.coordinate(1, n / kSide), 0.5};
  }
  std::vector<double> scan(samples), embree(samples), one_by_one(samples);
  const WindingNumberEvaluator evaluator(mesh), by_embree(mesh, {.ray_engine = RayEngine::kEmbree});
  evaluator.evaluate(lattice, whole(lattice), scan);
  by_embree.evaluate(lattice, whole(lattice), embree);
  evaluator.evaluate(points, one_by_one);
  double largest = 0.0;
  for (int i = 0; i < 200; ++i) {
    const std::size_t at = random() % samples;
    largest = test::larger_difference(largest, std::abs(scan[at] - test::direct_winding_number(mesh, points[at])));
  }
  const auto [lower, upper] = std::ranges::minmax(scan);
  std::printf(
      "%zu faces, %llu exterior edges, w from %g to %g; %zu samples: Embree %s, points %s, oracle within %.2g\n",
      mesh.triangles.size(), static_cast<unsigned long long>(evaluator.exterior_edges()), lower, upper, samples,
      embree == scan ? "same" : "DIFFERS", one_by_one == scan ? "same" : "DIFFERS", largest);
  return embree == scan && one_by_one == scan && largest < 1e-9 ? 0 : 1;
}

// Digits alone: 1e7 would be taken as 1, and few values would pass any test.
std::uint64_t number_of_values(const char* text) {
  const std::uint64_t number = std::strtoull(text, nullptr, 10);
  if (text[std::strspn(text, "0123456789")] == '\0' && number > 0) return number;
  std::fprintf(stderr, "raycone_bounds: %s is no number of values; expected digits, such as 10000000\n", text);
  std::exit(2);
}

}  // namespace
}  // namespace raycone

int main(int argc, char** argv) {
  if (argc == 3 && std::strcmp(argv[1], "--slice") == 0) return raycone::check_slice(argv[2]);
  if (argc >= 2 && std::strcmp(argv[1], "--far") == 0) {
    return raycone::check_bounded_engines(argc == 3 ? raycone::number_of_values(argv[2]) : 10'000'000);
  }
  const bool given = argc == 3 && std::strcmp(argv[1], "--values") == 0;
  return raycone::check_bounds(given ? raycone::number_of_values(argv[2]) : 2'000'000);
}
