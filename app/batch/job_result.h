// What a worker answers about one mesh of a batch; what it is asked is a MeshCommand (command_message.h).
#pragma once

#include <string>
#include <vector>

#include "app/batch/batch_record.h"
#include "app/batch/message.h"
#include "app/batch/result_row.h"

namespace raycone {

struct JobResult {
  ResultRow row;                        // its `mesh` and `output` are left empty
  std::vector<StampedFile> companions;  // further files that were read, by their hashes
  std::string thumbnail;                // BMP in base64; empty where there is none
  std::vector<std::string> warnings;    // of the row's message, one by one
};

[[nodiscard]] Message to_message(const JobResult& result);
// Throws std::runtime_error for any other message.
[[nodiscard]] JobResult result_from(const Message& message);

}  // namespace raycone
