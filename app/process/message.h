// What processes of raycone tell each other: lists of strings.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace raycone {

using Message = std::vector<std::string>;

// The only message of a file or pipe. Bytes that are none: std::runtime_error, here and below.
[[nodiscard]] std::string to_bytes(const Message& message);
[[nodiscard]] Message message_from(std::string_view bytes);

// One of several in a stream.
[[nodiscard]] std::string to_frame(const Message& message);

// Puts the messages of a stream together from bytes as they arrive.
class MessageReader {
 public:
  void add(std::string_view bytes) { bytes_ += bytes; }
  // The next complete message, if there is one. Throws std::runtime_error for bytes that are no frame.
  [[nodiscard]] std::optional<Message> next();

 private:
  std::string bytes_;
};

// The strings of a message, which must outlive this, one after the other. Throws std::runtime_error where there are no
// more, or something else than what is asked for.
class MessageStrings {
 public:
  explicit MessageStrings(std::span<const std::string> strings) : rest_(strings) {}

  // The next ones.
  std::span<const std::string> take(std::size_t count);
  std::string text() { return take(1).front(); }
  std::int64_t number();
  std::size_t count() { return static_cast<std::size_t>(number()); }
  [[nodiscard]] std::span<const std::string> rest() const { return rest_; }

 private:
  std::span<const std::string> rest_;
};

}  // namespace raycone
