// The far field beside the direct sum: seconds to prepare and evaluate, on one thread, by summation.
//   raycone_far_bench [BENCHMARK-OPTION...] -- [MESH...]       without meshes: the open shared ones named below
// Names: samples/mesh/summation, samples being the side of a lattice or a number of points. Each reports how far its
// values are from those of the direct sum: in `wrong` how many are beyond the tolerance.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/data/lattice.h"
#include "core/evaluation/winding_number.h"
#include "core/machine/simd.h"
#include "core/machine/threads.h"
#include "core/mesh/weld.h"
#include "io/mesh/read_mesh.h"

namespace raycone::bench {
namespace {

constexpr double kTolerance = 1e-10;

const std::vector<std::string> kMeshes = {
    RAYCONE_SHARED_MESHES "/meshes__nefertiti-lowres.obj",
    RAYCONE_SHARED_MESHES "/meshes__mountain.obj",
    RAYCONE_SHARED_MESHES "/ipc-toolkit-tests-data__cloth_ball92.ply",
    RAYCONE_SHARED_MESHES "/pybullet_robots__head.STL",
};

struct Samples {
  std::string name;
  Lattice lattice;           // where there are no points
  std::vector<Vec3> points;  // uniform in the box

  [[nodiscard]] std::size_t size() const {
    return points.empty() ? static_cast<std::size_t>(whole(lattice).size()) : points.size();
  }
};

Samples lattice_samples(const Box& box, std::int64_t side) {
  Samples samples{std::to_string(side), {}, {}};
  samples.lattice.origin = box.lower;
  samples.lattice.spacing = (1.0 / static_cast<double>(side - 1)) * (box.upper - box.lower);
  samples.lattice.counts = {side, side, side};
  return samples;
}

Samples point_samples(const Box& box, std::size_t count) {
  Samples samples{"points" + std::to_string(count), {}, std::vector<Vec3>(count)};
  std::mt19937_64 generator(1);
  for (Vec3& point : samples.points) {
    for (int axis = 0; axis < 3; ++axis) {
      const double fraction = std::ldexp(static_cast<double>(generator() >> 11), -53);
      point[axis] = box.lower[axis] + fraction * (box.upper[axis] - box.lower[axis]);
    }
  }
  return samples;
}

struct Workload {
  std::string name;
  TriangleMesh mesh;
  std::deque<Samples> samples;
  std::map<const Samples*, std::vector<double>> direct;  // values, once they are needed
};

std::vector<double> values_of(const Workload& workload, const Samples& samples, Summation summation, double tolerance,
                              benchmark::State* state = nullptr) {
  const auto count = static_cast<double>(samples.size());
  const Accuracy accuracy{.tolerance = tolerance, .samples = count, .points = samples.points.empty() ? 0.0 : count};
  const auto start = std::chrono::steady_clock::now();
  const WindingNumberEvaluator evaluator(workload.mesh, {.summation = summation, .accuracy = accuracy});
  if (!samples.points.empty()) evaluator.prepare_points();
  const std::chrono::duration<double, std::milli> preparation = std::chrono::steady_clock::now() - start;
  std::vector<double> values(samples.size());
  if (samples.points.empty()) {
    evaluator.evaluate(samples.lattice, whole(samples.lattice), values);
  } else {
    evaluator.evaluate(samples.points, values);
  }
  if (state) {
    state->counters["prepare_ms"] = preparation.count();
    state->counters["exterior_edges"] = static_cast<double>(evaluator.exterior_edges());
    state->counters["near"] = static_cast<double>(evaluator.terms().near) / count;  // of one sample
    state->counters["far"] = static_cast<double>(evaluator.terms().far) / count;
  }
  return values;
}

void time_all(benchmark::State& state, Workload& workload, const Samples& samples, Summation summation,
              double tolerance) {
  const ThreadLimit limit(1);
  std::vector<double> values;
  for (auto _ : state) values = values_of(workload, samples, summation, tolerance, &state);
  std::vector<double>& direct = workload.direct[&samples];
  if (direct.empty()) direct = tolerance == 0.0 ? values : values_of(workload, samples, Summation::kCheapest, 0.0);
  double largest = 0.0;
  std::uint64_t wrong = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double difference = std::abs(values[i] - direct[i]);
    if (!(difference <= kTolerance)) ++wrong;  // NaN, too
    largest = std::max(largest, difference);
  }
  state.counters["max_difference"] = largest;
  state.counters["wrong"] = static_cast<double>(wrong);
}

void add(Workload& workload) {
  struct Method {
    const char* name;
    Summation summation;
    double tolerance;
  };
  for (const Samples& samples : workload.samples) {
    for (const Method& method :
         {Method{"direct", Summation::kCheapest, 0.0}, Method{"default", Summation::kCheapest, kTolerance},
          Method{"far", Summation::kFarField, kTolerance}, Method{"blocks", Summation::kBlocks, kTolerance}}) {
      const std::string name = samples.name + "/" + workload.name + "/" + method.name;
      benchmark::RegisterBenchmark(name.c_str(), [&workload, &samples, method](benchmark::State& state) {
        time_all(state, workload, samples, method.summation, method.tolerance);
      })->Unit(benchmark::kMillisecond);
    }
  }
}

}  // namespace
}  // namespace raycone::bench

int main(int argc, char** argv) {
  using namespace raycone::bench;
  benchmark::Initialize(&argc, argv);
  std::vector<std::string> paths(argv + 1, argv + argc);
  if (paths.empty()) paths = kMeshes;
  std::deque<Workload> workloads;  // registered benchmarks refer to its elements
  for (const std::string& path : paths) {
    if (!std::filesystem::exists(path)) {
      std::fprintf(stderr, "raycone_far_bench: skipping %s: no such file\n", path.c_str());
      continue;
    }
    Workload& workload = workloads.emplace_back();
    workload.name = std::filesystem::path(path).stem().string();
    workload.mesh = raycone::weld(raycone::read_mesh(path).parsed.mesh, {});
    const raycone::Box box = raycone::bounding_box(workload.mesh);
    workload.samples.push_back(lattice_samples(box, 50));
    workload.samples.push_back(lattice_samples(box, 128));
    workload.samples.push_back(lattice_samples(box, 256));
    workload.samples.push_back(point_samples(box, 100'000));
    workload.samples.push_back(point_samples(box, 1'000'000));
    add(workload);
  }
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
