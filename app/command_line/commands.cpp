#include "app/command_line/commands.h"

#include "app/command_line/batch_options.h"
#include "app/command_line/help_options.h"
#include "app/command_line/info_options.h"
#include "app/command_line/lattice_options.h"
#include "app/command_line/points_options.h"
#include "app/command_line/report_options.h"
#include "app/command_line/slice_options.h"
#include "app/command_line/surface_options.h"

namespace raycone {

const std::vector<CommandEntry>& commands() {
  static const std::vector<CommandEntry> all{{lattice_spec(), parse_lattice}, {points_spec(), parse_points},
                                             {slice_spec(), parse_slice},     {surface_spec(), parse_surface},
                                             {info_spec(), parse_info},       {batch_spec(), parse_batch},
                                             {report_spec(), parse_report},   {help_spec(), parse_help}};
  return all;
}

const CommandSpec& program_spec() {
  static const CommandSpec spec{
      .name = "raycone",
      .description = "Tell inside from outside for triangle meshes, by their exact winding number",
      .operands = {},
      .groups = {{"Options",
                  {{"-h,--help", "", "Print this help"},
                   {"-V,--version", "", "Print the versions of raycone and its libraries"}}}},
      .examples = {"raycone info bunny.obj", "raycone lattice bunny.obj -o bunny.vdb",
                   "raycone points bunny.obj points.csv > values.csv"},
      .notes = {
          {"Help of a command", "raycone help lattice, or raycone lattice --help"},
          {"Environment", "RAYCONE_THREADS: the number of threads where --threads is not given"},
          {"Exit status", "0 done, 1 usage, 2 input, 3 output, 4 limit, 5 some meshes of a batch, 6 internal error"}}};
  return spec;
}

}  // namespace raycone
