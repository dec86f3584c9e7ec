// The results of meshes whose workers could not answer, in the words of the user.
#pragma once

#include <cstdint>
#include <string>

#include "app/batch/job_result.h"

namespace raycone {

// `limit`: seconds.
[[nodiscard]] JobResult timed_out(const std::string& mesh, double limit);

[[nodiscard]] JobResult damaged_answer(const std::string& mesh);

// `wait_status`: as WorkerProcess::end() returns it. `memory_limit`: bytes.
[[nodiscard]] JobResult died(const std::string& mesh, int wait_status, std::uint64_t memory_limit);

}  // namespace raycone
