// Words and lists of them, quoted for shells.
#pragma once

#include <string>
#include <vector>

namespace raycone {

// Within single quotes.
[[nodiscard]] std::string quoted(const std::string& text);
[[nodiscard]] std::string joined(const std::vector<std::string>& words, const std::string& separator);

}  // namespace raycone
