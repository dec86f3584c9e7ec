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
  // Opens the output, and the report and the list of files read, where wanted. `inputs`: the files that the command
  // names to be read. What else is given here must outlive this. Throws OutputError.
  MeshRun(const MeshOptions& mesh, const OutputFiles& output, const RunOptions& options,
          const std::vector<std::string>& inputs, const RunLimits& limits);
  MeshRun(const MeshRun&) = delete;  // total_ refers to the report
  MeshRun& operator=(const MeshRun&) = delete;

  // The mesh to evaluate; the report says where it is from, and has the warnings about it. Throws InputError,
  // LimitError, and what check_files_read() throws.
  [[nodiscard]] TriangleMesh load_mesh(const std::vector<WrittenFile>& written);

  // The same of a mesh that has been read already.
  [[nodiscard]] TriangleMesh prepare(TriangleMesh as_read);

  // To be called when the report knows which files meshes refer to. Throws ReplacesFileError where one of `written`
  // would replace one of them, OutputError where the list of files read cannot name one.
  void check_files_read(const std::vector<WrittenFile>& written) const;

  // exterior_edges() of that mesh, once.
  [[nodiscard]] std::vector<ExteriorEdge> take_edges() { return std::move(edges_); }

  // The place among the faces of the file of a face of that mesh.
  [[nodiscard]] std::uint32_t place_of(std::uint32_t face) const { return places_.empty() ? face : places_[face]; }

  // Prints what the report has by now and was not printed yet; throws InputError with --strict.
  void print_warnings();

  // A warning after that: printed at once; throws InputError with --strict.
  void warn(const Warning& warning);
  // Likewise, about a mesh that need not be the only one.
  void warn_about(const std::string& mesh, const std::vector<Warning>& warnings);
  // Likewise, about a file of points: with --strict no error, which is for meshes.
  void warn_of_points(const std::string& points, const std::vector<Warning>& warnings);

  // From here on progress is shown, where it is wanted. `total` samples, where known. Returns the count of those done,
  // to be increased by the work.
  [[nodiscard]] std::atomic<std::uint64_t>* start_progress(std::optional<std::uint64_t> total);

  // Progress shows this instead, which must stay valid; nullptr: samples again.
  void set_stage(const char* stage);

  // Everything is written: the report is complete, and all files appear. Throws OutputError.
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
