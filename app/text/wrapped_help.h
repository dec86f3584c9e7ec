// Help for narrow terminals.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace raycone {

inline constexpr std::size_t kHelpColumn = 36;  // where descriptions begin

// `text` with lines of more than `width` characters broken between words. What goes on is indented like the description
// it belongs to, or like the line. Examples, which are commands, stay whole. Below 60 characters nothing is broken.
[[nodiscard]] std::string wrapped_help(std::string_view text, std::size_t width);

}  // namespace raycone
