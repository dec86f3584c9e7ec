// A job of a batch: one mesh evaluated, as by the single command, and what became of it.
#pragma once

#include "app/batch/job_result.h"
#include "app/options/batch_command.h"

namespace raycone {

// Within the limits of the command; a failure is in the result. The peak of memory of this process counts anew.
[[nodiscard]] JobResult perform_job(const MeshCommand& command);

}  // namespace raycone
