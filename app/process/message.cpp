// Each string stands behind its length. A frame is the length of what follows, and that. Lengths are 64-bit, as in
// memory, since both ends are the same executable on the same machine.
#include "app/process/message.h"

#include <cstring>
#include <stdexcept>

#include "app/text/parse_value.h"

namespace raycone {
namespace {

using Length = std::uint64_t;

void append_length(std::string& bytes, Length length) {
  char text[sizeof length];
  std::memcpy(text, &length, sizeof length);
  bytes.append(text, sizeof text);
}

Length length_at(std::string_view bytes) {
  Length length = 0;
  if (bytes.size() < sizeof length) throw std::runtime_error("a message ends within a length");
  std::memcpy(&length, bytes.data(), sizeof length);
  return length;
}

}  // namespace

std::string to_bytes(const Message& message) {
  std::string bytes;
  for (const std::string& text : message) {
    append_length(bytes, text.size());
    bytes += text;
  }
  return bytes;
}

Message message_from(std::string_view bytes) {
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

std::string to_frame(const Message& message) {
  const std::string body = to_bytes(message);
  std::string frame;
  append_length(frame, body.size());
  return frame + body;
}

std::optional<Message> MessageReader::next() {
  // No frame of ours is near it: more means that the sender's memory is damaged.
  constexpr Length kMaxLength = Length{1} << 28;
  if (bytes_.size() < sizeof(Length)) return std::nullopt;
  const Length length = length_at(bytes_);
  if (length > kMaxLength) throw std::runtime_error("a message is too long");
  if (bytes_.size() - sizeof(Length) < length) return std::nullopt;
  Message message = message_from(std::string_view(bytes_).substr(sizeof(Length), length));
  bytes_.erase(0, sizeof(Length) + length);
  return message;
}

std::span<const std::string> MessageStrings::take(std::size_t count) {
  if (count > rest_.size()) throw std::runtime_error("a message ends within a value");
  const auto taken = rest_.first(count);
  rest_ = rest_.subspan(count);
  return taken;
}

std::int64_t MessageStrings::number() {
  if (const std::optional<std::int64_t> number = integer_from(text())) return *number;
  throw std::runtime_error("a message has no number where one is expected");
}

}  // namespace raycone
