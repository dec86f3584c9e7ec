// File descriptors that close themselves, and the calls on them that signals may interrupt.
#pragma once

#include <sys/types.h>
#include <unistd.h>

#include <string>
#include <utility>

namespace raycone {

// Owns a descriptor, or none. Who must know whether close() succeeded takes it by release().
class Descriptor {
 public:
  Descriptor() = default;
  // -1, as system calls return it where they fail, is none.
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) close(number_);
  }
  Descriptor(Descriptor&& other) noexcept : number_(other.release()) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }

  // -1 where there is none.
  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] explicit operator bool() const { return number_ >= 0; }
  // The caller's to close from now on.
  [[nodiscard]] int release() { return std::exchange(number_, -1); }

 private:
  int number_ = -1;
};

// As open(2), not to be inherited by what this process executes. None where that fails: errno tells why.
[[nodiscard]] Descriptor open_file(const std::string& path, int flags, mode_t mode = 0);

// As fsync(2). Also true where the file system says that it cannot sync, as some network and user-space ones do. Where
// it is false, errno tells why.
[[nodiscard]] bool write_to_disk(const Descriptor& file);

}  // namespace raycone
