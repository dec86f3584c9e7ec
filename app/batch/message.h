// What supervisor and workers tell each other: lists of strings, framed by their lengths.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace raycone {

using Message = std::vector<std::string>;

[[nodiscard]] std::string to_frame(const Message& message);

// Puts messages together from bytes as they arrive.
class MessageReader {
 public:
  void add(std::string_view bytes) { bytes_ += bytes; }
  // The next complete message, if there is one. Throws std::runtime_error for bytes that are no frame.
  [[nodiscard]] std::optional<Message> next();

 private:
  std::string bytes_;
};

}  // namespace raycone
