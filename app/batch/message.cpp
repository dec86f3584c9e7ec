// A frame: the length of what follows, then each string behind its own length; lengths are 64-bit, as in memory, since
// both ends are the same executable on the same machine.
#include "app/batch/message.h"

#include <cstdint>
#include <cstring>
#include <stdexcept>

namespace raycone {
namespace {

using Length = std::uint64_t;

// No message of ours is near it: more means that a worker's memory is damaged.
constexpr Length kMaxLength = Length{1} << 28;

void append_length(std::string& bytes, Length length) {
  char text[sizeof length];
  std::memcpy(text, &length, sizeof length);
  bytes.append(text, sizeof text);
}

Length length_at(std::string_view bytes) {
  Length length = 0;
  if (bytes.size() < sizeof length) throw std::runtime_error("a message ends within a length");
  std::memcpy(&length, bytes.data(), sizeof length);
  if (length > kMaxLength) throw std::runtime_error("a message is too long");
  return length;
}

Message strings_in(std::string_view bytes) {
  Message message;
  while (!bytes.empty()) {
    const Length length = length_at(bytes);
    bytes.remove_prefix(sizeof(Length));
    if (length > bytes.size()) throw std::runtime_error("a message ends within a string");
    message.emplace_back(bytes.substr(0, length));
    bytes.remove_prefix(length);
  }
  return message;
}

}  // namespace

std::string to_frame(const Message& message) {
  std::string body;
  for (const std::string& text : message) {
    append_length(body, text.size());
    body += text;
  }
  std::string frame;
  append_length(frame, body.size());
  return frame + body;
}

std::optional<Message> MessageReader::next() {
  if (bytes_.size() < sizeof(Length)) return std::nullopt;
  const Length length = length_at(bytes_);
  if (bytes_.size() - sizeof(Length) < length) return std::nullopt;
  Message message = strings_in(std::string_view(bytes_).substr(sizeof(Length), length));
  bytes_.erase(0, sizeof(Length) + length);
  return message;
}

}  // namespace raycone
