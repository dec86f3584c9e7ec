// raycone_distances: distances of generated triangles and meshes against exact arithmetic, for as long as you like.
//
//   raycone_distances [--seconds N] [--seed S]      (default: 3600 seconds, a seed from the clock, which is printed)
//   raycone_distances MESH...                       the same checks of files, once
//
// Prints the first case that fails, a mesh as an OBJ file with its query; exit status 1.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "core/distance/triangle_distance.h"
#include "core/mesh/weld.h"
#include "io/files/file_error.h"
#include "io/mesh/read_mesh.h"
#include "tests/property/cases.h"
#include "tests/property/distance_check.h"
#include "tests/property/triangle_cases.h"

namespace {

using Clock = std::chrono::steady_clock;
using namespace raycone;
using namespace raycone::test;

unsigned long long printable(std::uint64_t x) { return x; }

// Of distances that are not within 1e-12 of themselves, the largest error in u of the coordinates.
struct Worst {
  std::uint64_t cases = 0;
  double absolute = 0;
};

bool run_triangles(std::uint64_t seed, std::vector<Worst>& worst) {
  constexpr int kCases = 5000;
  Random random(seed);
  for (int family = 0; family < triangle_family_count(); ++family) {
    Worst& of_family = worst[static_cast<std::size_t>(family)];
    for (int n = 0; n < kCases; ++n) {
      const TriangleCase c = make_triangle_case(family, random);
      const auto& [p0, p1, p2] = c.corners;
      const double distance = std::sqrt(TriangleDistance(p0, p1, p2).squared(c.query));
      const DistanceError error = error_of(c, distance);
      ++of_family.cases;
      if (error.relative > 1e-12) of_family.absolute = std::max(of_family.absolute, error.absolute);
      if (error.is_small()) continue;
      const TriangleMesh mesh{{p0, p1, p2}, {{0, 1, 2}}};
      std::printf("# FAILED: family %d, seed %llu: off by %g of itself, by %g u of the coordinates\n%s", family,
                  printable(seed), error.relative, error.absolute, describe(mesh, {c.query, "distance"}).c_str());
      return false;
    }
  }
  return true;
}

bool run_meshes(std::uint64_t seed, DistanceCounts& counts) {
  for (std::size_t family = 0; family < family_count(); ++family) {
    const Case c = make_case(family, seed);
    Random random(seed);
    auto failure = check_distances(c.mesh, c.queries, counts);
    if (!failure) failure = check_lattice_distances(c.mesh, any_lattice(c.mesh, random), counts);
    if (!failure) continue;
    std::printf("# FAILED: %s, seed %llu\n%s", c.family.c_str(), printable(seed), describe(c.mesh, *failure).c_str());
    return false;
  }
  return true;
}

// In the box and around it; and next to triangles, on either side of them, as close as 1e-17 of the box.
std::vector<Vec3> points_near(const TriangleMesh& mesh, Random& random) {
  constexpr int kPoints = 100;
  const Box box = bounding_box(mesh);
  const Vec3 sides = box.upper - box.lower;
  std::vector<Vec3> points;
  for (int n = 0; n < kPoints; ++n) {
    points.push_back(uniform_point(random, {box.lower - 0.1 * sides, box.upper + 0.1 * sides}));
    const Triangle& t = mesh.triangles[random() % mesh.triangles.size()];
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const double s = uniform(random, 0, 1), r = uniform(random, 0, 1 - s);
    const double distance = std::pow(10.0, uniform(random, -17, -1));
    points.push_back(a + s * (b - a) + r * (c - a) + uniform_point(random, {(-distance) * sides, distance * sides}));
  }
  return points;
}

// Whether the file is right, or no mesh.
bool run_file(const std::string& path, DistanceCounts& counts) {
  TriangleMesh mesh;
  try {
    mesh = weld(read_mesh(path, {}).parsed.mesh, {});
  } catch (const InputError&) {
    return true;
  }
  if (mesh.triangles.empty()) return true;
  Random random(1);
  auto failure = check_distances(mesh, points_near(mesh, random), counts);
  constexpr int kLattices = 5;
  for (int n = 0; n < kLattices && !failure; ++n) {
    failure = check_lattice_distances(mesh, any_lattice(mesh, random), counts);
  }
  if (!failure) return true;
  const Vec3& q = failure->query;
  std::printf("# FAILED: %s at %.17g %.17g %.17g: %s\n", path.c_str(), q.x, q.y, q.z, failure->what.c_str());
  return false;
}

void print(const DistanceCounts& counts) {
  std::printf("meshes: %llu points right, %llu on the surface; %llu samples as points, %llu in the band\n",
              printable(counts.points), printable(counts.on_surface), printable(counts.samples),
              printable(counts.in_band));
}

// The exit status.
int run_files(const std::vector<std::string>& paths) {
  DistanceCounts counts;
  int failed = 0;
  for (const std::string& path : paths) failed += run_file(path, counts) ? 0 : 1;
  print(counts);
  return failed > 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && argv[1][0] != '-') return run_files({argv + 1, argv + argc});
  double seconds = 3600;
  auto seed = static_cast<std::uint64_t>(Clock::now().time_since_epoch().count());
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--seconds") == 0) seconds = std::strtod(argv[i + 1], nullptr);
    if (std::strcmp(argv[i], "--seed") == 0) seed = std::strtoull(argv[i + 1], nullptr, 10);
  }
  std::printf("seed %llu\n", printable(seed));
  std::vector<Worst> worst(static_cast<std::size_t>(triangle_family_count()));
  DistanceCounts counts;
  const auto start = Clock::now();
  for (; std::chrono::duration<double>(Clock::now() - start).count() < seconds; ++seed) {
    if (!run_triangles(seed, worst) || !run_meshes(seed, counts)) return 1;
  }
  constexpr std::array kNames{"proper", "caps", "needles at a", "needles at b", "slivers", "segments"};
  for (std::size_t family = 0; family < worst.size(); ++family) {
    std::printf("%s: %llu distances, within 1e-12 or by up to %.2g u of the coordinates\n", kNames[family],
                printable(worst[family].cases), worst[family].absolute);
  }
  print(counts);
  return 0;
}
