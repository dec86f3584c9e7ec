// What a worker is asked to do, as a message: all values of a MeshCommand, so that nothing is parsed again.
#pragma once

#include "app/batch/message.h"
#include "app/options/batch_command.h"

namespace raycone {

[[nodiscard]] Message to_message(const MeshCommand& command);
// Throws std::runtime_error for any other message.
[[nodiscard]] MeshCommand mesh_command_from(const Message& message);

}  // namespace raycone
