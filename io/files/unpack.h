// Bytes that gzip (RFC 1952) or Zstandard (RFC 8878) packed, told by their first ones.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "io/files/byte_source.h"

namespace raycone {

// Whether `bytes` begin as a gzip or Zstandard file.
[[nodiscard]] bool is_packed(std::string_view bytes);

// What is packed in `packed`, else `packed` itself; told when the first byte is asked for. Files may be several packed
// ones, one behind the other. Damaged ones are an InputError about `name`.
[[nodiscard]] std::unique_ptr<ByteSource> unpacked(std::unique_ptr<ByteSource> packed, const std::string& name);

// The same of bytes in memory, of which is_packed() holds. Throws InputError, and std::bad_alloc where the result does
// not fit into what memory allows.
[[nodiscard]] std::string unpacked(std::string_view packed, const std::string& name);

// What is compressed in `packed` by deflate alone (RFC 1951), as in ZIP: `size` bytes, else an InputError about `name`.
[[nodiscard]] std::unique_ptr<ByteSource> inflated(std::unique_ptr<ByteSource> packed, std::uint64_t size,
                                                   const std::string& name);

// `path` without ".gz" or ".zst" at its end, in any case.
[[nodiscard]] std::string without_packing_extension(const std::string& path);

}  // namespace raycone
