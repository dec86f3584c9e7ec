// Whole files in memory, and their hash.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace raycone {

// Throws InputError about `path`, where a system call that reads it has set errno to `error`; UnreadableError unless it
// tells that there is no file.
[[noreturn]] void fail_to_read(const std::string& path, int error);

// All bytes of a regular file, FIFO or device, or of standard input for "-". Throws InputError, LimitError where the
// file is larger than `max_bytes`.
[[nodiscard]] std::string read_file(const std::string& path, std::uint64_t max_bytes = UINT64_MAX);

// The first bytes of a regular file, at most `count`; none where it is no such file, or cannot be read.
[[nodiscard]] std::string first_bytes(const std::string& path, std::size_t count);

// Whether `path` is a regular file that can be read and begins with these bytes.
[[nodiscard]] bool file_starts_with(const std::string& path, std::string_view bytes);

// SHA-256, of bytes that come one after the other.
class Sha256 {
 public:
  Sha256();
  ~Sha256();

  // Needs no memory.
  void add(std::string_view bytes);
  // Of all that was added: 64 lower-case hexadecimal digits. Begins anew.
  [[nodiscard]] std::string digest();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// As Sha256::digest().
[[nodiscard]] std::string sha256(std::string_view bytes);

// The same of a file of any size, in little memory. Throws InputError.
[[nodiscard]] std::string sha256_of_file(const std::string& path);

}  // namespace raycone
