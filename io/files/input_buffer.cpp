#include "io/files/input_buffer.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "io/files/file_error.h"
#include "io/files/read_file.h"

namespace raycone {
namespace {

// Bytes asked for in one go: large enough that the calls cost nothing, small enough for the second-level cache.
constexpr std::size_t kBlock = std::size_t{1} << 18;

bool is_ready(int descriptor, int timeout) {
  pollfd request{descriptor, POLLIN, 0};
  // Its end and errors are ready too: read() reports them.
  return poll(&request, 1, timeout) != 0;
}

}  // namespace

InputBuffer::InputBuffer(const std::string& path) : name_(path), descriptor_(STDIN_FILENO) {
  if (path == "-") return;
  do {
    descriptor_ = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  } while (descriptor_ < 0 && errno == EINTR);
  if (descriptor_ < 0) fail_to_read(name_, errno);
}

InputBuffer::~InputBuffer() {
  if (descriptor_ != STDIN_FILENO) close(descriptor_);
}

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
  if (bytes_.size() - end_ < kBlock) bytes_.resize(std::max(2 * bytes_.size(), end_ + kBlock));
  for (;;) {
    const ssize_t count = read(descriptor_, bytes_.data() + end_, kBlock);
    if (count >= 0) {
      end_ += static_cast<std::size_t>(count);
      at_end_ = count == 0;
      return !at_end_;
    }
    if (errno == EAGAIN) {
      is_ready(descriptor_, -1);  // somebody made standard input non-blocking
    } else if (errno != EINTR) {
      fail_to_read(name_, errno);
    }
  }
}

bool InputBuffer::would_wait() const { return !at_end_ && !is_ready(descriptor_, 0); }

std::optional<std::uint64_t> InputBuffer::file_size() const {
  struct stat status {};
  if (fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode) || status.st_size < 0) return std::nullopt;
  return static_cast<std::uint64_t>(status.st_size);
}

void InputBuffer::read_at(std::uint64_t offset, char* bytes, std::size_t size) const {
  while (size > 0) {
    const ssize_t count = pread(descriptor_, bytes, size, static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail_to_read(name_, errno);
    if (count == 0) throw InputError(name_ + ":byte " + std::to_string(offset) + ": the file was cut short meanwhile");
    bytes += count;
    offset += static_cast<std::uint64_t>(count);
    size -= static_cast<std::size_t>(count);
  }
}

}  // namespace raycone
