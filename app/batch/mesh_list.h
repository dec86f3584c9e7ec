// Lists of meshes: @LIST on the command line of `raycone batch`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace raycone {

// The paths in `text`, in its order. One a line: a carriage return at its end and a byte order mark at the start of the
// text are no part of it; lines of blanks only, and comments, whose first character that is no blank is #, are none.
// With `nul_separated` each path ends with NUL, and none is a comment. Throws InputError, with the name of the list and
// the line, for a line that holds a NUL: no path does.
[[nodiscard]] std::vector<std::string> paths_in_list(std::string_view text, const std::string& list,
                                                     bool nul_separated);

}  // namespace raycone
