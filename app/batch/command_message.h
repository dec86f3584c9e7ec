// What a worker is asked to do, as a message: all values of a MeshCommand, so that nothing is parsed again; or to hash
// a file, which may take as long or hang as well.
#pragma once

#include <optional>
#include <string>

#include "app/batch/file_stamp.h"
#include "app/batch/message.h"
#include "app/options/batch_command.h"

namespace raycone {

[[nodiscard]] Message to_message(const MeshCommand& command);
// Throws std::runtime_error for any other message.
[[nodiscard]] MeshCommand mesh_command_from(const Message& message);

// A file of which the hash is wanted, as it was when it had this stamp.
struct HashRequest {
  std::string path;
  FileStamp stamp;
};
[[nodiscard]] Message to_message(const HashRequest& request);
// Nothing where `message` is no such request.
[[nodiscard]] std::optional<HashRequest> hash_request_from(const Message& message);

}  // namespace raycone
