// raycone_distances: distances of generated triangles and meshes against exact arithmetic, for as long as you like.
//
//   raycone_distances [--seconds N] [--seed S]      (default: 3600 seconds, a seed from the clock, which is printed)
//
// Prints the first case that fails, a mesh as an OBJ file with its query; exit status 1.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "core/triangle_distance.h"
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

}  // namespace

int main(int argc, char** argv) {
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
  std::printf("meshes: %llu points right, %llu on the surface; %llu samples as points, %llu in the band\n",
              printable(counts.points), printable(counts.on_surface), printable(counts.samples),
              printable(counts.in_band));
  return 0;
}
