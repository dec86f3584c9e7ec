// What a mesh was read from that could not be evaluated.
#pragma once

#include "app/batch/command_message.h"
#include "app/batch/job_result.h"

namespace raycone {

// Of the inputs of a command that failed: what tells later whether they are still the same. Of what is no file, such as
// a pipe, that is the stamp alone.
[[nodiscard]] JobResult hash_inputs(const InputsRequest& request);

}  // namespace raycone
