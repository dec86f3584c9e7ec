// JSON from strangers, in bounded memory.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "io/mesh/unwinding_reserve.h"

namespace raycone {

// A text, and where it stands, for messages.
struct JsonText {
  const std::string& file;  // as given on the command line
  std::string_view json;
  std::optional<std::size_t> offset;  // of the text in a binary file; absent: the text is the file
  const char* expected;               // "a glTF document"
};

// Whether the member `key` of an object `depth` objects and arrays deep, the root 1, is wanted.
using IsWanted = bool (*)(std::size_t depth, std::string_view key);

// The members wanted. Others cost no memory, and nothing but their syntax and depth can be wrong with them. Throws
// InputError, also where an object has two members of one name, LimitError where the objects and arrays are too many.
// `reserve` covers the values that are kept; it must outlive them.
[[nodiscard]] nlohmann::json parse_bounded_json(const JsonText& text, IsWanted is_wanted, UnwindingReserve& reserve);

}  // namespace raycone
