#include "app/command_line/info_options.h"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <utility>

#include "app/command_line/common_options.h"
#include "app/process/usage_error.h"
#include "app/text/parse_value.h"

namespace raycone {
namespace {

constexpr std::pair<std::string_view, Requirement> kRequirements[] = {
    {"closed", Requirement::kClosed},     {"oriented", Requirement::kOriented},
    {"outward", Requirement::kOutward},   {"manifold", Requirement::kManifold},
    {"embedded", Requirement::kEmbedded}, {"no-duplicates", Requirement::kNoDuplicates}};
constexpr const char* kListed = "a list of closed, oriented, outward, manifold, embedded and no-duplicates, each once";

std::vector<Requirement> parse_requirements(const std::string& text) {
  std::vector<Requirement> required;
  for (const std::string_view word : items_of(text)) {
    const auto known = std::ranges::find(kRequirements, word, [](const auto& one) { return one.first; });
    if (known == std::end(kRequirements) || std::ranges::count(required, known->second) > 0) {
      invalid("--require", text, kListed);
    }
    required.push_back(known->second);
  }
  return required;
}

std::vector<MeshOptions> parse_meshes(const Values& values) {
  const std::vector<std::string> paths = values.texts("MESH");
  const MeshOptions first = parse_mesh(values.with("MESH", {paths.front()}));
  std::vector<MeshOptions> meshes(paths.size(), first);
  for (std::size_t n = 1; n < paths.size(); ++n) {
    if (paths[n].empty()) throw UsageError("MESH: expected a file, not an empty name");
    meshes[n].path = paths[n];
  }
  if (std::ranges::count(meshes, "-", &MeshOptions::path) > 1) {
    throw UsageError("-: standard input can be read once, expected one -");
  }
  return meshes;
}

InfoFormat parse_info_format(const Values& values) {
  values.exclude("--json", {"--csv"});
  return values.given("--json") ? InfoFormat::kJson : values.given("--csv") ? InfoFormat::kCsv : InfoFormat::kText;
}

// The first of them that was given.
std::string option_for_meshes(const Values& values) {
  const OptionGroup group = mesh_group();
  for (const OptionSpec& option : group.options) {
    if (values.given(option.names)) return option.names;
  }
  for (const char* name : {"--csv", "--intersections", "--require", "--mark"}) {
    if (values.given(name)) return name;
  }
  return "";
}

}  // namespace

CommandSpec info_spec() {
  OperandSpec meshes = mesh_operand();
  meshes.count = OperandCount::kMany;
  return {.name = "info",
          .description = "Describe meshes, check them, estimate the cost of evaluating them; describe volumes",
          .operands = {meshes},
          .groups = {mesh_group(),
                     {"Output",
                      {{"--json", "", "Print JSON; of several meshes an array"},
                       {"--csv", "", "Print a table with one row a mesh"},
                       {"--intersections", "", "Count pairs of faces that intersect"},
                       {"--require", "closed|oriented|outward|manifold|embedded|no-duplicates[,...]",
                        "Exit with 2 unless all of these hold for all meshes"},
                       {"--mark", "FILE.ply", "Write the mesh with intersecting faces and bad edges in colour"},
                       {"--no-clobber", "", "Never replace an existing file (--mark)"}}},
                     run_group()},
          .examples = {"raycone info bunny.obj", "raycone info bunny.obj --json | jq .exterior_edges",
                       "raycone info *.stl --csv > meshes.csv", "raycone info bunny.vdb",
                       "raycone info part.stl --require closed,outward,embedded --mark flaws.ply"}};
}

Command parse_info(const Values& values) {
  InfoCommand command;
  command.meshes = parse_meshes(values);
  command.run = parse_run(values);
  command.for_meshes = option_for_meshes(values);
  command.format = parse_info_format(values);
  if (values.given("--require")) command.required = parse_requirements(values.text("--require"));
  command.intersections = values.given("--intersections");
  command.existing = parse_existing(values);
  if (values.given("--mark")) command.mark = values.text("--mark");
  if (command.mark && *command.mark != "-" && !has_extension(*command.mark, "ply")) {
    throw UsageError("--mark " + *command.mark + ": expected a name that ends in .ply");
  }
  if (command.mark && command.meshes.size() > 1) throw UsageError("--mark " + *command.mark + ": expected one mesh");
  if (values.given("--no-clobber") && !command.mark) {
    throw UsageError("--no-clobber: expected --mark, no other file is written");
  }
  return command;
}

}  // namespace raycone
