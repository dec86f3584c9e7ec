#pragma once

#include <string>

#include "app/options/batch_command.h"

namespace raycone {

// "3/8", or "slurm": the task of the array job that this process runs in, by SLURM_ARRAY_TASK_ID, _MIN, _MAX and
// _STEP. Throws UsageError, also for an array with gaps (_COUNT tells), where the parts would not add up to the whole.
[[nodiscard]] Shard parse_shard(const std::string& text);

}  // namespace raycone
