// Straight lines: output and points opened, mesh read, welded, evaluator built, batches evaluated and written.
#include "app/run/run_points.h"

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "app/process/limits.h"
#include "app/process/progress.h"
#include "app/process/stopwatch.h"
#include "app/run/disk_space.h"
#include "app/run/field_evaluator.h"
#include "app/run/fields.h"
#include "app/run/sampled_points.h"
#include "app/run/verify.h"
#include "core/mesh/weld.h"
#include "io/fields/field_writer.h"
#include "io/files/output_file.h"
#include "io/points/read_points.h"

namespace raycone {
namespace {

// Points evaluated at a time.
constexpr std::size_t kPointBatch = std::size_t{1} << 16;

// Answers are handed on whenever the next question would have to be waited for.
void evaluate_points(const FieldEvaluator& evaluator, PointReader& reader, PointWriter& writer, FieldSamples& samples,
                     SampleDraw& draw, Progress& progress, RunReport& report) {
  std::vector<Vec3> points;
  for (;;) {
    if (reader.would_block()) writer.flush();
    if (!timed(report.seconds.read, [&] { return reader.next(points, kPointBatch); })) return;
    report.tally +=
        timed(report.seconds.evaluate, [&] { return evaluator.evaluate(points, samples, progress.done()); });
    draw.offer(points, samples.numbers());
    timed(report.seconds.write, [&] { writer.write(points, samples.fields()); });
    report.samples += points.size();
  }
}

// Refuses meshes that cannot fit, before any work on them.
void check_points_memory(const PointsCommand& command, const TriangleMesh& mesh, const RunLimits& limits) {
  constexpr double kPerTriangle = 128.0;  // of the grid over their projections: surely; 400 are common
  if (command.field.engine != RayEngine::kScan) return;
  check_memory(command.mesh.path, kPerTriangle * static_cast<double>(mesh.triangles.size()), limits.memory());
}

// Null where points are to be drawn, which takes the mesh.
std::unique_ptr<PointReader> open_given_points(const PointsCommand& command) {
  return command.sample ? nullptr : open_points(command.points, command.reading);
}

}  // namespace

RunReport run_points(const PointsCommand& command, const RunLimits& limits) {
  RunReport report = report_on(command.mesh, command.output, limits);
  auto total = std::make_optional<Stopwatch>(report.seconds.total);
  OutputFile output(command.output.path, command.output.no_clobber);
  std::unique_ptr<PointReader> reader = timed(report.seconds.read, [&] { return open_given_points(command); });

  MeshFile file = timed(report.seconds.read, [&] { return read(command.mesh, limits); });
  describe(file, report);
  refuse_to_replace_input(files_written(command.output), report.files_read);
  if (!command.sample) report.files_read.push_back(command.points);
  report.warnings = std::move(file.parsed.warnings);
  warn(report.warnings, command.run, command.mesh.path);
  TriangleMesh mesh =
      timed(report.seconds.prepare, [&] { return weld(std::move(file.parsed.mesh), command.mesh.weld); });
  if (command.sample) {
    reader = timed(report.seconds.prepare, [&] { return draw_points(report.mesh, mesh, *command.sample); });
  }

  check_points_memory(command, mesh, limits);
  const TriangleMesh original = mesh_to_verify(mesh, command.field);
  const auto evaluator = timed(report.seconds.prepare, [&] { return FieldEvaluator(std::move(mesh), command.field); });
  timed(report.seconds.prepare, [&] {
    prepare_engine(evaluator.winding_number(), command.field, limits);
    evaluator.prepare_points();
  });
  report.exterior_edges = evaluator.winding_number().exterior_edges();
  const OutputDescription description = description_of(report, command.field, command.output);
  output.reserve(least_point_file(command.output.format, description, reader->size().value_or(0)));
  const std::unique_ptr<PointWriter> writer =
      make_point_writer(command.output.format, output, reader->size(), description);

  Progress progress(progress_is_shown(command.run.progress, command.run.quiet, command.output.path), reader->size());
  FieldSamples samples(command.field);
  SampleDraw draw(command.field.verify);
  evaluate_points(evaluator, *reader, *writer, samples, draw, progress, report);
  if (command.field.verify > 0) {
    report.verification = verify(report.mesh, original, evaluator, command.field,
                                 std::numeric_limits<double>::infinity(), draw.samples());
  }
  timed(report.seconds.write, [&] { writer->finish(); });
  progress.stop();
  total.reset();
  report.peak_memory_bytes = peak_memory();
  return report;
}

}  // namespace raycone
