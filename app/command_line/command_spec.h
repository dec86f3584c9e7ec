// What a command accepts, as plain data: --help, the manual page and the shells' completions are made from it, and the
// parser follows it.
#pragma once

#include <string>
#include <vector>

#include "app/command_line/arguments.h"

namespace raycone {

struct OptionSpec {
  std::string names;  // "-o,--output", the long name last: Values knows the option by it
  std::string value;  // what stands for its value in the help, see app/command_line/value_candidates.h; empty: a flag
  std::string description;  // one line
  bool once = false;        // given twice it is an error; of other options the last one counts
};

// Options under one heading; without a heading they are understood but listed nowhere.
struct OptionGroup {
  std::string heading;
  std::vector<OptionSpec> options;
};

enum class OperandCount { kOne, kOptional, kMany };  // kMany: at least one; it takes all

struct OperandSpec {
  std::string name;
  std::string description;
  OperandCount count = OperandCount::kOne;
};

struct NoteSpec {
  std::string heading;
  std::string text;  // no full stop
};

struct CommandSpec {
  std::string name;
  std::string description;  // one line
  std::vector<OperandSpec> operands;
  std::vector<OptionGroup> groups;
  std::vector<std::string> examples;  // a line each
  std::vector<NoteSpec> notes = {};   // below the examples
};

// "-o,--output" as {"-o", "--output"}.
[[nodiscard]] std::vector<std::string> names_of(const OptionSpec& option);

// All names in `spec`.
[[nodiscard]] OptionNames option_names(const CommandSpec& spec);

[[nodiscard]] bool contains(const OptionNames& names, const std::string& name);

}  // namespace raycone
