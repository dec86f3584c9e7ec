// Bytes as text: RFC 4648, section 4.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace raycone {

// With padding.
[[nodiscard]] std::string to_base64(std::string_view bytes);

// Padding is optional; nothing for text that is not base64.
[[nodiscard]] std::optional<std::string> from_base64(std::string_view text);

}  // namespace raycone
