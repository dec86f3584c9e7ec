#include "io/files/input_buffer.h"

#include <algorithm>
#include <utility>

namespace raycone {
namespace {

// Bytes asked for in one go: large enough that the calls cost nothing, small enough for the second-level cache.
constexpr std::size_t kReadBlock = std::size_t{1} << 18;

}  // namespace

InputBuffer::InputBuffer(const std::string& path) : InputBuffer(path, open_source(path)) {}

InputBuffer::InputBuffer(const std::string& name, std::unique_ptr<ByteSource> source)
    : name_(name), source_(std::move(source)) {}

void InputBuffer::consume(std::size_t count) {
  begin_ += count;
  offset_ += count;
}

bool InputBuffer::fill() {
  if (at_end_) return false;
  std::move(bytes_.begin() + static_cast<std::ptrdiff_t>(begin_), bytes_.begin() + static_cast<std::ptrdiff_t>(end_),
            bytes_.begin());
  end_ -= begin_;
  begin_ = 0;
  if (bytes_.size() - end_ < kReadBlock) bytes_.resize(std::max(2 * bytes_.size(), end_ + kReadBlock));
  const std::size_t count = source_->read(bytes_.data() + end_, kReadBlock);
  end_ += count;
  at_end_ = count == 0;
  return !at_end_;
}

void InputBuffer::check_rest() {
  if (!source_->is_checked_at_end()) return;
  do {
    consume(end_ - begin_);
  } while (fill());
}

bool InputBuffer::would_wait() { return !at_end_ && !source_->is_ready(); }

std::optional<std::uint64_t> InputBuffer::file_size() const { return source_->size(); }

bool InputBuffer::is_seekable() const { return source_->is_seekable(); }

void InputBuffer::read_at(std::uint64_t offset, char* bytes, std::size_t size) const {
  source_->read_at(offset, bytes, size);
}

}  // namespace raycone
