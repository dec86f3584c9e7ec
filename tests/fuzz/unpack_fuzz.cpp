// libFuzzer target of what unpacks gzip and Zstandard files: whatever the bytes, it returns what they hold, or throws
// InputError.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "io/files/file_error.h"
#include "io/files/unpack.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kMost = 4096;  // packed well, that is a hundred megabytes
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (size > kMost || !raycone::is_packed(bytes)) return 0;
  try {
    (void)raycone::unpacked(bytes, "fuzz");
  } catch (const raycone::InputError&) {
  }
  return 0;
}
