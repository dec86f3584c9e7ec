#include "app/command_line/info_options.h"

#include "app/command_line/common_options.h"

namespace raycone {

CommandSpec info_spec() {
  return {.name = "info",
          .description = "Describe a mesh and estimate the cost of evaluating it",
          .operands = {mesh_operand()},
          .groups = {mesh_group(), {"Output", {{"--json", "", "Print JSON"}}}, run_group()},
          .examples = {"raycone info bunny.obj", "raycone info bunny.obj --json | jq .exterior_edges",
                       "raycone info model.glb --up y-to-z --weld 1e-6"},
          .later = {{"--normalize"}, {}}};
}

Command parse_info(const Values& values) {
  return InfoCommand{parse_mesh(values), parse_run(values), values.given("--json")};
}

}  // namespace raycone
