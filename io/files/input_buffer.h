// Streamed reading of a file, FIFO, device or standard input, for readers that must not wait longer than necessary.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/byte_source.h"

namespace raycone {

class InputBuffer {
 public:
  // Opens `path`; "-" is standard input. Throws InputError.
  explicit InputBuffer(const std::string& path);
  // `name` is for messages.
  InputBuffer(const std::string& name, std::unique_ptr<ByteSource> source);

  // What has been read and not consumed; valid until the next fill().
  [[nodiscard]] std::string_view pending() const { return {bytes_.data() + begin_, end_ - begin_}; }
  // Removes `count` bytes, at most all, from the front of pending().
  void consume(std::size_t count);
  // Appends what can be read at once to pending(), waiting until there is something; false at the end of the input.
  // pending() grows as long as nobody consumes it: it is for the caller to stop. Throws InputError.
  bool fill();
  // Whether fill() would have to wait. May read ahead to find out, but leaves pending() as it is. Throws InputError.
  [[nodiscard]] bool would_wait();
  // Reads on to the end where only that tells whether bytes are damaged, and consumes them. Throws InputError.
  void check_rest();
  // Offset in the input of the first byte of pending().
  [[nodiscard]] std::uint64_t offset() const { return offset_; }

  // Size of a regular file, or as an archive announces it.
  [[nodiscard]] std::optional<std::uint64_t> file_size() const;
  // Whether read_at() works: for regular files, and members of archives that are not compressed.
  [[nodiscard]] bool is_seekable() const;
  // Reads exactly `size` bytes at `offset`, apart from the stream. Throws InputError.
  void read_at(std::uint64_t offset, char* bytes, std::size_t size) const;

  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  std::string name_;
  std::unique_ptr<ByteSource> source_;
  std::vector<char> bytes_;  // the pending ones are those in [begin_, end_)
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::uint64_t offset_ = 0;
  bool at_end_ = false;
};

}  // namespace raycone
