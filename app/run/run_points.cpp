#include "app/run/run_points.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "app/input/mesh_warnings.h"
#include "app/input/run_limits.h"
#include "app/input/written_files.h"
#include "app/process/stopwatch.h"
#include "app/process/usage_error.h"
#include "app/run/field_run.h"
#include "app/run/labels.h"
#include "app/run/mesh_run.h"
#include "app/samples/disk_space.h"
#include "app/samples/lattice_choice.h"
#include "app/samples/sampled_points.h"
#include "core/data/coordinate_precision.h"
#include "core/data/triangle_mesh.h"
#include "io/fields/field_writer.h"
#include "io/files/file_error.h"
#include "io/files/read_file.h"
#include "io/files/unpack.h"
#include "io/points/read_points.h"

namespace raycone {
namespace {

// Points evaluated at a time. Values do not depend on it.
struct PointBatch {
  std::size_t most = std::size_t{1} << 16;
  bool gathered = false;  // of several that the reader gives, as long as none has to be waited for
};

// Where a boundary is summed, or a nearest triangle is searched for, many points at a time share much of the work; that
// needs memory. Only where the number of points is known beforehand.
PointBatch batch_for(const PointsCommand& command, const PointReader& reader, bool open, const RunLimits& limits) {
  constexpr std::size_t kMany = std::size_t{1} << 18;
  constexpr std::uint64_t kEnoughMemory = std::uint64_t{1} << 29;
  PointBatch batch;
  if ((!open && !command.field.has(Field::kDistance)) || !reader.size()) return batch;
  if (limits.memory() >= kEnoughMemory) batch.most = kMany;
  batch.gathered = !command.sample;  // places() are those of one batch of the reader
  return batch;
}

// As reader.next(); gathers several of its batches where `batch` says so.
bool next(PointReader& reader, const PointBatch& batch, std::vector<Vec3>& points) {
  if (!reader.next(points, batch.most)) return false;
  std::vector<Vec3> more;
  while (batch.gathered && points.size() < batch.most && !reader.would_block() &&
         reader.next(more, batch.most - points.size())) {
    points.insert(points.end(), more.begin(), more.end());
  }
  return true;
}

// Drawn points are rounded to the precision that is written, so that values belong to the points that are stored.
CoordinatePrecision drawn_precision(const PointsCommand& command) {
  const Precision values = command.encoding.precision.value_or(Precision::kDouble);
  return command.sample && values != Precision::kDouble ? CoordinatePrecision::kSingle : CoordinatePrecision::kDouble;
}

// Opens the points that are given; null where points are to be drawn, which needs the mesh first.
std::unique_ptr<PointReader> open_given_points(const PointsCommand& command, const RunLimits& limits) {
  if (command.sample) return nullptr;
  std::unique_ptr<PointReader> reader;
  try {
    reader = open_points(command.points, command.reading);
  } catch (const std::bad_alloc&) {
    rethrow_as_limit(command.points, &limits);
  }
  if (command.reading.columns && !reader->has_columns()) {
    throw UsageError("--columns: has no effect on " + command.points + ", which is no text");
  }
  return reader;
}

// About how many points there are, where that can be told: not of a pipe, which may bring a few questions, nor of a
// packed file, which may be long.
std::optional<double> expected_points(const PointReader& reader, const std::string& path) {
  constexpr double kBytes = 25;  // of a line of text
  if (const std::optional<std::uint64_t> size = reader.size()) return static_cast<double>(*size);
  std::error_code error;
  if (path == "-" || !std::filesystem::is_regular_file(path, error)) return std::nullopt;
  constexpr std::size_t kHead = 8;
  if (is_packed(first_bytes(path, kHead))) return std::nullopt;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  return error ? std::nullopt : std::optional(static_cast<double>(bytes) / kBytes);
}

// The mesh as a whole, where something is asked about it or points are to be drawn from it; else one without triangles.
TriangleMesh load(const PointsCommand& command, MeshRun& run, std::optional<LabelledParts>& parts) {
  if (!command.field.has(Field::kLabel)) return run.load_mesh(files_written(command));
  const bool whole = !command.field.labels_only() || command.sample;
  parts.emplace(run, command.mesh, command.field, files_written(command),
                whole ? WholeMesh::kEvaluated : WholeMesh::kUnused);
  return whole ? run.prepare(parts->whole()) : TriangleMesh{};
}

// Points that are ready to be read, evaluated and written, batch by batch.
struct PointWork {
  FieldOptions field;  // but that labels verify themselves
  std::unique_ptr<PointReader> reader;
  std::unique_ptr<PointWriter> writer;
  std::optional<PointLabels> labels;  // where they are asked for
  std::optional<FieldRun> fields;
};

// Reserves room for the values of as many points as are known to come. What a head merely says must not look like a
// full disk; where the output is a file, its own head is completed at the end.
std::unique_ptr<PointWriter> open_writer(const PointsCommand& command, const PointReader& reader, MeshRun& run) {
  OutputDescription description = description_of(run.report, command.field, command.encoding);
  description.single_points = drawn_precision(command) == CoordinatePrecision::kSingle;
  description.has_places = command.sample && draws_on_surface(*command.sample);
  const bool is_certain = reader.has_certain_size();
  if (is_certain) run.output.reserve(least_point_file(command.encoding.format, description, *reader.size()));
  const bool is_used = is_certain || !run.output.seekable();
  return make_point_writer(command.encoding.format, run.output, is_used ? reader.size() : std::nullopt, description);
}

void prepare(const PointsCommand& command, TriangleMesh mesh, LabelledParts* parts, MeshRun& run, PointWork& work) {
  constexpr double kFew = 4096.0;
  constexpr double kMany = std::numeric_limits<double>::infinity();
  const std::optional<double> expected = expected_points(*work.reader, command.sample ? "-" : command.points);
  check_points_memory(run.report, command.field, expected.value_or(kMany), run.limits());
  const double points = expected.value_or(kFew);  // preparing for many would keep questions waiting
  const auto known = static_cast<double>(work.reader->size().value_or(0));
  check_verify_memory(command.mesh, command.field, known, run.limits());
  if (parts) check_parts_memory(command.mesh, parts->size(), run.limits());
  work.writer = open_writer(command, *work.reader, run);
  if (parts) work.labels.emplace(*parts, command.field, points, run);
  work.field = command.field;
  if (command.field.labels_only()) {
    work.field.verify = 0;
    mesh = {};
    static_cast<void>(run.take_edges());
  }
  work.fields.emplace(run, std::move(mesh), work.field, points, known);
  work.fields->prepare_points();
}

// The faces by their places among those of the file.
std::vector<std::int64_t> in_file(std::span<const std::int64_t> faces, const MeshRun& run) {
  std::vector<std::int64_t> places(faces.begin(), faces.end());
  for (std::int64_t& face : places) {
    if (face >= 0) face = run.place_of(static_cast<std::uint32_t>(face));
  }
  return places;
}

// Answers are handed on whenever the next question would have to be waited for.
void evaluate_points(const PointsCommand& command, PointWork& work, MeshRun& run) {
  PointReader& reader = *work.reader;
  FieldRun& fields = *work.fields;
  Seconds& seconds = run.report.seconds;
  double& source = command.sample ? seconds.evaluate : seconds.read;  // points that are drawn are made, not read
  const PointBatch batch = batch_for(command, reader, run.report.exterior_edges > 0, run.limits());
  std::atomic<std::uint64_t>* const done = run.start_progress(reader.size());
  std::vector<Vec3> points;
  // Of text, what has been answered is handed on before an error about what follows, too. In a binary file that is
  // damaged nothing is right.
  const auto read_more = [&] {
    try {
      if (reader.would_block()) work.writer->flush();
      return timed(source, [&] { return next(reader, batch, points); });
    } catch (const InputError&) {
      if (run.report.samples > 0 && reader.has_columns()) work.writer->flush();
      throw;
    }
  };
  while (read_more()) {
    if (run.report.samples == 0) run.warn_of_points(command.points, reader.warnings());
    fields.evaluate(points, done);
    if (work.labels) timed(seconds.evaluate, [&] { work.labels->evaluate(points, fields.labels()); });
    const SurfacePlaces places = reader.places();
    timed(seconds.write, [&] {
      work.writer->write(points, fields.values());
      if (!places.faces.empty()) work.writer->write_places(places.normals, in_file(places.faces, run));
    });
    run.report.samples += points.size();
  }
}

// Whether the points are drawn where the mesh is: their box is at most twice as wide along any axis.
bool is_close_to(const Box& box, const WorldPadding& padding) {
  const Box drawn = widened(box, padding);
  for (int axis = 0; axis < 3; ++axis) {
    if (drawn.upper[axis] - drawn.lower[axis] > 2.0 * (box.upper[axis] - box.lower[axis])) return false;
  }
  return true;
}

// Whether it is worth a warning if no point is inside. Given points may be anywhere; of a few, all may miss the mesh.
bool should_have_inside(const PointsCommand& command, const TriangleMesh& mesh) {
  constexpr std::uint64_t kMany = 1000;
  if (!command.sample || command.sample->bounds || points_around_mesh(*command.sample) < kMany) return false;
  const Box box = bounding_box(mesh);
  return may_have_inside(box) && is_close_to(box, command.sample->padding);
}

}  // namespace

RunReport run_points(const PointsCommand& command, const RunLimits& limits) {
  MeshRun run(command.mesh, command.output, command.run, inputs_of(command), limits);
  RunReport& report = run.report;
  PointWork work;
  work.reader = timed(report.seconds.read, [&] { return open_given_points(command, limits); });
  std::optional<LabelledParts> parts;
  TriangleMesh mesh = load(command, run, parts);
  if (!command.sample) report.files_read.push_back(command.points);
  run.print_warnings();
  if (command.sample) {
    work.reader = timed(report.seconds.prepare,
                        [&] { return draw_points(report.mesh, mesh, *command.sample, drawn_precision(command)); });
  }

  const bool is_empty_if_none_inside = should_have_inside(command, mesh);
  prepare(command, std::move(mesh), parts ? &*parts : nullptr, run, work);
  evaluate_points(command, work, run);
  if (is_empty_if_none_inside && work.fields->found_nothing_inside()) {
    run.warn(no_point_inside(command.field.rule, command.mesh.orient));
  }
  work.fields->finish(std::numeric_limits<double>::infinity());
  if (work.labels) work.labels->finish();
  timed(report.seconds.write, [&] { work.writer->finish(); });
  return run.finish();
}

}  // namespace raycone
