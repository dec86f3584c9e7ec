#include "io/files/file_buffer.h"

#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace raycone {
namespace {

constexpr std::size_t kBufferSize = std::size_t{1} << 20;

// One write(2). Waits where the descriptor was made non-blocking by whoever shares it (a terminal, ssh).
ssize_t write_some(int descriptor, const char* data, std::size_t size) {
  while (true) {
    const ssize_t written = write(descriptor, data, size);
    if (written >= 0) return written;
    if (errno == EAGAIN) {
      pollfd writable{descriptor, POLLOUT, 0};
      poll(&writable, 1, -1);
    } else if (errno != EINTR) {
      return -1;
    }
  }
}

}  // namespace

FileBuffer::FileBuffer(int descriptor)
    : descriptor_(descriptor), bytes_(std::make_unique_for_overwrite<char[]>(kBufferSize)) {
  setp(bytes_.get(), bytes_.get() + kBufferSize);
}

bool FileBuffer::write_through(const char* data, std::size_t size) {
  while (size > 0 && error_ == 0) {
    const ssize_t written = write_some(descriptor_, data, size);
    if (written < 0) {
      error_ = errno;
    } else {
      data += written;
      size -= static_cast<std::size_t>(written);
      start_ += written;
    }
  }
  return error_ == 0;
}

int FileBuffer::sync() {
  const bool written = write_through(pbase(), static_cast<std::size_t>(pptr() - pbase()));
  setp(bytes_.get(), bytes_.get() + kBufferSize);
  return written ? 0 : -1;
}

FileBuffer::int_type FileBuffer::overflow(int_type c) {
  if (sync() != 0) return traits_type::eof();
  return traits_type::eq_int_type(c, traits_type::eof()) ? traits_type::not_eof(c)
                                                         : sputc(traits_type::to_char_type(c));
}

std::streamsize FileBuffer::xsputn(const char* data, std::streamsize size) {
  if (size > epptr() - pptr() && sync() != 0) return 0;
  if (size > epptr() - pptr()) return write_through(data, static_cast<std::size_t>(size)) ? size : 0;
  if (error_ != 0 || size == 0) return 0;
  std::memcpy(pptr(), data, static_cast<std::size_t>(size));
  pbump(static_cast<int>(size));
  return size;
}

FileBuffer::pos_type FileBuffer::seekoff(off_type offset, std::ios_base::seekdir direction,
                                         std::ios_base::openmode which) {
  const off_type position = start_ + (pptr() - pbase());
  if (direction == std::ios_base::cur && offset == 0) return position;
  if (direction == std::ios_base::end) return pos_type(off_type(-1));  // nobody needs it
  return seekpos(direction == std::ios_base::cur ? position + offset : offset, which);
}

FileBuffer::pos_type FileBuffer::seekpos(pos_type position, std::ios_base::openmode) {
  if (error_ == 0 && position == pos_type(start_ + (pptr() - pbase()))) return position;  // it goes on by itself
  if (sync() != 0) return pos_type(off_type(-1));
  start_ = position;
  if (lseek(descriptor_, start_, SEEK_SET) < 0) error_ = errno;
  return error_ == 0 ? position : pos_type(off_type(-1));
}

}  // namespace raycone
