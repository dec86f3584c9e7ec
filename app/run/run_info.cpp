#include "app/run/run_info.h"

#include <algorithm>
#include <cstdint>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/input/mesh_input.h"
#include "app/input/volume_input.h"
#include "app/input/written_files.h"
#include "app/options/field_options.h"
#include "app/process/messages.h"
#include "app/process/usage_error.h"
#include "app/report/info.h"
#include "app/run/info_listing.h"
#include "app/run/mesh_marks.h"
#include "app/run/requirements.h"
#include "app/samples/lattice_choice.h"
#include "core/data/warning.h"
#include "core/evaluation/winding_number.h"
#include "core/intersections/self_intersections.h"
#include "core/mesh/mesh_statistics.h"
#include "io/files/counted.h"
#include "io/files/file_error.h"
#include "io/files/output_file.h"
#include "io/mesh/write_ply.h"

namespace raycone {
namespace {

// The default, and what many go on to.
CostedLattices costed_lattices(const MeshToEvaluate& input, const Box& bounds) {
  constexpr double kMany = 1 << 24;  // samples
  CostedLattices costed;
  const WindingNumberEvaluator evaluator(input.mesh,
                                         {.accuracy = {FieldOptions{}.tolerance, kMany}, .edges = &input.edges});
  std::vector<Warning> warnings;  // of flat sides: none with one count for all axes
  try {
    for (const std::int64_t resolution : {std::int64_t{64}, std::int64_t{256}}) {
      LatticeRequest request;
      request.sampling = LongestSide{resolution};
      const Lattice lattice = choose_lattice(bounds, request, warnings);
      const auto [seconds, at_most] = evaluator.estimated_seconds(lattice);
      costed.lattices.push_back({lattice, seconds, at_most});
    }
  } catch (const LimitError& error) {
    costed.no_more = error.what();
  }
  return costed;
}

// Who names a mesh format means a mesh.
bool is_values(const MeshOptions& options) { return !options.reading.format && holds_values(options.path); }

// "161 pairs of faces intersect, 160 exterior edges"
std::string listed_flaws(std::uint64_t pairs, const MeshStatistics& statistics) {
  std::string text = counted(pairs, "pair") + " of faces intersect" + (pairs == 1 ? "s" : "");
  const std::pair<std::uint64_t, const char*> edges[] = {{statistics.nonmanifold_edges, "non-manifold edge"},
                                                         {statistics.inconsistent_edges, "inconsistent edge"},
                                                         {statistics.exterior_edges, "exterior edge"}};
  for (const auto& [count, name] : edges) {
    if (count > 0) text += ", " + counted(count, name);
  }
  return text;
}

// What is made of one mesh: printed, required, marked.
class InfoRun {
 public:
  InfoRun(const InfoCommand& command, const RunLimits& limits)
      : command_(command),
        limits_(limits),
        listing_({.format = command.format,
                  .several = command.meshes.size() > 1,
                  .with_intersections = counts_intersections()}),
        output_("-") {
    if (command.mark) mark_.emplace(*command.mark, command.existing, &files_);
  }

  // Prints the mesh, or the file of values. Returns whether it is what is required.
  bool describe(const MeshOptions& options) {
    if (!is_values(options)) return describe_mesh(options);
    print(listing_.entry({options.path, facts_of_file(options.path)}));
    return true;
  }

  void finish() {
    print(listing_.end());
    output_.commit();
    files_.commit();
    if (!marked_.empty() && !command_.run.quiet) print_message(marked_);
  }

