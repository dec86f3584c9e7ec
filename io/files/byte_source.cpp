#include "io/files/byte_source.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <stdexcept>

#include "io/files/descriptor.h"
#include "io/files/file_error.h"
#include "io/files/read_file.h"

namespace raycone {
namespace {

bool is_readable(int descriptor, int timeout) {
  pollfd request{descriptor, POLLIN, 0};
  // Its end and errors are ready too: read() reports them.
  return poll(&request, 1, timeout) != 0;
}

class FileSource final : public ByteSource {
 public:
  explicit FileSource(const std::string& path) : name_(path), descriptor_(STDIN_FILENO) {
    if (path == "-") return;
    opened_ = open_file(path, O_RDONLY);
    if (!opened_) fail_to_read(name_, errno);
    descriptor_ = opened_.number();
  }

  std::size_t read(char* bytes, std::size_t size) override {
    for (;;) {
      const ssize_t count = ::read(descriptor_, bytes, size);
      if (count >= 0) return static_cast<std::size_t>(count);
      if (errno == EAGAIN) {
        is_readable(descriptor_, -1);  // somebody made standard input non-blocking
      } else if (errno != EINTR) {
        fail_to_read(name_, errno);
      }
    }
  }

  bool is_ready() override { return is_readable(descriptor_, 0); }

  std::optional<std::uint64_t> size() const override {
    struct stat status {};
    if (fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode) || status.st_size < 0) return std::nullopt;
    return static_cast<std::uint64_t>(status.st_size);
  }

  bool is_seekable() const override { return size().has_value(); }

  void read_at(std::uint64_t offset, char* bytes, std::size_t size) const override {
    while (size > 0) {
      const ssize_t count = pread(descriptor_, bytes, size, static_cast<off_t>(offset));
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) fail_to_read(name_, errno);
      if (count == 0) fail_at_byte(name_, offset, "the file was cut short meanwhile");
      bytes += count;
      offset += static_cast<std::uint64_t>(count);
      size -= static_cast<std::size_t>(count);
    }
  }

 private:
  std::string name_;
  Descriptor opened_;  // none where it is standard input, which stays open
  int descriptor_;
};

class FilePart final : public ByteSource {
 public:
  FilePart(const std::string& path, std::uint64_t offset, std::uint64_t size)
      : file_(path), offset_(offset), size_(size) {}

  std::size_t read(char* bytes, std::size_t size) override {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(size, size_ - done_));
    file_.read_at(offset_ + done_, bytes, count);
    done_ += count;
    return count;
  }
  std::optional<std::uint64_t> size() const override { return size_; }
  bool is_seekable() const override { return true; }
  void read_at(std::uint64_t offset, char* bytes, std::size_t size) const override {
    file_.read_at(offset_ + offset, bytes, size);
  }

 private:
  FileSource file_;
  std::uint64_t offset_, size_, done_ = 0;
};

class MemorySource final : public ByteSource {
 public:
  explicit MemorySource(std::string_view bytes) : bytes_(bytes), rest_(bytes) {}

  std::size_t read(char* bytes, std::size_t size) override {
    const std::size_t count = rest_.copy(bytes, size);
    rest_.remove_prefix(count);
    return count;
  }
  std::optional<std::uint64_t> size() const override { return bytes_.size(); }
  bool is_seekable() const override { return true; }
  void read_at(std::uint64_t offset, char* bytes, std::size_t size) const override {
    bytes_.substr(static_cast<std::size_t>(offset), size).copy(bytes, size);
  }

 private:
  std::string_view bytes_, rest_;
};

}  // namespace

void ByteSource::read_at(std::uint64_t, char*, std::size_t) const { throw std::logic_error("a source without places"); }

std::unique_ptr<ByteSource> open_source(const std::string& path) { return std::make_unique<FileSource>(path); }

std::unique_ptr<ByteSource> open_part(const std::string& path, std::uint64_t offset, std::uint64_t size) {
  return std::make_unique<FilePart>(path, offset, size);
}

std::unique_ptr<ByteSource> open_bytes(std::string_view bytes) { return std::make_unique<MemorySource>(bytes); }

}  // namespace raycone
