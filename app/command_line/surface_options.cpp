#include "app/command_line/surface_options.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>

#include "app/command_line/common_options.h"
#include "app/command_line/field_options.h"
#include "app/command_line/given_options.h"
#include "app/command_line/idle_options.h"
#include "app/command_line/lattice_options.h"
#include "app/process/usage_error.h"
#include "app/text/parse_value.h"

namespace raycone {
namespace {

SurfaceFormat parse_surface_format(const Values& values, const std::string& output) {
  constexpr const char* kListed = "ply, stl, obj or off";
  if (values.given("--format")) {
    const std::optional<SurfaceFormat> format = surface_format_from_name(values.text("--format"));
    if (!format) invalid("--format", values.text("--format"), kListed);
    return *format;
  }
  if (output == "-") return SurfaceFormat::kPly;
  const std::string extension = std::filesystem::path(output).extension().string();
  const auto format = surface_format_from_name(extension.substr(std::min<std::size_t>(extension.size(), 1)));
  if (format) return *format;
  throw UsageError(output + ": its extension names no format, expected " + kListed + ", or --format");
}

void parse_simplify(const Values& values, SurfaceCommand& command) {
  if (!values.given("--simplify")) return;
  const std::string text = values.text("--simplify");
  if (text == "none") {
    command.merge_planes = false;
    return;
  }
  const std::optional<double> distance = number_from(text);
  if (!distance || *distance < 0.0) invalid("--simplify", text, "none, 0 or a distance");
  command.simplify = *distance;
}

// A surface needs outside nodes around it.
void make_room(std::variant<LatticeRequest, GridReference>& lattice) {
  auto* const request = std::get_if<LatticeRequest>(&lattice);
  auto* const padding = request ? std::get_if<VoxelPadding>(&request->padding) : nullptr;
  if (!padding) return;
  if (padding->samples < 0) invalid("--padding", std::to_string(padding->samples) + "v", "1v or more");
  padding->samples = std::max<std::int64_t>(padding->samples, 1);
}

OptionGroup lattice_group_with_room() {
  OptionGroup group = lattice_group();
  const auto padding = std::ranges::find(group.options, "--padding", &OptionSpec::names);
  padding->description =
      "Widen the box by P or Q % of its longest side, or by N voxels, on every side; never by less than 1v";
  return group;
}

}  // namespace

CommandSpec surface_spec() {
  OptionGroup output = output_group("ply|stl|obj|off");
  const auto format = std::ranges::find(output.options, "--format", &OptionSpec::names);
  format->description = "Format of OUT (default: by its extension, ply for -)";
  return {.name = "surface",
          .description = "Make a closed mesh, free of self-intersections, of what is inside",
          .operands = {mesh_operand()},
          .groups = {mesh_group(),
                     lattice_group_with_room(),
                     {"Surface",
                      {rule_option(),
                       {"--thicken", "T", "Add all that is within T of the faces, so that sheets survive"},
                       {"--simplify", "0|E|none",
                        "0 (default): merge faces of one plane; E: also others, if the surface moves by E at most; "
                        "none: merge none"}}},
                     output,
                     run_group()},
          .examples = {"raycone surface scan.ply -o solid.ply                      64 samples along the longest side",
                       "raycone surface part.stl -o part-closed.stl --voxel-size 0.2",
                       "raycone surface model.obj -o model.ply --orient auto --resolution 256",
                       "raycone info part-closed.stl --require closed,oriented,outward,manifold,embedded"}};
}

Command parse_surface(const Values& values) {
  if (!values.given("--output")) throw UsageError("no output given, expected -o OUT" + help_hint("surface"));
  SurfaceCommand command;
  command.mesh = parse_mesh(values);
  command.run = parse_run(values);
  command.lattice = parse_lattice_request(values);
  make_room(command.lattice);
  if (values.given("--rule")) command.rule = parse_rule(values);
  if (values.given("--thicken")) command.thickness = values.positive("--thicken");
  parse_simplify(values, command);
  command.output = parse_output_files(values);
  command.format = parse_surface_format(values, command.output.path);
  refuse_idle_depfile(values, command.output);
  command.run.options = given_options(values, option_names(surface_spec()));
  return command;
}

}  // namespace raycone
