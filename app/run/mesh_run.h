// What every run over a mesh goes through, whatever is made of it.
//
//   MeshRun run(command.mesh, command.output, command.run, inputs_of(command), limits);  // the output is open
//   TriangleMesh mesh = run.load_mesh(files_written(command));  // read, and made ready to be evaluated
//   ...                                                         // what is evaluated is chosen: run.report
//   run.print_warnings();
//   ...                                                         // evaluated and written to run.output
//   return run.finish();
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/input/run_limits.h"
#include "app/input/written_files.h"
#include "app/options/mesh_options.h"
#include "app/options/output_options.h"
#include "app/options/run_options.h"
#include "app/process/progress.h"
#include "app/process/stopwatch.h"
#include "app/report/run_report.h"
#include "core/data/triangle_mesh.h"
#include "core/mesh/exterior_edges.h"
#include "io/files/output_file.h"

namespace raycone {

class MeshRun {
 public:
  // Opens the output and, where asked for, the report and the list of files read. `inputs`: the files that the command
  // names to be read. All that is given here but `inputs` must outlive this. Throws OutputError.
  MeshRun(const MeshOptions& mesh, const OutputFiles& output, const RunOptions& options,
          const std::vector<std::string>& inputs, const RunLimits& limits);
  MeshRun(const MeshRun&) = delete;  // total_ refers to the report
  MeshRun& operator=(const MeshRun&) = delete;

  // Reads the mesh and makes it ready to be evaluated. The report says where it is from, and has the warnings about it.
  // Throws InputError, LimitError, and what check_files_read() throws.
  [[nodiscard]] TriangleMesh load_mesh(const std::vector<WrittenFile>& written);

  // The same for a mesh that has been read already.
  [[nodiscard]] TriangleMesh prepare(TriangleMesh as_read);

  // Call it when report.files_read is complete, which is when it is known which files meshes refer to. Throws
  // ReplacesFileError where one of `written` would replace one of these files, OutputError where the list of files read
  // cannot name one.
  void check_files_read(const std::vector<WrittenFile>& written) const;

  // The exterior_edges() of that mesh. Call it once.
  [[nodiscard]] std::vector<ExteriorEdge> take_edges() { return std::move(edges_); }

  // The place among the faces of the file of a face of that mesh.
  [[nodiscard]] std::uint32_t place_of(std::uint32_t face) const { return places_.empty() ? face : places_[face]; }

  // Prints the report's warnings that were not printed yet. Throws StrictWarning with --strict if there are any.
  void print_warnings();

  // Adds a warning to the report after that, and prints it at once. Throws StrictWarning with --strict.
  void warn(const Warning& warning);
  // The same for a mesh that need not be the only one.
  void warn_about(const std::string& mesh, const std::vector<Warning>& warnings);
  // The same for a file of points, but without an error: --strict is about meshes.
  void warn_of_points(const std::string& points, const std::vector<Warning>& warnings);

  // Shows progress from here on, where it is wanted. `total`: samples, where known. Returns the count of samples done,
  // which the work increases; valid while this lives.
  [[nodiscard]] std::atomic<std::uint64_t>* start_progress(std::optional<std::uint64_t> total);

  // Shows `stage`, which must stay valid, in place of samples; with nullptr samples again.
  void set_stage(const char* stage);

  // Call it when everything is written: completes the report, and makes all files appear. Throws OutputError.
  [[nodiscard]] RunReport finish();

  [[nodiscard]] const RunLimits& limits() const { return limits_; }

  RunReport report;
  OutputGroup files;  // the output, and whatever else the run writes: all appear, or none does
  OutputFile output;

 private:
  void print(const std::string& file, const std::vector<Warning>& warnings, const RunOptions& options);

  const MeshOptions& mesh_;
  const OutputFiles& written_;
  const RunOptions& options_;
  const RunLimits& limits_;
  std::unique_ptr<OutputFile> report_file_, depfile_;  // null where not asked for
  std::vector<ExteriorEdge> edges_;
  std::vector<std::uint32_t> places_;
  std::size_t printed_ = 0;  // warnings of the report
  std::optional<Stopwatch> total_;
  std::optional<Progress> progress_;
};

}  // namespace raycone
