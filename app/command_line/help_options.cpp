// raycone help: what --help prints.
#include "app/command_line/help_options.h"

#include "app/command_line/parse_command_line.h"
#include "app/command_line/value_candidates.h"

namespace raycone {

CommandSpec help_spec() {
  return {.name = "help",
          .description = "Print the help of raycone or of a command",
          .operands = {{kCommandPlaceholder, "Command to be explained", OperandCount::kOptional}},
          .groups = {{"Output", {{"-h,--help", "", "Print this help"}}}},
          .examples = {"raycone help", "raycone help lattice"}};
}

Command parse_help(const Values& values) { return PrintCommand{help_text(values.text(kCommandPlaceholder))}; }

}  // namespace raycone
