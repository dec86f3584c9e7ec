// What a worker answers about one mesh of a batch; what it is asked is a MeshCommand (command_message.h).
#pragma once

#include <string>
#include <vector>

#include "app/batch/file_stamp.h"
#include "app/batch/result_row.h"
#include "app/process/message.h"

namespace raycone {

struct JobResult {
  ResultRow row;                        // its `mesh` and `output` are left empty
  FileStamp stamp{};                    // of the mesh, before it was read
  bool knows_inputs = true;             // what was read: else neither hashes nor stamp count
  std::vector<StampedFile> buffers{};   // that the mesh refers to, relative to its directory, by their hashes
  std::string grid{};                   // hash of the grid of --like; empty where unknown, or there is none
  std::vector<OutputStamp> written{};   // of all files that the command writes, the output first
  std::string thumbnail{};              // BMP in base64; empty where there is none
  std::vector<std::string> warnings{};  // of the row's message, one by one
};

// How JobResult::buffers name a file that `mesh` refers to, wherever both are.
[[nodiscard]] std::string relative_to_mesh(const std::string& path, const std::string& mesh);

[[nodiscard]] Message to_message(const JobResult& result);
// Throws std::runtime_error for any other message.
[[nodiscard]] JobResult result_from(const Message& message);

}  // namespace raycone
