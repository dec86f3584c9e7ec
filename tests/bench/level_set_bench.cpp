// `--field sdf` beside OpenVDB's meshToLevelSet: seconds to prepare and evaluate, on one thread, neither reading nor
// writing. Same spacing, half width 3.
//   raycone_level_set_bench [BENCHMARK-OPTION...] -- MESH...
// Names: samples along the longest side / mesh / method. `error` is the largest difference from brute force at some
// samples of the band, in voxels; `signs` counts those of them on the wrong side.
#include <benchmark/benchmark.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "app/fields/field_evaluator.h"
#include "app/fields/fields.h"
#include "app/samples/lattice_choice.h"
#include "app/samples/slabs.h"
#include "core/exact/direct_distance.h"
#include "core/exact/direct_sum.h"
#include "core/machine/threads.h"
#include "core/mesh/weld.h"
#include "io/mesh/read_mesh.h"

namespace raycone::bench {
namespace {

constexpr double kHalfWidth = 3.0;  // voxels

// Samples of the band, and what brute force says of them.
struct Truth {
  std::array<std::int64_t, 3> index;
  double distance;  // signed, voxels
};

struct Workload {
  std::string name;
  TriangleMesh mesh;
  std::map<std::int64_t, std::vector<Truth>> truths{};  // by samples along the longest side: they take seconds
};

Lattice lattice_of(const TriangleMesh& mesh, std::int64_t side) {
  const Box box = bounding_box(mesh);
  const Vec3 size = box.upper - box.lower;
  const double h = std::max({size.x, size.y, size.z}) / static_cast<double>(side - 1);
  Lattice lattice;
  lattice.origin = box.lower;
  lattice.spacing = {h, h, h};
  for (int axis = 0; axis < 3; ++axis) {
    lattice.counts[static_cast<std::size_t>(axis)] = 1 + static_cast<std::int64_t>(std::ceil(size[axis] / h));
  }
  return with_layers(lattice, {4, 4, 4});
}

std::vector<Truth> some_truths(const TriangleMesh& mesh, const Lattice& lattice) {
  constexpr std::size_t kCount = 40;
  std::mt19937_64 generator(1);
  std::vector<Truth> truths;
  while (truths.size() < kCount) {
    const Triangle& t = mesh.triangles[generator() % mesh.triangles.size()];
    Truth truth;
    Vec3 point;
    for (int axis = 0; axis < 3; ++axis) {
      const double offset = std::ldexp(static_cast<double>(generator() >> 11), -53) * 4 - 2;
      const double at = (mesh.vertices[t[0]][axis] - lattice.origin[axis]) / lattice.spacing[axis];
      truth.index[static_cast<std::size_t>(axis)] = std::llround(at + offset);
      point[axis] = lattice.coordinate(axis, truth.index[static_cast<std::size_t>(axis)]);
    }
    const double distance = static_cast<double>(direct_distance(mesh, point)) / lattice.spacing.x;
    if (distance > kHalfWidth - 0.1) continue;
    truth.distance = static_cast<double>(perturbed_direct_sum(mesh, point).value) >= 0.5 ? -distance : distance;
    truths.push_back(truth);
  }
  return truths;
}

template <class DistanceAt>
void set_counters(benchmark::State& state, Workload& workload, const Lattice& lattice, const DistanceAt& at) {
  std::vector<Truth>& truths = workload.truths[*std::ranges::max_element(lattice.counts)];
  if (truths.empty()) truths = some_truths(workload.mesh, lattice);
  double error = 0.0;
  std::uint64_t wrong = 0;
  for (const Truth& truth : truths) {
    const double distance = at(truth.index);
    error = std::max(error, std::abs(std::abs(distance) - std::abs(truth.distance)));
    if (std::signbit(distance) != std::signbit(truth.distance) && truth.distance != 0.0) ++wrong;
  }
  state.counters["error"] = error;
  state.counters["signs"] = static_cast<double>(wrong);
  state.counters["faces"] = static_cast<double>(workload.mesh.triangles.size());
}

void by_raycone(benchmark::State& state, Workload& workload, const Lattice& lattice) {
  const ThreadLimit limit(1);
  FieldOptions options;
  options.fields = {Field::kDistance};
  const PlacedLattice placed(lattice);
  for (auto _ : state) {
    const FieldEvaluator evaluator(workload.mesh, options, nullptr, static_cast<double>(whole(lattice).size()));
    FieldSamples samples(options);
    samples.use_blocks();  // as for VDB
    for (LatticeBlock slab = slab_from(lattice, 2, 8, lattice.index_min[2]); slab.size() > 0;
         slab = slab_from(lattice, 2, 8, slab.first[2] + slab.counts[2])) {
      evaluator.evaluate(placed, slab, samples, nullptr);
      benchmark::DoNotOptimize(samples.distance_blocks());
    }
    state.counters["edges"] = static_cast<double>(evaluator.winding_number().exterior_edges());
  }
  const FieldEvaluator evaluator(workload.mesh, options);
  FieldSamples one(options);
  set_counters(state, workload, lattice, [&](const std::array<std::int64_t, 3>& index) {
    evaluator.evaluate(placed, {index, {1, 1, 1}}, one, nullptr);
    return one.distances()[0] / lattice.spacing.x;
  });
}

void by_openvdb(benchmark::State& state, Workload& workload, const Lattice& lattice) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  std::vector<openvdb::Vec3s> points;
  for (const Vec3& p : workload.mesh.vertices) {
    const Vec3 q = p - lattice.origin;
    points.emplace_back(static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z));
  }
  std::vector<openvdb::Vec3I> triangles;
  for (const Triangle& t : workload.mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  const auto transform = openvdb::math::Transform::createLinearTransform(lattice.spacing.x);
  openvdb::FloatGrid::Ptr grid;
  for (auto _ : state) {
    grid = openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*transform, points, triangles,
                                                              static_cast<float>(kHalfWidth));
  }
  set_counters(state, workload, lattice, [&](const std::array<std::int64_t, 3>& index) {
    const openvdb::Coord at(static_cast<int>(index[0]), static_cast<int>(index[1]), static_cast<int>(index[2]));
    return grid->tree().getValue(at) / lattice.spacing.x;
  });
}

void add(Workload& workload, std::int64_t side) {
  const Lattice lattice = lattice_of(workload.mesh, side);
  const std::string name = std::to_string(side) + "/" + workload.name + "/";
  benchmark::RegisterBenchmark((name + "raycone").c_str(), [&workload, lattice](benchmark::State& state) {
    by_raycone(state, workload, lattice);
  })->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark((name + "openvdb").c_str(), [&workload, lattice](benchmark::State& state) {
    by_openvdb(state, workload, lattice);
  })->Unit(benchmark::kMillisecond);
}

}  // namespace
}  // namespace raycone::bench

int main(int argc, char** argv) {
  using namespace raycone::bench;
  benchmark::Initialize(&argc, argv);
  openvdb::initialize();
  std::deque<Workload> workloads;  // registered benchmarks refer to its elements
  for (int n = 1; n < argc; ++n) {
    if (std::string(argv[n]) == "--") continue;
    Workload& workload = workloads.emplace_back();
    workload.name = std::filesystem::path(argv[n]).stem().string();
    workload.mesh = raycone::weld(raycone::read_mesh(argv[n]).parsed.mesh, {});
    for (const std::int64_t side : {128, 256, 512}) add(workload, side);
  }
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
