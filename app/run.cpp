// Straight lines: output opened, mesh read, welded, evaluator built, samples evaluated and written, report.
#include "app/run.h"

#include <chrono>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "app/info.h"
#include "app/json.h"
#include "app/limits.h"
#include "app/progress.h"
#include "app/report.h"
#include "app/sample_values.h"
#include "app/signals.h"
#include "app/slabs.h"
#include "app/usage_error.h"
#include "app/verify.h"
#include "core/mesh_statistics.h"
#include "core/threads.h"
#include "core/weld.h"
#include "core/winding_number.h"
#include "io/field_writer.h"
#include "io/file_error.h"
#include "io/output_file.h"
#include "io/read_mesh.h"
#include "io/read_points.h"
#include "io/read_vdb.h"

namespace raycone {
namespace {

// Points evaluated at a time.
constexpr std::size_t kPointBatch = std::size_t{1} << 18;

// Adds the time until its end to `seconds`.
class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) : seconds_(seconds) {}
  ~Stopwatch() { seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& seconds_;
  Clock::time_point start_ = Clock::now();
};

template <typename Work>
auto timed(double& seconds, Work&& work) {
  const Stopwatch stopwatch(seconds);
  return work();
}

// The limits of a run, in force while this lives.
class Limits {
 public:
  Limits(const RunOptions& options, const std::string& mesh)
      : threads_(options.threads ? *options.threads : default_threads()),
        memory_(options.memory_limit ? *options.memory_limit : available_memory()),
        thread_limit_(threads_) {
    if (options.timeout) start_timeout(*options.timeout, mesh);
    if (options.memory_limit) cap_memory(memory_, threads_);
  }

  [[nodiscard]] int threads() const { return threads_; }
  [[nodiscard]] std::uint64_t memory() const { return memory_; }  // bytes

 private:
  int threads_;
  std::uint64_t memory_;
  ThreadLimit thread_limit_;
};

bool are_one_regular_file(const std::string& a, const std::string& b) {
  std::error_code error;  // a file that does not exist is no other
  return a != "-" && b != "-" && std::filesystem::is_regular_file(a, error) && std::filesystem::equivalent(a, b, error);
}

// A slip of the keyboard must not cost the user an input.
void refuse_to_replace_input(const OutputOptions& output, const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) {
    if (are_one_regular_file(output.path, input)) throw UsageError(output.path + ": is input and output");
    if (!output.report) continue;
    if (are_one_regular_file(*output.report, input)) throw UsageError(*output.report + ": is input and report");
  }
  if (output.report && are_one_regular_file(*output.report, output.path)) {
    throw UsageError(output.path + ": is output and report");
  }
}

std::unique_ptr<OutputFile> open_report(const OutputOptions& output) {
  return output.report ? std::make_unique<OutputFile>(*output.report, output.no_clobber) : nullptr;
}

MeshFile read(const MeshOptions& mesh, const Limits& limits) {
  std::error_code error;  // what has no size, such as a pipe, is not checked
  const std::uintmax_t size = std::filesystem::file_size(mesh.path, error);
  if (!error && mesh.path != "-") check_memory(mesh.path, static_cast<double>(size), limits.memory());
  return read_mesh(mesh.path, mesh.reading);
}

RunReport report_on(const MeshOptions& mesh, const OutputOptions& output, const Limits& limits) {
  RunReport report;
  report.mesh = mesh.path;
  report.output = output.path;
  report.threads = limits.threads();
  return report;
}

void describe(const MeshFile& file, RunReport& report) {
  report.sha256 = file.sha256;
  report.vertices = file.parsed.mesh.vertices.size();
  report.faces = file.parsed.mesh.triangles.size();
}

// Throws the first of them as InputError with --strict.
void warn(const std::vector<std::string>& warnings, const RunOptions& options, const std::string& mesh) {
  for (const std::string& warning : warnings) {
    if (options.strict) throw InputError(mesh + ": " + warning + " (an error because of --strict)");
    if (!options.quiet) print_message("warning: " + mesh + ": " + warning);
  }
}

Lattice lattice_for(const LatticeCommand& command, const TriangleMesh& mesh, std::vector<std::string>& warnings) {
  if (const auto* grid = std::get_if<GridReference>(&command.lattice)) return read_vdb_lattice(grid->path, grid->name);
  return choose_lattice(bounding_box(mesh), std::get<LatticeRequest>(command.lattice), warnings);
}

