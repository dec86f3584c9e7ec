// What a mesh takes before anything is evaluated, on one thread, and what warnings about it take of that.
//   raycone_prepare_bench [BENCHMARK-OPTION...] -- [MESH...]       without meshes: the shared ones named below
// Counters: the least time of each step in ms; `percent`, what warnings take (links, defects) of all other steps;
// of distances, the order of the search tree's triangles (`runs`) and the whole tree.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/distance/distance_tree.h"
#include "core/evaluation/winding_number.h"
#include "core/machine/threads.h"
#include "core/mesh/exterior_edges.h"
#include "core/mesh/triangle_runs.h"
#include "core/mesh/vertex_links.h"
#include "core/mesh/weld.h"
#include "core/orientation/mesh_defects.h"
#include "io/mesh/read_mesh.h"

namespace raycone::bench {
namespace {

const std::vector<std::string> kMeshes = {
    RAYCONE_SHARED_MESHES "/large/happy_buddha_1087k.ply",
    RAYCONE_SHARED_MESHES "/meshes__nefertiti-lowres.obj",
    RAYCONE_SHARED_MESHES "/thingi10k/99865.stl",
    RAYCONE_SHARED_MESHES "/ipc-toolkit-tests-data__cloth_ball92.ply",
};

class Stopwatch {
 public:
  // Seconds since the last call.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> time = now - start_;
    start_ = now;
    return time.count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void time_steps(benchmark::State& state, const std::string& path) {
  const ThreadLimit limit(1);
  constexpr double kMs = 1e3, kLong = 1e9;
  double read = kLong, weld_time = kLong, plain = kLong, linked = kLong, defects = kLong, evaluator = kLong;
  double faces = 1, runs = kLong, tree = kLong;
  std::uint64_t found = 0;
  for (auto _ : state) {
    Stopwatch watch;
    MeshFile file = read_mesh(path);
    read = std::min(read, watch.lap());
    TriangleMesh mesh = weld(std::move(file.parsed.mesh), {});
    weld_time = std::min(weld_time, watch.lap());
    benchmark::DoNotOptimize(exterior_edges(mesh));
    plain = std::min(plain, watch.lap());
    VertexLinks links(mesh.vertices.size());
    const std::vector<ExteriorEdge> edges = exterior_edges(mesh, &links);
    linked = std::min(linked, watch.lap());
    faces = static_cast<double>(mesh.triangles.size());
    found = mesh_defects(mesh, edges, links).reversed_components;
    defects = std::min(defects, watch.lap());
    benchmark::DoNotOptimize(triangles_in_runs(mesh, TrianglePack::kWidth));
    runs = std::min(runs, watch.lap());
    benchmark::DoNotOptimize(DistanceTree(mesh));
    tree = std::min(tree, watch.lap());
    const WindingNumberEvaluator prepared(std::move(mesh), {.edges = &edges});
    evaluator = std::min(evaluator, watch.lap());
  }
  state.counters["read"] = kMs * read;
  state.counters["weld"] = kMs * weld_time;
  state.counters["edges"] = kMs * plain;
  state.counters["links"] = kMs * (linked - plain);
  state.counters["defects"] = kMs * defects;
  state.counters["evaluator"] = kMs * evaluator;
  state.counters["percent"] = 100 * (linked - plain + defects) / (read + weld_time + plain + evaluator);
  state.counters["runs_ns_per_face"] = 1e9 * runs / faces;
  state.counters["tree_ns_per_face"] = 1e9 * tree / faces;
  state.counters["reversed"] = static_cast<double>(found);
}

}  // namespace
}  // namespace raycone::bench

int main(int argc, char** argv) {
  using namespace raycone::bench;
  benchmark::Initialize(&argc, argv);
  std::vector<std::string> paths(argv + 1, argv + argc);
  if (paths.empty()) paths = kMeshes;
  for (const std::string& path : paths) {
    if (!std::filesystem::exists(path)) {
      std::fprintf(stderr, "raycone_prepare_bench: skipping %s: no such file\n", path.c_str());
      continue;
    }
    const std::string name = std::filesystem::path(path).stem().string();
    benchmark::RegisterBenchmark(name.c_str(), [path](benchmark::State& state) {
      time_steps(state, path);
    })->Unit(benchmark::kMillisecond);
  }
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
