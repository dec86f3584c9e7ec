// Pieces of HTML pages.
#pragma once

#include <string>
#include <string_view>

namespace raycone {

// `text` with what means something in HTML escaped, also within attributes. Bytes that are not UTF-8, as file names may
// hold, and what plain_text() replaces become U+FFFD.
[[nodiscard]] std::string html_text(std::string_view text);

}  // namespace raycone
