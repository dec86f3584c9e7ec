#include "app/points_options.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/common_options.h"
#include "app/field_options.h"
#include "app/parse_value.h"
#include "app/usage_error.h"

namespace raycone {
namespace {

ReadPointsOptions parse_point_columns(const Values& values) {
  if (!values.given("--columns")) return {};
  constexpr std::int64_t kMaxColumn = 1'000'000;
  const std::string text = values.text("--columns");
  const std::vector<std::int64_t> columns = integers_from(text).value_or(std::vector<std::int64_t>());
  const bool valid = std::ranges::all_of(columns, [](std::int64_t n) { return n >= 1 && n <= kMaxColumn; });
  if (!valid || columns.size() != 3) invalid("--columns", text, "three column numbers such as 2,3,4");
  return {{{static_cast<int>(columns[0]), static_cast<int>(columns[1]), static_cast<int>(columns[2])}}};
}

OptionNames later_options() {
  OptionNames names = later_field_options();
  names.with_value.insert({"--sample", "--seed", "--raw"});
  return names;
}

}  // namespace

CommandSpec points_spec() {
  return {
      .name = "points",
      .description = "Values at given points",
      .operands = {mesh_operand(),
                   {"POINTS", "CSV, TSV or blank-separated text, NPY or PLY file; - for text on standard input"}},
      .groups = {mesh_group(),
                 {"Points", {{"--columns", "A,B,C", "Columns of x, y, z in text, counted from 1"}}},
                 field_group(),
                 unlisted_field_group(),
                 output_group("csv|npy"),
                 run_group()},
      .examples = {"raycone points bunny.obj points.csv > values.csv",
                   "raycone points bunny.obj points.npy -o values.npy",
                   "raycone points bunny.obj cloud.ply -o values.csv",
                   "raycone points bunny.obj table.tsv --columns 2,3,4", "echo 0 0.1 0 | raycone points bunny.obj -"},
      .later = later_options()};
}

Command parse_points(const Values& values) {
  PointsCommand command;
  command.field = parse_field(values);
  command.mesh = parse_mesh(values);
  command.run = parse_run(values);
  command.output = parse_output(values, {{FieldFormat::kCsv, FieldFormat::kNpy}, "csv or npy", "npz"});
  command.points = values.text("POINTS");
  if (command.points.empty()) throw UsageError("POINTS: expected a file, not an empty name");
  if (command.mesh.path == "-" && command.points == "-") {
    throw UsageError("MESH and POINTS cannot both be standard input");
  }
  command.reading = parse_point_columns(values);
  return command;
}

}  // namespace raycone