FieldDescription description_of(const RunReport& report, const FieldOptions& field, const OutputOptions& output) {
  FieldDescription description;
  description.mesh = std::filesystem::path(report.mesh).filename().string();
  description.mesh_sha256 = report.sha256;
  description.faces = report.faces;
  description.exterior_edges = report.exterior_edges;
  description.double_precision = output.double_precision;
  description.diagnostics = field.diagnostics;
  return description;
}

LatticeBlock first_slab(const Lattice& lattice, const LatticeWriter& writer) {
  const int axis = writer.slab_axis();
  return slab_from(lattice, axis, writer.slab_alignment(), lattice.index_min[static_cast<std::size_t>(axis)]);
}

// Refuses lattices that cannot fit, before any work on them.
std::unique_ptr<LatticeWriter> open_writer(const LatticeCommand& command, OutputFile& output, const RunReport& report,
                                           const Limits& limits) {
  const Lattice& lattice = *report.lattice;
  const FieldFormat format = command.output.format;
  const FieldDescription description = description_of(report, command.field, command.output);
  check_memory(report.mesh, writer_memory(lattice, format, description), limits.memory());
  std::unique_ptr<LatticeWriter> writer = make_lattice_writer(format, output, lattice, description);
  check_memory(report.mesh, slab_memory(first_slab(lattice, *writer), description.diagnostics), limits.memory());
  return writer;
}

LatticeBlock slab_behind(const LatticeBlock& slab, const Lattice& lattice, const LatticeWriter& writer) {
  const auto axis = static_cast<std::size_t>(writer.slab_axis());
  return slab_from(lattice, writer.slab_axis(), writer.slab_alignment(), slab.first[axis] + slab.counts[axis]);
}

void evaluate_lattice(const WindingNumberEvaluator& evaluator, LatticeWriter& writer, SampleValues& samples,
                      SampleDraw& draw, Progress& progress, RunReport& report) {
  const Lattice& lattice = *report.lattice;
  for (LatticeBlock slab = first_slab(lattice, writer); slab.size() > 0; slab = slab_behind(slab, lattice, writer)) {
    samples.resize(static_cast<std::size_t>(slab.size()));
    report.tally += timed(report.seconds.evaluate, [&] {
      return evaluator.evaluate(lattice, slab, samples.values(), progress.done(), samples.diagnostics());
    });
    draw.offer(lattice, slab, samples.values());
    timed(report.seconds.write, [&] { writer.write(slab, samples.values(), samples.diagnostics()); });
  }
}

// Answers are handed on whenever the next question would have to be waited for.
void evaluate_points(const WindingNumberEvaluator& evaluator, PointReader& reader, PointWriter& writer,
                     SampleValues& samples, SampleDraw& draw, Progress& progress, RunReport& report) {
  std::vector<Vec3> points;
  for (;;) {
    if (reader.would_block()) writer.flush();
    if (!timed(report.seconds.read, [&] { return reader.next(points, kPointBatch); })) return;
    samples.resize(points.size());
    report.tally += timed(report.seconds.evaluate, [&] {
      return evaluator.evaluate(points, samples.values(), progress.done(), samples.diagnostics());
    });
    draw.offer(points, samples.values());
    timed(report.seconds.write, [&] { writer.write(points, samples.values(), samples.diagnostics()); });
    report.samples += points.size();
  }
}

// The mesh that verification will need beside the evaluator's own.
TriangleMesh mesh_to_verify(const TriangleMesh& mesh, const FieldOptions& field) {
  return field.verify > 0 ? mesh : TriangleMesh{};
}

void publish(RunReport& report, const RunOptions& options, OutputFile* report_file) {
  report.peak_memory_bytes = peak_memory();
  if (report_file) {
    const std::string document = to_json(report);
    report_file->write(document.data(), document.size());
    report_file->commit();
  }
  if (!options.quiet) print_message(summary_line(report));
}

void print(const std::string& text) {
  OutputFile standard_output("-");
  standard_output.write(text.data(), text.size());
  standard_output.commit();
}

