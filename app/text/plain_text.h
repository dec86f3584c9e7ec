// Text from outside, such as file names, made fit for a terminal or a page.
#pragma once

#include <string>
#include <string_view>

namespace raycone {

// `text` with U+FFFD in place of each byte that is no UTF-8, for files whose text must be: names of files and groups
// may hold any bytes.
[[nodiscard]] std::string valid_utf8(std::string_view text);

// `text` with each byte that is no UTF-8 replaced, and each character that a terminal or page would obey in place of
// showing it: the controls of ASCII and Latin-1 (U+0000 to U+001F, U+007F to U+009F), and what breaks lines or turns
// the direction of writing (U+061C, U+200E, U+200F, U+2028 to U+202E, U+2066 to U+2069).
[[nodiscard]] std::string plain_text(std::string_view text, std::string_view replacement);

}  // namespace raycone
