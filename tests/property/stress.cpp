// raycone_stress: generated cases against definitions, for as long as you like.
//
//   raycone_stress [--seconds N] [--seed S]      (default: 3600 seconds, a seed from the clock, which is printed)
//
// A failing case is shrunk and printed as an OBJ file with its query; exit status 1.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "tests/property/cases.h"
#include "tests/property/check.h"
#include "tests/property/check_samples.h"

namespace {

using Clock = std::chrono::steady_clock;
using namespace raycone::test;

// True if all hold.
bool run_cases(std::uint64_t seed, CheckCounts& counts) {
  for (std::size_t family = 0; family < family_count(); ++family) {
    const Case c = make_case(family, seed);
    if (const std::optional<Failure> off_surface = check_samples(c.mesh, seed, 20)) {
      std::printf("# FAILED: %s, seed %llu\n%s", c.family.c_str(), static_cast<unsigned long long>(seed),
                  describe(c.mesh, *off_surface).c_str());
      return false;
    }
    const std::optional<Failure> failure = check(c.mesh, c.queries, &counts);
    if (!failure) continue;
    const raycone::TriangleMesh small = shrink(c.mesh, failure->query);
    const std::optional<Failure> remaining = check(small, {failure->query});
    std::printf("# FAILED: %s, seed %llu\n%s", c.family.c_str(), static_cast<unsigned long long>(seed),
                describe(small, remaining.value_or(*failure)).c_str());
    return false;
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  double seconds = 3600;
  auto seed = static_cast<std::uint64_t>(std::chrono::system_clock::now().time_since_epoch().count());
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--seconds") == 0) seconds = std::strtod(argv[i + 1], nullptr);
    if (std::strcmp(argv[i], "--seed") == 0) seed = std::strtoull(argv[i + 1], nullptr, 10);
  }
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  CheckCounts counts;
  std::uint64_t rounds = 0;
  const auto start = Clock::now();
  while (std::chrono::duration<double>(Clock::now() - start).count() < seconds) {
    if (!run_cases(seed + rounds, counts)) return 1;
    ++rounds;
  }
  std::printf("%llu meshes, %llu values right: %llu on the surface, %llu with ties\n",
              static_cast<unsigned long long>(rounds * family_count()), static_cast<unsigned long long>(counts.values),
              static_cast<unsigned long long>(counts.on_surface), static_cast<unsigned long long>(counts.degenerate));
  return 0;
}
