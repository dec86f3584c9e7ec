// The command line as data. Everything that needs no file is checked here; CLI11 stays behind options.cpp.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "app/batch/batch_meshes.h"
#include "app/batch/shard.h"
#include "app/process/progress.h"
#include "app/run/fields.h"
#include "app/run/lattice_choice.h"
#include "app/run/sampled_points.h"
#include "app/run/slice_choice.h"
#include "core/mesh/weld.h"
#include "io/fields/field_writer.h"
#include "io/mesh/read_mesh.h"
#include "io/points/read_points.h"

namespace raycone {

struct MeshOptions {
  std::string path;  // "-": standard input
  ReadMeshOptions reading;
  Weld weld;
};

struct RunOptions {
  std::optional<int> threads;                 // else default_threads()
  std::optional<std::uint64_t> memory_limit;  // bytes; else available_memory()
  std::optional<double> timeout;              // seconds
  ProgressMode progress = ProgressMode::kAuto;
  bool quiet = false;
  bool strict = false;
};

struct OutputFiles {
  std::string path;  // "-": standard output
  bool no_clobber = false;
  std::optional<std::string> report;
  std::optional<std::string> depfile;
};

struct OutputOptions : OutputFiles {
  FieldFormat format = FieldFormat::kCsv;
  bool double_precision = false;
  bool half_precision = false;
  std::optional<std::string> grid_name;  // of the only field's grid
};

// A grid of an OpenVDB file; an empty name is its only or first one.
struct GridReference {
  std::string path;
  std::string name;
};

struct LatticeCommand {
  MeshOptions mesh;
  RunOptions run;
  FieldOptions field;
  OutputOptions output;
  std::variant<LatticeRequest, GridReference> lattice;
};

struct PointsCommand {
  MeshOptions mesh;
  RunOptions run;
  FieldOptions field;
  OutputOptions output;
  std::string points;  // "-": standard input; empty where they are drawn
  ReadPointsOptions reading;
  std::optional<SampleRequest> sample;
};

// What a batch does to a mesh.
using MeshCommand = std::variant<LatticeCommand, PointsCommand>;

struct InfoCommand {
  MeshOptions mesh;
  RunOptions run;
  bool json = false;
};

// What is done to each mesh of a batch, how, and where results go.
struct BatchCommand {
  MeshSearch search;
  std::string directory;                  // of outputs and results
  std::optional<Shard> shard;             // else the whole
  std::string format;                     // of outputs; "none": none
  std::vector<std::string> mesh_options;  // "--name=value", by name: for mesh_command_of()
  RunOptions run;
  std::optional<int> jobs;  // meshes at a time; else as many as threads
  bool retry_failed = false;
  bool fail_fast = false;
  bool dry_run = false;
};

struct ReportCommand {
  std::string directory;  // of a batch
  std::string output;     // "-": standard output
};

struct SliceCommand {
  MeshOptions mesh;
  RunOptions run;
  OutputFiles output;
  SliceRequest slice;
  bool legend = true;
  std::optional<std::string> values;  // file for the numbers
};

// --help and --version: their text is a result.
struct PrintCommand {
  std::string text;
};

using Command =
    std::variant<LatticeCommand, PointsCommand, SliceCommand, InfoCommand, BatchCommand, ReportCommand, PrintCommand>;

// `arguments` without the program's name. Throws UsageError.
[[nodiscard]] Command parse_command_line(const std::vector<std::string>& arguments);

}  // namespace raycone