 private:
  bool describe_mesh(const MeshOptions& options) {
    const std::vector<WrittenFile> written = files_written(command_);
    MeshFile file = read_mesh_file(options, limits_).file;
    for (const FileRead& companion : file.companions) refuse_to_replace_input(written, {companion.path});
    MeshInfo info;
    info.mesh = options.path;
    info.faces = file.parsed.mesh.triangles.size();
    info.vertices = file.parsed.mesh.vertices.size();
    info.skipped_faces = file.parsed.skipped_faces;
    info.unit = file.parsed.unit;
    info.warnings = std::move(file.parsed.warnings);
    const MeshToEvaluate input = mesh_to_evaluate(std::move(file.parsed.mesh), options, info.warnings);
    const TriangleMesh& mesh = input.mesh;
    print_warnings(info.warnings, command_.run, options.path);
    info.welded_vertices = mesh.vertices.size();
    info.bounds = bounding_box(mesh);
    info.statistics = mesh_statistics(mesh);
    info.opposite_duplicate_faces = input.defects.cancelling_pairs;
    if (options.orient == Orient::kAuto) info.turned = input.orientation;
    const FoundIntersections intersections = find_intersections(mesh);
    if (mark_) {
      const std::string flaws = listed_flaws(intersections.pairs.value_or(0), info.statistics);
      marked_ = options.path + " -> " + *command_.mark + ": " + flaws;
    }
    if (wants_intersections()) info.intersections = {intersections.pairs};
    const bool costs = command_.format == InfoFormat::kText;
    const CostedLattices costed = costs ? costed_lattices(input, info.bounds) : CostedLattices{};
    print(listing_.entry(info, costed, limits_.threads()));
    return judge(options.path,
                 unmet_requirements(command_.required, mesh, info.statistics, input.defects, intersections));
  }

  [[nodiscard]] bool requires_embedded() const {
    return std::ranges::count(command_.required, Requirement::kEmbedded) > 0;
  }
  [[nodiscard]] bool wants_intersections() const { return command_.intersections || requires_embedded(); }
  // Text for people need not count what is refused anyway, which may take n^2 time.
  [[nodiscard]] bool counts_intersections() const {
    return command_.intersections || (requires_embedded() && command_.format != InfoFormat::kText);
  }

  FoundIntersections find_intersections(const TriangleMesh& mesh) {
    if (mark_ || counts_intersections()) {
      const SelfIntersections all = self_intersections(mesh);
      if (mark_) write_ply(*mark_, marked_mesh(mesh, all.of_triangle));
      return {all.first, all.pairs};
    }
    if (requires_embedded()) {
      const std::optional<TrianglePair> first = first_self_intersection(mesh);
      return {first, first ? std::nullopt : std::optional<std::uint64_t>(0)};
    }
    return {};
  }

  // Entries appear as they come: the next mesh may take long.
  void print(const std::string& text) {
    output_.write(text.data(), text.size());
    output_.flush();
  }

  static bool judge(const std::string& mesh, const std::string& unmet) {
    if (!unmet.empty()) print_message(mesh + ": not as required: " + unmet);
    return unmet.empty();
  }

  const InfoCommand& command_;
  const RunLimits& limits_;
  InfoListing listing_;
  OutputGroup files_;
  OutputFile output_;
  std::optional<OutputFile> mark_;  // appears once everything has been told
  std::string marked_;              // what to say then
};

// Its status; what is wrong with this mesh alone is printed.
ExitCode status_of(InfoRun& run, const MeshOptions& options, const RunLimits& limits) {
  try {
    try {
      return run.describe(options) ? ExitCode::kDone : ExitCode::kInput;
    } catch (const std::bad_alloc&) {
      rethrow_as_limit(options.path, &limits);
    }
  } catch (const InputError&) {
    return report_current_exception();
  } catch (const LimitError&) {
    return report_current_exception();
  } catch (const ReplacesFileError&) {
    return report_current_exception();
  }
}

}  // namespace

ExitCode run_info(const InfoCommand& command, const RunLimits& limits) {
  std::vector<std::string> paths;
  for (const MeshOptions& mesh : command.meshes) paths.push_back(mesh.path);
  refuse_to_replace_input(files_written(command), paths);
  for (const MeshOptions& mesh : command.meshes) {
    if (command.for_meshes.empty() || !is_values(mesh)) continue;
    throw UsageError(command.for_meshes + ": has no effect on " + mesh.path + ", which is no mesh");
  }
  InfoRun run(command, limits);
  ExitCode worst = ExitCode::kDone;
  for (const MeshOptions& mesh : command.meshes) worst = std::max(worst, status_of(run, mesh, limits));
  run.finish();
  return worst;
}

}  // namespace raycone
