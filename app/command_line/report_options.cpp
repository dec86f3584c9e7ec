// raycone report: a page about a batch.
#include "app/command_line/report_options.h"

#include "app/command_line/common_options.h"
#include "app/process/usage_error.h"

namespace raycone {

namespace {

// Those that say how to evaluate are left out.
OptionGroup report_run_group() {
  OptionGroup group = run_group();
  std::erase_if(group.options,
                [](const OptionSpec& option) { return option.names == "--progress" || option.names == "--strict"; });
  return group;
}

}  // namespace

CommandSpec report_spec() {
  return {.name = "report",
          .description = "Make an HTML page about a batch",
          .operands = {{"DIR", "The --out-dir of a batch"}},
          .groups = {{"Output",
                      {{"-o,--output", "REPORT.html", "File to write; - for standard output (default: DIR/report.html)",
                        true},
                       {"--no-clobber", "", "Never replace an existing file"}}},
                     report_run_group()},
          .examples = {"raycone report fields", "raycone report fields -o fields.html"}};
}

Command parse_report(const Values& values) {
  ReportCommand command;
  command.directory = values.text("DIR");
  if (command.directory.empty()) throw UsageError("DIR: expected a directory, not an empty name");
  command.output = values.given("--output") ? values.text("--output") : command.directory + "/report.html";
  command.existing = parse_existing(values);
  command.run = parse_run(values);
  return command;
}

}  // namespace raycone
