// Where bytes are read from: a file, a part of one, or what is packed in either.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace raycone {

class ByteSource {
 public:
  virtual ~ByteSource() = default;

  // Reads at most `size` bytes, at least one, and waits until there is one; 0 at the end. Throws InputError.
  virtual std::size_t read(char* bytes, std::size_t size) = 0;
  // Whether read() would not have to wait. May read ahead to find out; throws InputError.
  [[nodiscard]] virtual bool is_ready() { return true; }
  // Whether only read() at the end tells that bytes are damaged, as of what is packed.
  [[nodiscard]] virtual bool is_checked_at_end() const { return false; }

  // Number of bytes in all, where known: of a regular file, or as an archive announces it.
  [[nodiscard]] virtual std::optional<std::uint64_t> size() const { return std::nullopt; }
  // Whether read_at() works.
  [[nodiscard]] virtual bool is_seekable() const { return false; }
  // Reads exactly `size` bytes at `offset`, apart from read(). Precondition: is_seekable(). Throws InputError.
  virtual void read_at(std::uint64_t offset, char* bytes, std::size_t size) const;
};

// The file at `path`, "-" for standard input. Throws InputError.
[[nodiscard]] std::unique_ptr<ByteSource> open_source(const std::string& path);

// `size` bytes of a regular file, from `offset` on. Throws InputError.
[[nodiscard]] std::unique_ptr<ByteSource> open_part(const std::string& path, std::uint64_t offset, std::uint64_t size);

// Bytes in memory, which must outlive it. Precondition of its read_at(): all that is asked for is there.
[[nodiscard]] std::unique_ptr<ByteSource> open_bytes(std::string_view bytes);

}  // namespace raycone
