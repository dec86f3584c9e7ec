#include "app/command_line/slice_options.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/command_line/common_options.h"
#include "app/command_line/field_options.h"
#include "app/command_line/given_options.h"
#include "app/command_line/idle_options.h"
#include "app/command_line/lattice_options.h"
#include "app/process/usage_error.h"
#include "app/text/parse_value.h"
#include "io/fields/field_writer.h"
#include "io/files/ascii.h"

namespace raycone {
namespace {

constexpr std::int64_t kMostPixels = 1'000'000;  // along a side

// There is one format; its name and extension are checked as those of other commands.
void check_format(const Values& values, const std::string& output) {
  if (values.given("--format")) {
    if (!is_word(values.text("--format"), "png")) invalid("--format", values.text("--format"), "png");
    return;
  }
  if (output == "-" || has_extension(output, "png")) return;
  throw UsageError(output + ": its extension names no format, expected png, or --format");
}

std::variant<Percentage, double> parse_at(const std::string& text) {
  const bool percent = text.ends_with('%');
  const std::optional<double> number = number_from(std::string_view(text).substr(0, text.size() - (percent ? 1 : 0)));
  if (!number) invalid("--at", text, "a coordinate, or a percentage of the box such as 50%");
  if (percent) return Percentage{*number};
  return *number;
}

AxisPlane parse_axis_plane(const Values& values) {
  AxisPlane plane;
  if (values.given("--axis")) {
    const std::string axis = values.text("--axis");
    const std::size_t index = std::string_view("xyz").find(axis);
    if (axis.size() != 1 || index == std::string_view::npos) invalid("--axis", axis, "x, y or z");
    plane.axis = static_cast<int>(index);
  }
  if (values.given("--at")) plane.at = parse_at(values.text("--at"));
  return plane;
}

Vec3 vector_from(const std::string& name, const std::string& text) {
  const std::vector<double> numbers = numbers_from(text).value_or(std::vector<double>());
  if (numbers.size() != 3) invalid(name, text, "three numbers X,Y,Z");
  return {numbers[0], numbers[1], numbers[2]};
}

Vec3 direction_from(const std::string& name, const std::string& text) {
  const Vec3 direction = vector_from(name, text);
  if (direction == Vec3{}) invalid(name, text, "a direction, not all of it 0");
  return direction;
}

ObliquePlane parse_oblique_plane(const Values& values, const Values& up) {
  ObliquePlane plane;
  plane.normal = direction_from("--normal", values.text("--normal"));
  if (values.given("--origin")) plane.origin = vector_from("--origin", values.text("--origin"));
  if (up.given("--up")) plane.up = direction_from("--up", up.text("--up"));
  return plane;
}

SliceRequest parse_request(const Values& values, const Values& up) {
  SliceRequest request;
  values.exclude("--normal", {"--axis", "--at"});
  if (values.given("--normal")) {
    request.plane = parse_oblique_plane(values, up);
  } else {
    const std::string because = ": has no effect without --normal, expected both";
    if (values.given("--origin")) throw UsageError("--origin " + values.text("--origin") + because);
    if (up.given("--up")) throw UsageError("--up " + up.text("--up") + because);
    request.plane = parse_axis_plane(values);
  }
  if (values.given("--bounds")) request.bounds = parse_bounds(values.text("--bounds"));
  if (values.given("--padding")) request.padding = parse_padding(values.text("--padding"));
  if (values.given("--size")) request.size = values.integer("--size", 1, kMostPixels);
  return request;
}

// One field to look at.
FieldOptions parse_slice_field(const Values& values) {
  const std::string name = values.given("--field") ? values.text("--field") : "winding";
  const std::optional<Field> field = field_from_name(name);
  if (field == Field::kSolid) refuse_solid();
  if (!field || field == Field::kDensity || field == Field::kGradient)
    invalid("--field", name, "winding, inside, sdf or label");
  FieldOptions options;
  options.fields = {*field};
  refuse_idle_rule(values, options, "inside, sdf or label");
  if (values.given("--rule")) options.rule = parse_rule(values);
  if (values.given("--tolerance")) options.tolerance = parse_tolerance(values);
  return options;
}

// --up has two meanings here, told apart by their values: how the mesh is turned, as with all commands, and which
// direction is up in the picture. The last one of either counts.
struct UpOptions {
  Values mesh;
  Values picture;
};

UpOptions split_up_options(const Values& values) {
  std::vector<std::string> mesh;
  std::vector<std::string> picture;
  for (const std::string& text : values.texts("--up")) {
    (text.find(',') == std::string::npos ? mesh : picture).push_back(text);
  }
  return {values.with("--up", mesh), values.with("--up", picture)};
}

OptionGroup mesh_group_with_both_ups() {
  OptionGroup group = mesh_group();
  const auto up = std::ranges::find(group.options, "--up", &OptionSpec::names);
  up->value += "|X,Y,Z";
  up->description += "; or what is up in the picture";
  return group;
}

void check_values_name(const std::string& name) {
  const std::string extension = std::filesystem::path(name).extension().string();
  if (extension.empty()) return;
  const std::optional<FieldFormat> format = field_format_from_name(extension.substr(1));
  if (!format || *format == FieldFormat::kNpy) return;
  throw UsageError("--values " + name + ": its extension names another format, expected npy");
}

}  // namespace

CommandSpec slice_spec() {
  OptionGroup output = output_group("png");
  output.options.push_back({"--values", "OUT.npy", "Write numbers too: float64, (height, width), row 0 at the top"});
  output.options.push_back({"--no-legend", "", "Draw the plane alone, pixel by pixel: no axes, no legend"});
  return {.name = "slice",
          .description = "Draw a picture of one cross-section",
          .operands = {meshes_operand()},
          .groups = {mesh_group_with_both_ups(),
                     {"Plane",
                      {{"--axis", "x|y|z", "Axis that is perpendicular to the plane (default: z)"},
                       {"--at", "Z|P%", "Position on the axis: a coordinate, or percent of the box (default: 50%)"},
                       {"--normal", "X,Y,Z", "Normal of any other plane; it points at the viewer"},
                       {"--origin", "X,Y,Z", "Point on that plane (default: the middle of the box)"},
                       {"--bounds", "X0,Y0,Z0,X1,Y1,Z1", "Box to show (default: the bounding box of the mesh)"},
                       {"--padding", "P|Q%|Nv",
                        "Widen the box by P or Q % of its longest side, or the picture by N pixels, on every side"},
                       {"--size", "N", "Pixels along the longer side, with axes and legend (default: 1024)"}}},
                     {"Field",
                      {{"--field", "winding|inside|sdf|label",
                        "Winding number (default), inside, signed distance, or number of the part", true},
                       parts_option(),
                       priority_option(),
                       rule_option(),
                       tolerance_option()}},
                     output,
                     run_group()},
          .examples = {"raycone slice bunny.obj -o bunny.png",
                       "raycone slice bunny.obj -o foot.png --axis y --at 10% --padding 0.02",
                       "raycone slice part.stl -o cut.png --normal 1,1,0 --origin 0,0,5 --up 0,0,1",
                       "raycone slice part.stl -o thickness.png --field sdf",
                       "raycone slice femur.stl tibia.stl -o knee.png --field label --axis y",
                       "raycone slice part.stl -o part.png --size 4096 --values part.npy"}};
}

Command parse_slice(const Values& values) {
  if (!values.given("--output")) throw UsageError("no output given, expected -o OUT.png" + help_hint("slice"));
  const UpOptions up = split_up_options(values);
  SliceCommand command;
  command.run = parse_run(values);
  command.field = parse_slice_field(values);
  refuse_idle_parts(values, command.field);
  command.mesh = parse_meshes(up.mesh, command.field);
  command.slice = parse_request(values, up.picture);
  command.output = parse_output_files(values);
  refuse_idle_depfile(values, command.output);
  check_format(values, command.output.path);
  command.framed = !values.given("--no-legend");
  command.run.options = given_options(values, option_names(slice_spec()));
  if (values.given("--values")) command.values = values.text("--values");
  if (command.values) check_values_name(*command.values);
  return command;
}

}  // namespace raycone
