// raycone: exact winding-number fields of triangle meshes.
#include <string>
#include <vector>

#include "app/batch/worker.h"
#include "app/exit_code.h"
#include "app/options.h"
#include "app/report.h"
#include "app/run.h"
#include "app/signals.h"

int main(int argc, char** argv) {
  using namespace raycone;
  set_up_process();
  const std::vector<std::string> words(argv + (argc > 0 ? 1 : 0), argv + argc);
  try {
    const bool is_worker = !words.empty() && words.front() == kWorkerCommand;
    const ExitCode code = is_worker ? run_worker({words.begin() + 1, words.end()}) : run(parse_command_line(words));
    return static_cast<int>(code);
  } catch (...) {
    return static_cast<int>(report_current_exception());
  }
}