void run(const LatticeCommand& command) {
  const Limits limits(command.run, command.mesh.path);
  RunReport report = report_on(command.mesh, command.output, limits);
  auto total = std::make_optional<Stopwatch>(report.seconds.total);
  refuse_to_replace_input(command.output, {command.mesh.path});
  OutputFile output(command.output.path, command.output.no_clobber);
  const std::unique_ptr<OutputFile> report_file = open_report(command.output);

  MeshFile file = timed(report.seconds.read, [&] { return read(command.mesh, limits); });
  describe(file, report);
  TriangleMesh mesh = timed(report.seconds.prepare, [&] { return weld(file.parsed.mesh, command.mesh.weld); });
  report.warnings = std::move(file.parsed.warnings);
  file.parsed.mesh = {};
  report.lattice = lattice_for(command, mesh, report.warnings);
  report.samples = sample_count(*report.lattice);
  warn(report.warnings, command.run, command.mesh.path);

  const TriangleMesh original = mesh_to_verify(mesh, command.field);
  const auto evaluator = timed(report.seconds.prepare, [&] { return WindingNumberEvaluator(std::move(mesh)); });
  report.exterior_edges = evaluator.exterior_edges();
  const std::unique_ptr<LatticeWriter> writer = open_writer(command, output, report, limits);

  Progress progress(progress_is_shown(command.run.progress, command.run.quiet, command.output.path), report.samples);
  SampleValues samples(command.field.diagnostics);
  SampleDraw draw(command.field.verify);
  evaluate_lattice(evaluator, *writer, samples, draw, progress, report);
  if (command.field.verify > 0) report.verification = verify(report.mesh, original, evaluator, draw.samples());
  timed(report.seconds.write, [&] { writer->finish({report.tally.degenerate, report.tally.on_surface}); });
  progress.stop();
  total.reset();
  publish(report, command.run, report_file.get());
}

void run(const PointsCommand& command) {
  const Limits limits(command.run, command.mesh.path);
  RunReport report = report_on(command.mesh, command.output, limits);
  auto total = std::make_optional<Stopwatch>(report.seconds.total);
  refuse_to_replace_input(command.output, {command.mesh.path, command.points});
  OutputFile output(command.output.path, command.output.no_clobber);
  const std::unique_ptr<OutputFile> report_file = open_report(command.output);
  const std::unique_ptr<PointReader> reader =
      timed(report.seconds.read, [&] { return open_points(command.points, command.reading); });

  MeshFile file = timed(report.seconds.read, [&] { return read(command.mesh, limits); });
  describe(file, report);
  report.warnings = std::move(file.parsed.warnings);
  warn(report.warnings, command.run, command.mesh.path);
  TriangleMesh mesh = timed(report.seconds.prepare, [&] { return weld(file.parsed.mesh, command.mesh.weld); });
  file.parsed.mesh = {};

  const TriangleMesh original = mesh_to_verify(mesh, command.field);
  const auto evaluator = timed(report.seconds.prepare, [&] { return WindingNumberEvaluator(std::move(mesh)); });
  timed(report.seconds.prepare, [&] { evaluator.prepare_points(); });
  report.exterior_edges = evaluator.exterior_edges();
  const std::unique_ptr<PointWriter> writer =
      make_point_writer(command.output.format, output, reader->size(), command.field.diagnostics);

  Progress progress(progress_is_shown(command.run.progress, command.run.quiet, command.output.path), reader->size());
  SampleValues samples(command.field.diagnostics);
  SampleDraw draw(command.field.verify);
  evaluate_points(evaluator, *reader, *writer, samples, draw, progress, report);
  if (command.field.verify > 0) report.verification = verify(report.mesh, original, evaluator, draw.samples());
  timed(report.seconds.write, [&] { writer->finish(); });
  progress.stop();
  total.reset();
  publish(report, command.run, report_file.get());
}

void run(const InfoCommand& command) {
  const Limits limits(command.run, command.mesh.path);
  const MeshFile file = read(command.mesh, limits);
  warn(file.parsed.warnings, command.run, command.mesh.path);
  const TriangleMesh mesh = weld(file.parsed.mesh, command.mesh.weld);
  MeshInfo info;
  info.mesh = command.mesh.path;
  info.faces = file.parsed.mesh.triangles.size();
  info.vertices = file.parsed.mesh.vertices.size();
  info.welded_vertices = mesh.vertices.size();
  info.skipped_faces = file.parsed.skipped_faces;
  info.bounds = bounding_box(mesh);
  info.statistics = mesh_statistics(mesh);
  print(command.json ? to_json(info) : info_text(info, limits.threads()));
}

// Failed allocations are a limit of the run, so the message names it.
template <typename MeshCommand>
void run_within_limits(const MeshCommand& command) {
  try {
    run(command);
  } catch (const std::bad_alloc&) {
    const std::optional<std::uint64_t> limit = command.run.memory_limit;
    throw LimitError(command.mesh.path + ": out of memory" +
                     (limit ? ", the limit is " + readable_bytes(static_cast<double>(*limit)) : ""));
  }
}

void run_within_limits(const PrintCommand& command) { print(command.text); }

}  // namespace

void run(const Command& command) {
  std::visit([](const auto& one) { run_within_limits(one); }, command);
}

}  // namespace raycone
