// raycone beside a plain transcription of the paper: seconds to read, prepare and evaluate, on one thread and on all.
// Each evaluation reports a check beside its time: the sum of its values and how far they are from raycone's, so that
// a fast wrong answer shows. Names: what/mesh/method/threads. tests/bench/run.sh makes the tables.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/data/lattice.h"
#include "core/evaluation/winding_number.h"
#include "core/machine/threads.h"
#include "core/mesh/weld.h"
#include "io/mesh/read_mesh.h"
#include "tests/bench/io_bench.h"
#include "tests/bench/paper_transcription.h"
#include "tests/support/temporary_directory.h"

namespace raycone::bench {
namespace {

// The bundled teapot, and shared meshes: from closed to mostly boundary.
const std::vector<std::string> kMeshes = {
    RAYCONE_DATA "/meshes/teapot.obj",
    RAYCONE_SHARED_MESHES "/thingi10k/79741.stl",
    RAYCONE_SHARED_MESHES "/thingi10k/99865.stl",
    RAYCONE_SHARED_MESHES "/meshes__sword-quad-dominant.obj",
    RAYCONE_SHARED_MESHES "/meshes__nefertiti-lowres.obj",
    RAYCONE_SHARED_MESHES "/meshes__demosthenes-low-res.obj",
    RAYCONE_SHARED_MESHES "/meshes__mountain.obj",
    RAYCONE_SHARED_MESHES "/ipc-toolkit-tests-data__cloth_ball92.ply",
    RAYCONE_SHARED_MESHES "/pybullet_robots__head.STL",
};

constexpr std::int64_t kSamplesPerSide = 50;
constexpr std::size_t kPoints = 100'000;
constexpr std::size_t kPointsInClosedMeshes = 1'000'000;

// Both ends of the mesh's box are samples: `--resolution 50,50,50`.
Lattice lattice_of(const Box& box) {
  Lattice lattice;
  lattice.origin = box.lower;
  lattice.spacing = (1.0 / static_cast<double>(kSamplesPerSide - 1)) * (box.upper - box.lower);
  lattice.counts = {kSamplesPerSide, kSamplesPerSide, kSamplesPerSide};
  return lattice;
}

// Uniform in the box; mt19937_64 and this conversion give the same points everywhere.
std::vector<Vec3> random_points(const Box& box, std::size_t count) {
  std::mt19937_64 generator(1);
  const auto coordinate = [&](int axis) {
    const double fraction = std::ldexp(static_cast<double>(generator() >> 11), -53);
    return box.lower[axis] + fraction * (box.upper[axis] - box.lower[axis]);
  };
  std::vector<Vec3> points(count);
  for (Vec3& point : points) {
    for (int axis = 0; axis < 3; ++axis) point[axis] = coordinate(axis);
  }
  return points;
}

// A mesh and where it is evaluated; raycone's values are kept as the reference of the checks.
struct Workload {
  std::string path;
  std::string name;
  TriangleMesh mesh;  // as read
  TriangleMesh welded;
  Lattice lattice;
  std::vector<Vec3> points;
  std::vector<double> lattice_reference;
  std::vector<double> points_reference;
};

Workload load(const std::string& path) {
  Workload workload;
  workload.path = path;
  workload.name = std::filesystem::path(path).stem().string();
  workload.mesh = read_mesh(path).parsed.mesh;
  workload.welded = weld(workload.mesh, {});
  const Box box = bounding_box(workload.welded);
  workload.lattice = lattice_of(box);
  const WindingNumberEvaluator evaluator(workload.welded);
  workload.points = random_points(box, evaluator.exterior_edges() == 0 ? kPointsInClosedMeshes : kPoints);
  workload.lattice_reference.resize(static_cast<std::size_t>(whole(workload.lattice).size()));
  evaluator.evaluate(workload.lattice, whole(workload.lattice), workload.lattice_reference);
  workload.points_reference.resize(workload.points.size());
  evaluator.evaluate(workload.points, workload.points_reference);
  return workload;
}

void report(benchmark::State& state, std::uint64_t exterior_edges, const std::vector<double>& values,
            const std::vector<double>& reference) {
  double largest = 0.0;
  std::uint64_t wrong = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double difference = std::abs(values[i] - reference[i]);
    if (!(difference <= 0.5)) {  // NaN, too
      ++wrong;
    } else {
      largest = std::max(largest, difference);
    }
  }
  state.counters["samples"] = static_cast<double>(values.size());
  state.counters["exterior_edges"] = static_cast<double>(exterior_edges);
  state.counters["sum"] = std::accumulate(values.begin(), values.end(), 0.0);
  state.counters["off_by_turns"] = static_cast<double>(wrong);  // samples more than half a turn from raycone
  state.counters["max_difference"] = largest;                   // of the others
}

void evaluate(const WindingNumberEvaluator& evaluator, const Lattice& lattice, std::vector<double>& values) {
  evaluator.evaluate(lattice, whole(lattice), values);
}
void evaluate(const WindingNumberEvaluator& evaluator, const std::vector<Vec3>& points, std::vector<double>& values) {
  evaluator.evaluate(points, values);
}
void evaluate(const PaperTranscription& paper, const Lattice& lattice, std::vector<double>& values) {
  paper.evaluate(lattice, values);
}
void evaluate(const PaperTranscription& paper, const std::vector<Vec3>& points, std::vector<double>& values) {
  paper.evaluate(points, values);
}

void time_reading(benchmark::State& state, const Workload& workload) {
  for (auto _ : state) benchmark::DoNotOptimize(read_mesh(workload.path));
  state.counters["faces"] = static_cast<double>(workload.mesh.triangles.size());
}

// What points need beyond the preparation for lattices.
void prepare_points(const WindingNumberEvaluator& evaluator) { evaluator.prepare_points(); }
void prepare_points(const PaperTranscription&) {}

// raycone's preparation begins with welding; the transcription starts from welded vertices.
template <class Method>
void time_preparation(benchmark::State& state, const Workload& workload, bool for_points, int threads) {
  constexpr bool kWelds = std::is_same_v<Method, WindingNumberEvaluator>;
  const ThreadLimit limit(threads);
  for (auto _ : state) {
    state.PauseTiming();
    TriangleMesh mesh = kWelds ? workload.mesh : workload.welded;
    state.ResumeTiming();
    const Method method(kWelds ? weld(std::move(mesh), {}) : std::move(mesh));
    if (for_points) prepare_points(method);
    benchmark::DoNotOptimize(method.exterior_edges());
  }
}

template <class Method, class Samples>
void time_evaluation(benchmark::State& state, const Workload& workload, const Samples& samples,
                     const std::vector<double>& reference, int threads) {
  const ThreadLimit limit(threads);
  const Method method(workload.welded);
  prepare_points(method);
  std::vector<double> values(reference.size());
  for (auto _ : state) {
    evaluate(method, samples, values);
    benchmark::ClobberMemory();
  }
  report(state, method.exterior_edges(), values, reference);
}

template <class Body>
void add(const std::string& name, Body body) {
  benchmark::RegisterBenchmark(name.c_str(), body)->Unit(benchmark::kMillisecond)->UseRealTime();
}

template <class Method>
void add_method(const Workload& workload, const std::string& method, int threads) {
  const std::string suffix = "/" + workload.name + "/" + method + "/" + std::to_string(threads);
  add("prepare" + suffix, [&, threads](benchmark::State& s) { time_preparation<Method>(s, workload, false, threads); });
  add("prepare_points" + suffix,
      [&, threads](benchmark::State& s) { time_preparation<Method>(s, workload, true, threads); });
  add("lattice" + suffix, [&, threads](benchmark::State& s) {
    time_evaluation<Method>(s, workload, workload.lattice, workload.lattice_reference, threads);
  });
  add("points" + suffix, [&, threads](benchmark::State& s) {
    time_evaluation<Method>(s, workload, workload.points, workload.points_reference, threads);
  });
}

void add_workload(const Workload& workload, int threads) {
  add("read/" + workload.name, [&](benchmark::State& s) { time_reading(s, workload); });
  for (const int count : threads > 1 ? std::vector<int>{1, threads} : std::vector<int>{1}) {
    add_method<WindingNumberEvaluator>(workload, "raycone", count);
    add_method<PaperTranscription>(workload, "paper", count);
  }
}

}  // namespace
}  // namespace raycone::bench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  const int threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::deque<raycone::bench::Workload> workloads;  // registered benchmarks refer to its elements
  for (const std::string& path : raycone::bench::kMeshes) {
    if (!std::filesystem::exists(path)) {
      std::fprintf(stderr, "raycone_bench: skipping %s: no such file\n", path.c_str());
      continue;
    }
    workloads.push_back(raycone::bench::load(path));
    raycone::bench::add_workload(workloads.back(), threads);
  }
  const raycone::test::TemporaryDirectory directory;
  raycone::bench::add_io_benchmarks(directory.path());
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
