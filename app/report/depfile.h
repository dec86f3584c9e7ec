// What Make is told about a run.
#pragma once

#include <string>
#include <vector>

namespace raycone {

// A rule without commands: `output` depends on `inputs`. Standard input and output are left out. Throws OutputError for
// a name that Make cannot read: with a line feed, ';', '|' or '=', or '*', '?' or '[', which it takes for a pattern;
// with '~' at its beginning or a backslash at its end; and for an output with '%', whose rule would be one for
// patterns.
[[nodiscard]] std::string depfile_text(const std::string& output, const std::vector<std::string>& inputs);

}  // namespace raycone
