// raycone: exact winding-number fields of triangle meshes.
#include <string>
#include <vector>

#include "app/exit_code.h"
#include "app/options.h"
#include "app/report.h"
#include "app/run.h"
#include "app/signals.h"

int main(int argc, char** argv) {
  using namespace raycone;
  set_up_process();
  try {
    run(parse_command_line({argv + (argc > 0 ? 1 : 0), argv + argc}));
    return static_cast<int>(ExitCode::kDone);
  } catch (...) {
    return static_cast<int>(report_current_exception());
  }
}
