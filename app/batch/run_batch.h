// `raycone batch`: lattices or samples of many meshes.
#pragma once

#include "app/options/batch_command.h"
#include "app/process/exit_code.h"

namespace raycone {

// Returns kBatch where meshes failed, now or earlier; dies of the signal that interrupts it. Throws UsageError,
// InputError, OutputError, LimitError about what concerns the batch as a whole.
[[nodiscard]] ExitCode run_batch(const BatchCommand& command);

}  // namespace raycone
