// What isolation costs: CPU time of a batch against that of the same lattices in one process, this one.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <sstream>

#include "app/input/run_limits.h"
#include "app/run/run_lattice.h"
#include "tests/app/batch/batch_fixture.h"

namespace raycone::test {
namespace {

class BatchCost : public Batch {};

// A torus of 2 n^2 triangles, of which some are missing.
std::string torus_with_holes(int n) {
  constexpr double kPi = 3.14159265358979323846;
  std::ostringstream obj;
  const auto vertex = [n](int a, int b) { return 1 + a % n * n + b % n; };
  for (int a = 0; a < n; ++a) {
    for (int b = 0; b < n; ++b) {
      const double u = 2 * kPi * a / n;
      const double v = 2 * kPi * b / n;
      const double r = 1 + 0.4 * std::cos(v);
      obj << "v " << r * std::cos(u) << ' ' << r * std::sin(u) << ' ' << 0.4 * std::sin(v) << '\n';
    }
  }
  for (int a = 0; a < n; ++a) {
    for (int b = 0; b < n; ++b) {
      obj << "f " << vertex(a, b) << ' ' << vertex(a + 1, b) << ' ' << vertex(a + 1, b + 1) << '\n';
      const bool missing = (a * n + b) % 40 == 0;
      if (!missing) obj << "f " << vertex(a, b) << ' ' << vertex(a + 1, b + 1) << ' ' << vertex(a, b + 1) << '\n';
    }
  }
  return obj.str();
}

double cpu_seconds(int who) {
  rusage usage{};
  getrusage(who, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double cpu_seconds_in_one_process(const std::vector<std::string>& meshes) {
  LatticeCommand command;
  std::get<LatticeRequest>(command.lattice).sampling = LongestSide{32};
  command.encoding.format = FieldFormat::kVdb;
  command.run.threads = 1;
  command.run.quiet = true;
  command.run.progress = ProgressMode::kNever;
  const double before = cpu_seconds(RUSAGE_SELF);
  for (const std::string& path : meshes) {
    command.mesh.path = path;
    command.output.path = path + ".vdb";
    const RunLimits limits(command.run, path);
    (void)run_lattice(command, limits);
  }
  return cpu_seconds(RUSAGE_SELF) - before;
}

// CPU time depends on what else a machine does: where that changes between the two, they are compared again. But 1.5
// has room: 0.9 to 1.0 was measured.
TEST_F(BatchCost, IsLessThanHalfAgainThatOfOneProcess) {
  constexpr std::size_t kMeshes = 300;
  constexpr double kAllowed = 1.5;
  std::vector<std::string> paths;
  for (std::size_t i = 0; i < kMeshes; ++i) {
    paths.push_back(put(std::to_string(i) + ".obj", torus_with_holes(16 + static_cast<int>(i) % 16)));
  }
  double ratio = kAllowed;
  for (int attempt = 0; attempt < 3 && ratio >= kAllowed; ++attempt) {
    const double in_one_process = cpu_seconds_in_one_process(paths);
    std::filesystem::remove_all(out_);
    const double before = cpu_seconds(RUSAGE_CHILDREN);
    ASSERT_EQ(run({"--resolution", "32", "--threads", "1"}).status, 0);
    ratio = (cpu_seconds(RUSAGE_CHILDREN) - before) / in_one_process;
    EXPECT_EQ(rows().size(), kMeshes);
  }
  RecordProperty("ratio", std::to_string(ratio));
  EXPECT_LT(ratio, kAllowed);
}

}  // namespace
}  // namespace raycone::test
