// What Make is told about a run.
#pragma once

#include <string>
#include <vector>

namespace raycone {

// A rule without commands: `output` depends on `inputs`; empty where `output` is standard output. Standard input is
// left out. Throws OutputError for a name that Make cannot read: one with a control character, ';', '|' or '='; with
// '*', '?' or '[', which Make takes for a pattern; that begins with '~', or ends with a backslash or a blank; and a(b),
// a member of an archive. Likewise for an output with '%', whose rule would be one for patterns, or with '&' at its
// end.
[[nodiscard]] std::string depfile_text(const std::string& output, const std::vector<std::string>& inputs);

}  // namespace raycone
