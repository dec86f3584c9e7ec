#include "app/run/run_slice.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "app/fields/fields.h"
#include "app/fields/label_volume.h"
#include "app/input/written_files.h"
#include "app/picture/slice_picture.h"
#include "app/process/memory_limit.h"
#include "app/process/stopwatch.h"
#include "app/process/version.h"
#include "app/run/field_run.h"
#include "app/run/labels.h"
#include "app/run/mesh_run.h"
#include "app/samples/lattice_choice.h"
#include "app/samples/slabs.h"
#include "app/samples/slice_choice.h"
#include "app/text/plain_text.h"
#include "io/fields/write_npy.h"
#include "io/fields/write_png.h"
#include "io/files/counted.h"
#include "io/files/output_file.h"

namespace raycone {
namespace {

// Lattices cut distances off; points do not.
bool is_on_lattice(const Slice& slice, const FieldOptions& field) {
  return slice.lattice.has_value() && !field.has(Field::kDistance);
}

// Points evaluated at a time.
constexpr std::int64_t kPixelBatch = std::int64_t{1} << 18;

// Bytes that evaluating all pixels takes beside their values. Of points little: they come in batches.
double evaluation_memory(const Slice& slice, const FieldOptions& field, const RunReport& report) {
  if (field.has(Field::kLabel)) {
    const double volume = slice.lattice ? LabelVolume::bytes(*slice.lattice, report.parts.size()) : 0.0;
    return static_cast<double>(report.samples) * sizeof(std::int32_t) + volume;
  }
  if (!is_on_lattice(slice, field)) return 0.0;
  return slab_memory(whole(*slice.lattice), field, {.open = report.exterior_edges > 0});
}

PictureFrame frame_of(const SliceCommand& command) {
  return command.framed ? PictureFrame::kAxesAndLegend : PictureFrame::kNone;
}

// Refuses pictures that do not fit, before any work on them. Samples and picture are not in memory at one time.
void check_slice_memory(const Slice& slice, const SliceCommand& command, const RunReport& report,
                        const RunLimits& limits) {
  if (!is_on_lattice(slice, command.field)) {
    check_points_memory(report, command.field, static_cast<double>(report.samples), limits);
  }
  if (!slice.lattice) check_parts_memory(command.mesh, report.parts.size(), limits);
  const double values = static_cast<double>(report.samples) * sizeof(double);
  const double picture = slice_picture_bytes(slice.view, frame_of(command));
  const double bytes = values + std::max(evaluation_memory(slice, command.field, report), picture);
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

// Hands the centres of the pixels on, batch by batch: the samples of a lattice in its order, else row by row from the
// top.
template <typename Visit>
void for_pixels(const Slice& slice, const Visit& visit) {
  const PlaneView& view = slice.view;
  const auto centre = [&](std::int64_t n) {
    return slice.lattice ? slice.lattice->position(whole(*slice.lattice).index_of(static_cast<std::size_t>(n)))
                         : view.centre(n % view.width, n / view.width);
  };
  std::vector<Vec3> points;
  const std::int64_t pixels = view.width * view.height;
  for (std::int64_t first = 0; first < pixels; first += kPixelBatch) {
    const std::int64_t end = std::min(first + kPixelBatch, pixels);
    points.clear();
    for (std::int64_t n = first; n < end; ++n) points.push_back(centre(n));
    visit(static_cast<std::size_t>(first), points);
  }
}

void evaluate_field(TriangleMesh mesh, const Slice& slice, const FieldOptions& field, std::span<double> values,
                    MeshRun& run) {
  FieldRun fields(run, std::move(mesh), field, static_cast<double>(values.size()));
  if (!is_on_lattice(slice, field)) fields.prepare_points();
  std::atomic<std::uint64_t>* const done = run.start_progress(values.size());
  if (is_on_lattice(slice, field)) {
    fields.evaluate(*slice.lattice, whole(*slice.lattice), done);
    take(fields.values().front(), values);
  } else {
    for_pixels(slice, [&](std::size_t first, std::span<const Vec3> points) {
      fields.evaluate(points, done);
      take(fields.values().front(), values.subspan(first, points.size()));
    });
  }
  if (slice.lattice) turn_rows_over(values, slice.view.width, slice.view.height);
  fields.finish(std::numeric_limits<double>::infinity());
}

void evaluate_labels(LabelledParts& parts, const Slice& slice, const FieldOptions& field, std::span<double> values,
                     MeshRun& run) {
  std::vector<std::int32_t> labels(values.size());
  if (slice.lattice) {
    label_lattice(parts, *slice.lattice, field, run).copy(whole(*slice.lattice), labels);
    std::ranges::copy(labels, values.begin());
    return turn_rows_over(values, slice.view.width, slice.view.height);
  }
  PointLabels evaluator(parts, field, static_cast<double>(values.size()), run);
  std::atomic<std::uint64_t>* const done = run.start_progress(values.size());
  timed(run.report.seconds.evaluate, [&] {
    for_pixels(slice, [&](std::size_t first, std::span<const Vec3> points) {
      evaluator.evaluate(points, std::span(labels).subspan(first, points.size()));
      if (done) *done += points.size();
    });
  });
  evaluator.finish();
  std::ranges::copy(labels, values.begin());
}

// The lattice of the pixels' centres. Row 0 of the picture is its last row.
PlacedLattice lattice_of(const Slice& slice) {
  if (slice.lattice) return *slice.lattice;
  const PlaneView& view = slice.view;
  return {view.centre(0, view.height - 1),
          {view.pixel * view.right, view.pixel * view.up, view.pixel * view.normal},
          {0, 0, 0},
          {view.width, view.height, 1}};
}

std::string described(const FieldOptions& field) {
  if (field.has(Field::kWinding)) return "winding number";
  if (field.has(Field::kLabel)) return "labels by " + name_of(field.rule);
  return (field.has(Field::kInside) ? "inside by " : "signed distance by ") + name_of(field.rule);
}

PictureField picture_field(const FieldOptions& field) {
  if (field.has(Field::kInside)) return PictureField::kInside;
  if (field.has(Field::kLabel)) return PictureField::kLabel;
  return field.has(Field::kDistance) ? PictureField::kDistance : PictureField::kWinding;
}

// Titles of the picture, the longest first: the first one that there is room for is drawn.
std::vector<std::string> titles_of(const RunReport& report, const Slice& slice) {
  const std::string name = std::filesystem::path(report.mesh).filename().string();
  const std::string mesh = report.meshes.size() > 1 ? counted(report.meshes.size(), "mesh") : name;
  return {mesh + ", " + slice.plane, mesh + ", " + slice.short_plane, slice.plane, slice.short_plane};
}

void write_picture(OutputFile& output, const Image& image, const std::string& mesh, const std::string& what) {
  const std::string name = std::filesystem::path(mesh).filename().string();
  const PngDescription description{
      image.width(),
      image.height(),
      {{"Title", valid_utf8(name)}, {"Description", what}, {"Software", std::string("raycone ") + kVersion}}};
  static_assert(sizeof(Rgb) == 3);
  write_png(output, description,
            {reinterpret_cast<const std::uint8_t*>(image.pixels().data()), 3 * image.pixels().size()});
}

// What is cut: one mesh, or for labels its parts.
struct CutMesh {
  std::optional<LabelledParts> parts;
  TriangleMesh mesh;
  std::vector<std::string> names;  // of the parts
};

void load(const SliceCommand& command, MeshRun& run, CutMesh& cut) {
  if (!command.field.has(Field::kLabel)) {
    cut.mesh = run.load_mesh(files_written(command));
    return;
  }
  cut.parts.emplace(run, command.mesh, command.field, files_written(command), WholeMesh::kShown);
  cut.mesh = cut.parts->whole();
  for (const PartReport& part : run.report.parts) cut.names.push_back(part.name);
}

}  // namespace

RunReport run_slice(const SliceCommand& command, const RunLimits& limits) {
  MeshRun run(command.mesh, command.output, command.run, inputs_of(command), limits);
  RunReport& report = run.report;
  std::unique_ptr<OutputFile> values_file;
  if (command.values) values_file = std::make_unique<OutputFile>(*command.values, command.output.existing, &run.files);
  CutMesh cut;
  load(command, run, cut);
  const Box box = cut.parts ? cut.parts->box() : bounding_box(cut.mesh);
  const Slice slice = choose_for(command.mesh.path, [&] { return choose_slice(box, command.slice, report.warnings); });
  report.lattice = lattice_of(slice);
  report.samples = static_cast<std::uint64_t>(slice.view.width) * static_cast<std::uint64_t>(slice.view.height);
  run.print_warnings();

  check_slice_memory(slice, command, report, limits);
  if (values_file) values_file->reserve(report.samples * sizeof(double));
  std::vector<double> values(report.samples);
  if (cut.parts) {
    evaluate_labels(*cut.parts, slice, command.field, values, run);
  } else {
    evaluate_field(cut.mesh, slice, command.field, values, run);
  }
  timed(report.seconds.write, [&] {
    const std::vector<std::string> titles = titles_of(report, slice);
    const PictureValues shown{picture_field(command.field), values, cut.names, titles};
    const Image picture = slice_picture(slice.view, shown, cut.mesh, frame_of(command));
    write_picture(run.output, picture, report.mesh, described(command.field) + " at " + slice.plane);
    if (values_file) write_npy_rows(*values_file, slice.view.height, slice.view.width, values);
  });
  return run.finish();
}

}  // namespace raycone
