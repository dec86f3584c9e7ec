// The line on a terminal that tells how far a run is.
#pragma once

#include <cstddef>
#include <string_view>

namespace raycone {

// Columns of the terminal at a descriptor; 0 where there is none, or it does not tell.
[[nodiscard]] std::size_t terminal_columns(int descriptor);

// Writes `line`, ASCII, in place of the last line on standard error; only what fits there, as a longer one would become
// two, of which the next call erases one.
void rewrite_line(std::string_view line);

// Erases that line.
void erase_line();

}  // namespace raycone
