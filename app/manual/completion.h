// Programmable completion of the command line.
#pragma once

#include <string>

namespace raycone {

[[nodiscard]] std::string bash_completion();
[[nodiscard]] std::string zsh_completion();

}  // namespace raycone
