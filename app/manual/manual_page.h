// The manual page, in roff (macros of man(7)).
#pragma once

#include <string>

namespace raycone {

[[nodiscard]] std::string manual_page();

}  // namespace raycone
