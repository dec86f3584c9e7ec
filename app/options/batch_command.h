// `raycone batch` and `raycone report`: many meshes, and a page about them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "app/options/lattice_command.h"
#include "app/options/points_command.h"
#include "app/options/run_options.h"
#include "io/files/output_file.h"

namespace raycone {

// What is done to one mesh.
using MeshCommand = std::variant<LatticeCommand, PointsCommand>;

// The grid of --like; null where there is none.
[[nodiscard]] inline const GridReference* grid_of(const MeshCommand& command) {
  const auto* const lattice = std::get_if<LatticeCommand>(&command);
  return lattice ? std::get_if<GridReference>(&lattice->lattice) : nullptr;
}

// What is behind each path of a list.
enum class PathEnd { kLineFeed, kNul };

// Which meshes a batch is about, and the outputs they are to have.
struct MeshSearch {
  std::vector<std::string> operands;  // MESH, DIR, @LIST, and @- or - for a list on standard input
  PathEnd path_end = PathEnd::kLineFeed;
  bool full_names = false;  // outputs keep the extension of the mesh
  std::string extension;    // of outputs, without the dot
};

// The I-th of N disjoint parts, 1 <= I <= N.
struct Shard {
  std::uint64_t index = 1;
  std::uint64_t count = 1;
};

// Largest number of meshes at a time: each takes an open file.
inline constexpr int kMaxJobs = 1024;

// What is done to each mesh of a batch, how, and where results go.
struct BatchCommand {
  MeshSearch search;
  std::string directory;       // of outputs and results
  std::optional<Shard> shard;  // else the whole
  bool writes = true;          // outputs, not just measurements
  MeshCommand for_each;        // its files, threads and memory are those of each mesh in turn
  std::string result_options;  // those that results depend on, as text: kept beside them
  RunOptions run;
  std::optional<int> jobs;  // meshes at a time; else as many as threads, at most kMaxJobs
  bool retry_failed = false;
  bool fail_fast = false;
  bool exit_zero = false;  // also where meshes failed
  bool prune = false;      // rows of meshes that are gone
  bool dry_run = false;
};

// What results depend on beside the mesh, as text: the command's result_options and, with --like, the `hash` of the
// grid, "" where it is not known.
[[nodiscard]] inline std::string options_with_grid(const BatchCommand& command, const std::string& hash) {
  return grid_of(command.for_each) ? command.result_options + '\n' + hash : command.result_options;
}

struct ReportCommand {
  std::string directory;  // of a batch
  std::string output;     // "-": standard output
  Existing existing = Existing::kReplaced;
  RunOptions run;
};

}  // namespace raycone
