// What Make is told about a run.
#pragma once

#include <string>
#include <vector>

namespace raycone {

// A rule without commands: `output` depends on `inputs`. Standard input and output are left out. Throws OutputError for
// a name that Make cannot read: with a control character, ';', '|' or '='; with '*', '?' or '[', which it takes for a
// pattern; that begins with '~', or ends with a backslash or a blank; a(b), a member of an archive; and for an output
// with '%', whose rule would be one for patterns, or '&' at its end.
[[nodiscard]] std::string depfile_text(const std::string& output, const std::vector<std::string>& inputs);

}  // namespace raycone
