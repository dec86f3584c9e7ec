#include "app/command_line/points_options.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/command_line/common_options.h"
#include "app/command_line/field_options.h"
#include "app/command_line/given_options.h"
#include "app/command_line/idle_options.h"
#include "app/command_line/sample_options.h"
#include "app/process/usage_error.h"
#include "app/text/parse_value.h"
#include "io/files/enumerated.h"
#include "io/files/file_identity.h"

namespace raycone {
namespace {

ReadPointsOptions parse_point_columns(const Values& values) {
  ReadPointsOptions options;
  if (!values.given("--columns")) return options;
  constexpr std::int64_t kMaxColumn = 1'000'000;
  const std::string text = values.text("--columns");
  const std::vector<std::int64_t> columns = integers_from(text).value_or(std::vector<std::int64_t>());
  const bool valid = std::ranges::all_of(columns, [](std::int64_t n) { return n >= 1 && n <= kMaxColumn; });
  if (!valid || columns.size() != 3) invalid("--columns", text, "three column numbers such as 2,3,4");
  options.columns = {static_cast<int>(columns[0]), static_cast<int>(columns[1]), static_cast<int>(columns[2])};
  return options;
}

std::optional<RawPrecision> parse_raw(const Values& values) {
  if (!values.given("--raw")) return std::nullopt;
  values.exclude("--raw", {"--format", "--columns", "--sample", "--dtype", "--pack-bits"});
  return values.choice<RawPrecision>("--raw", {{"f64", RawPrecision::kDouble}, {"f32", RawPrecision::kSingle}});
}

OutputFormats output_formats(const PointsCommand& command) {
  if (command.sample) return {.written = {FieldFormat::kNpz, FieldFormat::kCsv}, .contents = "drawn points"};
  OutputFormats formats{.written = formats_that_hold(FormatTraits::kPoints), .contents = "points"};
  if (command.reading.raw) {
    const bool single = *command.reading.raw == RawPrecision::kSingle;
    formats.only = single ? FieldFormat::kRawSingle : FieldFormat::kRawDouble;
  }
  return formats;
}

// NPY has one type for all columns, which must be able to hold counts and bounds.
void check_npy_columns(const PointsCommand& command) {
  const bool narrow = command.encoding.precision.value_or(Precision::kDouble) != Precision::kDouble;
  if (command.encoding.format != FieldFormat::kNpy || !narrow) return;
  if (command.field.diagnostics) {
    throw UsageError("--diagnostics: takes 64 bits in npy, expected --dtype f64, or npz");
  }
  if (command.field.has(Field::kLabel) && command.field.has_numbers()) {
    throw UsageError("--field label: takes 64 bits beside other fields in npy, expected --dtype f64, or npz");
  }
}

// Operands are meshes as long as nothing tells which of them is POINTS: the last one, unless all are meshes to draw
// points from.
Values with_points_operand(const Values& values, const FieldOptions& field) {
  std::vector<std::string> meshes = values.texts("MESH");
  if (meshes.size() < 2 || (values.given("--sample") && field.has(Field::kLabel))) return values;
  const std::string points = meshes.back();
  meshes.pop_back();
  return values.with("MESH", meshes).with("POINTS", {points});
}

// One of a file of points and a description of those to draw.
void parse_points_source(const Values& values, PointsCommand& command) {
  command.sample = parse_sample(values);
  command.points = values.text("POINTS");
  if (command.sample) {
    if (values.given("POINTS")) throw UsageError("POINTS " + command.points + ": cannot be combined with --sample");
    values.exclude("--sample", {"--columns"});
    // What networks are trained on.
    if (!values.given("--field")) command.field.fields = {Field::kWinding, Field::kInside, Field::kDistance};
    return;
  }
  if (!values.given("POINTS")) throw UsageError("POINTS is required, or --sample" + help_hint("points"));
  if (command.points.empty()) throw UsageError("POINTS: expected a file, not an empty name");
  if (is_standard_input(command.mesh.path) && is_standard_input(command.points)) {
    throw UsageError("MESH and POINTS cannot both be standard input");
  }
}

}  // namespace

CommandSpec points_spec() {
  OptionGroup output = output_group(joined(names_of(formats_that_hold(FormatTraits::kPoints)), "|"));
  output.options.push_back({"--dtype", "f16|f32|f64", "Type of values in NPY and NPZ (default: f64)"});
  output.options.push_back(pack_bits_option());
  const OptionGroup unlisted{"", {{"--band", "B", ""}}};  // to be told why it is not there
  return {
      .name = "points",
      .description = "Evaluate a mesh at given or random points",
      .operands = {meshes_operand(),
                   {"POINTS", "CSV, TSV or blank-separated text, NPY, NPZ or PLY file; - for text on standard input",
                    OperandCount::kOptional}},
      .groups = {mesh_group(),
                 {"Points",
                  {{"--columns", "A,B,C", "Columns of x, y, z in text, counted from 1"},
                   {"--raw", "f64|f32", "Read little-endian x y z triples, write bare values"}}},
                 sample_group(),
                 points_field_group(),
                 unlisted,
                 output,
                 run_group()},
      .examples = {"raycone points bunny.obj points.csv > values.csv",
                   "raycone points bunny.obj points.npy -o values.npy",
                   "raycone points bunny.obj cloud.ply -o values.csv",
                   "raycone points bunny.obj table.tsv --columns 2,3,4", "echo 0 0.1 0 | raycone points bunny.obj -",
                   "raycone points bunny.obj --sample uniform=100000,near=100000:0.01 -o bunny.npz"}};
}

Command parse_points(const Values& given) {
  PointsCommand command;
  command.field = parse_field(given);
  if (command.field.has(Field::kSolid)) refuse_solid();
  const Values values = with_points_operand(given, command.field);
  command.mesh = parse_meshes(values, command.field);
  command.run = parse_run(values);
  parse_points_source(values, command);
  command.reading = parse_point_columns(values);
  command.reading.raw = parse_raw(values);
  command.output = parse_output_files(values);
  command.encoding = parse_encoding(values, command.output, output_formats(command));
  check_npy_columns(command);
  command.run.options =
      given_options(values, option_names(points_spec()), command.sample ? kDefaultsOfDrawnPoints : kDefaultsOfPoints);
  refuse_idle_options(values, command);
  return command;
}

}  // namespace raycone
