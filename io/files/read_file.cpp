// Files are read, not mapped: one that shrinks meanwhile would raise SIGBUS in a mapping.
#include "io/files/read_file.h"

#include <fcntl.h>
#include <nettle/sha2.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>
#include <vector>

#include "io/files/file_error.h"

namespace raycone {

void fail_to_read(const std::string& path, int error) {
  if (error == EISDIR) throw InputError(path + ": is a directory, expected a file");
  throw InputError(path + ": cannot be read: " + std::generic_category().message(error));
}

namespace {

// An open file, or standard input, which is not ours to close.
class Descriptor {
 public:
  explicit Descriptor(const std::string& path) : number_(STDIN_FILENO), owned_(path != "-") {
    if (!owned_) return;
    do {
      number_ = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    } while (number_ < 0 && errno == EINTR);
    if (number_ < 0) fail_to_read(path, errno);
  }
  ~Descriptor() {
    if (owned_) close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  [[nodiscard]] int number() const { return number_; }

 private:
  int number_;
  bool owned_;
};

// Size as the file system knows it; 0 for pipes and devices.
std::uint64_t expected_size(int descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode) || status.st_size < 0) return 0;
  return static_cast<std::uint64_t>(status.st_size);
}

[[noreturn]] void fail_too_large(const std::string& path, std::uint64_t max_bytes) {
  throw LimitError(path + ": larger than " + std::to_string(max_bytes) + " bytes");
}

void add(sha256_ctx& context, std::string_view bytes) {
  sha256_update(&context, bytes.size(), reinterpret_cast<const std::uint8_t*>(bytes.data()));
}

std::string digest(sha256_ctx& context) {
  std::array<std::uint8_t, SHA256_DIGEST_SIZE> bytes{};
  sha256_digest(&context, bytes.size(), bytes.data());
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

}  // namespace

std::string read_file(const std::string& path, std::uint64_t max_bytes) {
  const Descriptor descriptor(path);
  const std::uint64_t expected = expected_size(descriptor.number());
  if (expected > max_bytes) fail_too_large(path, max_bytes);

  constexpr std::size_t kSmallest = std::size_t{1} << 16;
  std::string bytes;
  // One byte more than expected, so that the end is seen without growing.
  bytes.resize(std::max<std::size_t>(kSmallest, static_cast<std::size_t>(expected) + 1));
  std::size_t size = 0;
  for (;;) {
    if (size == bytes.size()) bytes.resize(2 * size);
    const ssize_t count = read(descriptor.number(), bytes.data() + size, bytes.size() - size);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail_to_read(path, errno);
    if (count == 0) break;
    size += static_cast<std::size_t>(count);
    if (size > max_bytes) fail_too_large(path, max_bytes);
  }
  bytes.resize(size);
  return bytes;
}

std::string sha256(std::string_view bytes) {
  sha256_ctx context;
  sha256_init(&context);
  add(context, bytes);
  return digest(context);
}

std::string sha256_of_file(const std::string& path) {
  const Descriptor descriptor(path);
  sha256_ctx context;
  sha256_init(&context);
  std::vector<char> block(std::size_t{1} << 20);
  for (;;) {
    const ssize_t count = read(descriptor.number(), block.data(), block.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail_to_read(path, errno);
    if (count == 0) return digest(context);
    add(context, {block.data(), static_cast<std::size_t>(count)});
  }
}

}  // namespace raycone
