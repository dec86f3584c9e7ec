// The command line split into command, options and operands before CLI11 sees it. CLI11 would take a value such as
// "-.5,-.5,-.5,.5,.5,.5" for options and lets "--quiet=5" pass; here each option is joined with its value first.
#pragma once

#include <set>
#include <string>
#include <vector>

namespace raycone {

// Names with their dashes: "--output", "-o".
struct OptionNames {
  std::set<std::string> with_value;
  std::set<std::string> flags;
};

struct OptionArgument {
  std::string name;   // with its dashes, as written
  std::string value;  // empty for a flag, and for a name that is unknown
};

struct Arguments {
  std::string command;  // the first operand; empty if there is none
  std::vector<OptionArgument> options;
  std::vector<std::string> operands;  // those behind the command
};

// `arguments` without the program's name. Options may stand anywhere, "--" ends them, "-" is an operand; a value may
// begin with a dash. Throws UsageError for a value that is missing, empty or out of place; unknown names are returned,
// as only the command tells whether they are wrong.
[[nodiscard]] Arguments split_arguments(const std::vector<std::string>& arguments, const OptionNames& known);

}  // namespace raycone
