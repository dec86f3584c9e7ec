// Lists of meshes: @LIST on the command line.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/options/batch_command.h"
#include "app/options/mesh_options.h"

namespace raycone {

// The text of a list; "-": standard input. Throws InputError where it cannot be read, LimitError where its paths would
// take more memory than there is.
[[nodiscard]] std::string read_list(const std::string& list);

// The paths in `text`, in its order. One a line: a carriage return at its end and a byte order mark at the start of the
// text are no part of it; lines of blanks only, and comments, whose first character that is no blank is #, are none.
// With PathEnd::kNul each path ends so, and none is a comment. Throws InputError, with the name of the list and
// the line, for a line that holds a NUL: no path does. `hint` is what may help then.
[[nodiscard]] std::vector<std::string> paths_in_list(std::string_view text, const std::string& list, PathEnd end,
                                                     const std::string& hint = {});

// The meshes of a job with labels, with those of the lists among them (@LIST) in their place. `points`: what else is
// read, for "-". Throws InputError for a list that cannot be read or names none; UsageError where there are several
// meshes and parts are no files, or two of all are standard input.
[[nodiscard]] MeshOptions with_listed_meshes(const MeshOptions& mesh, const std::string& points = {});

}  // namespace raycone
