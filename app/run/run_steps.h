// Steps that several commands take.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/options/options.h"
#include "app/report/run_report.h"
#include "core/data/triangle_mesh.h"
#include "core/machine/threads.h"
#include "io/fields/field_writer.h"
#include "io/files/output_file.h"
#include "io/mesh/read_mesh.h"

namespace raycone {

// The limits of a run on `mesh`, in force while this lives. One at a time.
class RunLimits {
 public:
  RunLimits(const RunOptions& options, const std::string& mesh);

  [[nodiscard]] int threads() const { return threads_; }
  [[nodiscard]] std::uint64_t memory() const { return memory_; }  // bytes

 private:
  int threads_;
  std::uint64_t memory_;
  ThreadLimit thread_limit_;
};

// What the machine lacks is a limit of the run: throws LimitError that names `mesh` and the limit (nullptr: unknown
// yet) where the exception being handled is of memory or threads, and that exception again where it is not.
[[noreturn]] void rethrow_as_limit(const std::string& mesh, const RunLimits* limits);

// body(limits), which are those of `options`.
template <typename Body>
auto within_limits(const RunOptions& options, const std::string& mesh, const Body& body) {
  std::optional<RunLimits> limits;
  try {
    limits.emplace(options, mesh);
    return body(*limits);
  } catch (...) {
    rethrow_as_limit(mesh, limits ? &*limits : nullptr);
  }
}

// What a command writes, and as what: "output", "report", ...
struct WrittenFile {
  std::string path;  // "-": standard output
  std::string role;
};
[[nodiscard]] std::vector<WrittenFile> files_written(const OutputFiles& output);
[[nodiscard]] std::vector<WrittenFile> files_written(const SliceCommand& command);

// Throws UsageError where one of `written` would replace or grow one of `inputs` ("-": standard input) or another of
// `written`, by whatever names: a slip of the keyboard must not cost the user an input. To be called before the work,
// and once more when it is known which files a mesh refers to.
void refuse_to_replace_input(const std::vector<WrittenFile>& written, const std::vector<std::string>& inputs);

// What is written beside the results; null where not asked for.
struct SideFiles {
  std::unique_ptr<OutputFile> report, depfile;
};
// Throws OutputError.
[[nodiscard]] SideFiles open_side_files(const OutputFiles& output);

// The mesh file with its concave polygons cut. Throws InputError, LimitError where the file alone is too large for the
// memory.
[[nodiscard]] MeshFile read(const MeshOptions& mesh, const RunLimits& limits);

// A report that says what was asked for; what comes out of it is yet to be filled in.
[[nodiscard]] RunReport report_on(const MeshOptions& mesh, const OutputFiles& output, const RunLimits& limits);
void describe(const MeshFile& file, RunReport& report);

// What the output will hold and say about itself; `report` is complete as far as mesh, edges and lattice go.
[[nodiscard]] OutputDescription description_of(const RunReport& report, const FieldOptions& field,
                                               const OutputOptions& output);

// Prints `warnings` about `mesh`; throws the first of them as InputError with --strict.
void warn(const std::vector<std::string>& warnings, const RunOptions& options, const std::string& mesh);

// The mesh that verification will need beside the evaluator's own; empty where none is asked for.
[[nodiscard]] TriangleMesh mesh_to_verify(const TriangleMesh& mesh, const FieldOptions& field);

// Where Embree is asked for, prepares it, which maps much memory and touches little.
void prepare_engine(const WindingNumberEvaluator& evaluator, const FieldOptions& field, const RunLimits& limits);

// Writes the `files` about the run, and prints its summary. Throws OutputError.
void publish(const RunReport& report, const RunOptions& options, const SideFiles& files);

}  // namespace raycone
