// Words, quoted for shells.
#pragma once

#include <string>

namespace raycone {

// Within single quotes.
[[nodiscard]] std::string quoted(const std::string& text);

}  // namespace raycone
