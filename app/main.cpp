// raycone: exact winding-number fields of triangle meshes.
#include <string>
#include <vector>

#include "app/batch/worker.h"
#include "app/command_line/parse_command_line.h"
#include "app/input/grid_reader.h"
#include "app/process/exit_code.h"
#include "app/process/messages.h"
#include "app/process/signals.h"
#include "app/process/stack_limit.h"
#include "app/run_command.h"
#include "core/exact/integer_memory.h"

namespace raycone {
namespace {

// Raycone starts itself for some of its work, by commands that are not for users.
ExitCode run_words(const std::vector<std::string>& words) {
  const std::string command = words.empty() ? "" : words.front();
  if (command == kWorkerCommand) return run_worker();
  if (command == kGridReaderCommand) return run_grid_reader({words.begin() + 1, words.end()});
  return run_command(parse_command_line(words));
}

}  // namespace
}  // namespace raycone

int main(int argc, char** argv) {
  using namespace raycone;
  set_up_process();
  reserve_memory_for_integers();
  if (!ensure_stack()) return static_cast<int>(ExitCode::kLimit);
  try {
    return static_cast<int>(run_words({argv + (argc > 0 ? 1 : 0), argv + argc}));
  } catch (...) {
    return static_cast<int>(report_current_exception());
  }
}
