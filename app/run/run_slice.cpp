#include "app/run/run_slice.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "app/picture/slice_picture.h"
#include "app/process/limits.h"
#include "app/process/stopwatch.h"
#include "app/process/version.h"
#include "app/run/field_evaluator.h"
#include "app/run/fields.h"
#include "app/run/mesh_run.h"
#include "app/run/slice_choice.h"
#include "app/run/written_files.h"
#include "io/fields/write_npy.h"
#include "io/fields/write_png.h"
#include "io/files/output_file.h"

namespace raycone {
namespace {

// Lattices cut distances off; points do not.
bool is_on_lattice(const Slice& slice, const FieldOptions& field) {
  return slice.lattice.has_value() && !field.has(Field::kDistance);
}

// Points evaluated at a time.
constexpr std::int64_t kPixelBatch = std::int64_t{1} << 18;

// Refuses pictures that cannot fit, before any work on them.
void check_slice_memory(const Slice& slice, const SliceCommand& command, const RunLimits& limits) {
  const double pixels = static_cast<double>(slice.view.width) * static_cast<double>(slice.view.height);
  const bool on_lattice = is_on_lattice(slice, command.field);
  const double samples = on_lattice ? static_cast<double>(FieldSamples::bytes_per_sample(command.field)) : 0.0;
  const double bytes = pixels * (sizeof(double) + samples) + slice_picture_bytes(slice.view, command.framed);
  check_memory(command.mesh.path, bytes, limits.memory());
}

// Lattices have their lowest row first, pictures their uppermost.
void turn_rows_over(std::span<double> values, std::int64_t width, std::int64_t height) {
  const auto row = [&](std::int64_t n) { return values.subspan(static_cast<std::size_t>(n * width)).begin(); };
  for (std::int64_t n = 0; n < height / 2; ++n) std::swap_ranges(row(n), row(n) + width, row(height - 1 - n));
}

void take(const FieldValues& from, std::span<double> to) {
  if (const auto* const flags = std::get_if<std::span<const std::uint8_t>>(&from)) {
    std::ranges::copy(*flags, to.begin());
  } else {
    std::ranges::copy(std::get<std::span<const double>>(from), to.begin());
  }
}

Tally evaluate_view(const FieldEvaluator& evaluator, const PlaneView& view, FieldSamples& samples,
                    std::span<double> values, std::atomic<std::uint64_t>* done) {
  Tally tally;
  std::vector<Vec3> points;
  const std::int64_t pixels = view.width * view.height;
  for (std::int64_t first = 0; first < pixels; first += kPixelBatch) {
    const std::int64_t count = std::min(kPixelBatch, pixels - first);
    points.clear();
    for (std::int64_t n = first; n < first + count; ++n) points.push_back(view.centre(n % view.width, n / view.width));
    tally += evaluator.evaluate(points, samples, done);
    take(samples.fields().front(), values.subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count)));
  }
  return tally;
}

Tally evaluate(const FieldEvaluator& evaluator, const Slice& slice, const FieldOptions& field, std::span<double> values,
               std::atomic<std::uint64_t>* done) {
  FieldSamples samples(field);
  if (!is_on_lattice(slice, field)) return evaluate_view(evaluator, slice.view, samples, values, done);
  const Tally tally = evaluator.evaluate(*slice.lattice, whole(*slice.lattice), samples, done);
  take(samples.fields().front(), values);
  turn_rows_over(values, slice.view.width, slice.view.height);
  return tally;
}

std::string described(const FieldOptions& field) {
  if (field.has(Field::kWinding)) return "winding number";
  return (field.has(Field::kInside) ? "inside by " : "signed distance by ") + name_of(field.rule);
}

PictureField picture_field(const FieldOptions& field) {
  if (field.has(Field::kInside)) return PictureField::kInside;
  return field.has(Field::kDistance) ? PictureField::kDistance : PictureField::kWinding;
}

void write_picture(OutputFile& output, const Image& image, const std::string& mesh, const std::string& what) {
  const std::string name = std::filesystem::path(mesh).filename().string();
  const PngDescription description{
      image.width(),
      image.height(),
      {{"Title", name}, {"Description", what}, {"Software", std::string("raycone ") + kVersion}}};
  static_assert(sizeof(Rgb) == 3);
  write_png(output, description,
            {reinterpret_cast<const std::uint8_t*>(image.pixels().data()), 3 * image.pixels().size()});
}

}  // namespace

RunReport run_slice(const SliceCommand& command, const RunLimits& limits) {
  MeshRun run(command.mesh, command.output, command.run, limits);
  RunReport& report = run.report;
  std::unique_ptr<OutputFile> values_file;
  if (command.values) values_file = std::make_unique<OutputFile>(*command.values, command.output.no_clobber);
  const TriangleMesh mesh = run.load_mesh(files_written(command));
  const Slice slice = choose_slice(bounding_box(mesh), command.slice, report.warnings);
  report.lattice = slice.lattice;
  report.samples = static_cast<std::uint64_t>(slice.view.width) * static_cast<std::uint64_t>(slice.view.height);
  run.print_warnings();

  check_slice_memory(slice, command, limits);
  if (values_file) values_file->reserve(report.samples * sizeof(double));
  const auto evaluator = timed(report.seconds.prepare, [&] {
    const std::vector<ExteriorEdge> edges = run.take_edges();
    return FieldEvaluator(mesh, command.field, &edges, static_cast<double>(report.samples));
  });
  report.exterior_edges = evaluator.winding_number().exterior_edges();
  std::atomic<std::uint64_t>* const done = run.start_progress(report.samples);
  std::vector<double> values(report.samples);
  report.tally =
      timed(report.seconds.evaluate, [&] { return evaluate(evaluator, slice, command.field, values, done); });
  report.terms = evaluator.winding_number().terms();
  report.largest_error_bound = evaluator.accuracy();
  timed(report.seconds.write, [&] {
    const Image picture = slice_picture(slice.view, values, mesh, picture_field(command.field), command.framed);
    write_picture(run.output, picture, report.mesh, described(command.field) + " at " + slice.plane);
    if (values_file) write_npy_rows(*values_file, slice.view.height, slice.view.width, values);
  });
  return run.finish();
}

}  // namespace raycone
