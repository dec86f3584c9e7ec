// Memory does not grow with the number of evaluations in one process.
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "core/evaluation/winding_number.h"
#include "core/machine/threads.h"
#include "core/mesh/weld.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

// Kilobytes in memory now; 0 where the system does not tell.
std::size_t resident() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word && word != "VmRSS:") continue;
  std::size_t kilobytes = 0;
  status >> kilobytes;
  return kilobytes;
}

void evaluate_once(const TriangleMesh& mesh, const std::vector<Vec3>& points) {
  std::vector<double> values(points.size());
  const WindingNumberEvaluator evaluator(mesh);
  evaluator.evaluate(points, values);
  const Lattice lattice{{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, {0, 0, 0}, {3, 3, 3}};
  values.resize(27);
  evaluator.evaluate(lattice, whole(lattice), values);
}

TEST(Soak, ThousandsOfEvaluatorsLeaveNoMemoryBehind) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  constexpr std::size_t kAllowed = 512 << 10;  // what has been freed is kept for a while, to be watched
  constexpr int kEvaluators = 1000;            // takes a minute and more
#else
  constexpr std::size_t kAllowed = 4 << 10;  // arenas of threads; a leak of one vector per evaluation would be 10 MB
  constexpr int kEvaluators = 10'000;
#endif
  const ThreadLimit limit(8);  // each thread keeps some memory
  test::Random random(3);
  const TriangleMesh mesh = test::joined(test::open_box(), weld(test::soup(random, 20), {}));
  const std::vector<Vec3> points{{0, 0, 0}, {0.25, 0.5, 0.75}, {3, 2, 1}};
  for (int i = 0; i < 300; ++i) evaluate_once(mesh, points);
  const std::size_t before = resident();
  ASSERT_GT(before, 0U) << "the system does not tell";
  for (int i = 0; i < kEvaluators; ++i) evaluate_once(mesh, points);
  EXPECT_LE(resident(), before + kAllowed);
}

}  // namespace
}  // namespace raycone
