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

// The paths in `text`, in its order. With PathEnd::kLineFeed there is one a line. A carriage return at the end of a
// line and a byte order mark at the start of the text are no part of a path. Blank lines are skipped, and comments:
// lines whose first character that is no blank is #. With PathEnd::kNul each path ends with a NUL, and there are no
// comments. Throws InputError, with the name of the list and the line, for a line that holds a NUL: no path does.
// `hint` is added to that message.
[[nodiscard]] std::vector<std::string> paths_in_list(std::string_view text, const std::string& list, PathEnd end,
                                                     const std::string& hint = {});

// The options of a job with labels, with each list of meshes (@LIST) replaced by its meshes. `points`: the file of
// points, which may be "-", too. Throws InputError for a list that cannot be read or names none; UsageError where there
// are several meshes and parts are no files, or where standard input is named twice.
[[nodiscard]] MeshOptions with_listed_meshes(const MeshOptions& mesh, const std::string& points = {});

}  // namespace raycone
