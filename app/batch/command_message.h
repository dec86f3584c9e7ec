// What a worker is asked to do, as a message: all values of a MeshCommand, so that nothing is parsed again; or to hash
// what a mesh was read from, which may take as long or hang as well.
#pragma once

#include <cstdint>
#include <optional>

#include "app/batch/file_stamp.h"
#include "app/options/batch_command.h"
#include "app/process/message.h"

namespace raycone {

[[nodiscard]] Message to_message(const MeshCommand& command);
// Throws std::runtime_error for any other message.
[[nodiscard]] MeshCommand mesh_command_from(const Message& message);

// The hashes are wanted of the files that a command which failed has read, as they were when it was begun.
struct InputsRequest {
  MeshCommand command;
  FileStamp stamp;           // of the mesh then
  std::int64_t started = 0;  // nanoseconds since 1970
};
[[nodiscard]] Message to_message(const InputsRequest& request);
// Nothing where `message` is no such request.
[[nodiscard]] std::optional<InputsRequest> inputs_request_from(const Message& message);

}  // namespace raycone
