#include <vector>

#include "app/command_line/command_spec.h"
#include "app/command_line/commands.h"
#include "app/command_line/value_candidates.h"
#include "app/manual/completion.h"
#include "app/manual/shell_words.h"
#include "io/files/enumerated.h"

namespace raycone {
namespace {

// "abs=" goes on with a number, so no blank belongs behind it.
constexpr const char* kHelper = R"(#compdef raycone
_raycone_words() {
  local word
  for word; do
    if [[ $word == *= ]]; then compadd -S '' -- $word; else compadd -- $word; fi
  done
}
)";

// `text` with a backslash before each of `special`, which mean something to _arguments.
std::string escaped(const std::string& text, const std::string& special) {
  std::string result;
  for (const char c : text) {
    if (special.find(c) != std::string::npos || c == '\\') result += '\\';
    result += c;
  }
  return result;
}

// What _arguments is to do for a value: ":message:action".
std::string action_for(const std::string& placeholder) {
  const std::string message = ':' + escaped(placeholder, ":") + ':';
  const ValueCandidates candidates = candidates_for(placeholder);
  const std::string words = joined(candidates.words, " ");
  if (!words.empty()) return message + (candidates.list ? "_sequence compadd - " : " _raycone_words ") + words;
  switch (candidates.files) {
    case FileCandidates::kAny:
      return message + "_files";
    case FileCandidates::kDirectories:
      return message + "_directories";
    case FileCandidates::kNone:
      break;
  }
  return message + ' ';
}

// An argument of _arguments for each name: "(-o --output)-o+[description]:message:action".
std::vector<std::string> arguments_for(const OptionSpec& option) {
  const std::vector<std::string> names = names_of(option);
  const std::string exclusive = '(' + joined(names, " ") + ')';
  const bool has_value = !option.value.empty();
  const std::string rest = '[' + escaped(option.description, "[]") + ']' + (has_value ? action_for(option.value) : "");
  std::vector<std::string> arguments;
  for (const std::string& name : names) {
    std::string argument = exclusive + name;
    if (has_value) argument += name.starts_with("--") ? '=' : '+';
    arguments.push_back(quoted(argument + rest));
  }
  return arguments;
}

std::vector<std::string> arguments_for(const CommandSpec& spec) {
  std::vector<std::string> arguments;
  for (const OptionGroup& group : spec.groups) {
    if (group.heading.empty()) continue;
    for (const OptionSpec& option : group.options) {
      for (const std::string& argument : arguments_for(option)) arguments.push_back(argument);
    }
  }
  for (const OperandSpec& operand : spec.operands) {
    const std::string count = operand.count == OperandCount::kMany       ? "*"
                              : operand.count == OperandCount::kOptional ? ":"
                                                                         : "";
    arguments.push_back(quoted(count + action_for(operand.name)));
  }
  return arguments;
}

std::string call_of_arguments(const std::vector<std::string>& arguments, const std::string& indent) {
  return "_arguments -S " + joined(arguments, " \\\n" + indent) + '\n';
}

}  // namespace

std::string zsh_completion() {
  std::vector<std::string> arguments = arguments_for(program_spec());
  arguments.push_back("'1:command:->command'");
  arguments.push_back("'*::argument:->argument'");
  std::string descriptions;
  std::string cases;
  for (const CommandEntry& entry : commands()) {
    const std::string& name = entry.spec.name;
    descriptions += "        " + quoted(name + ':' + entry.spec.description) + '\n';
    cases += "        " + name + ")\n          " + call_of_arguments(arguments_for(entry.spec), "            ") +
             "          ;;\n";
  }
  return kHelper + std::string("_raycone() {\n  local curcontext=$curcontext state line\n  typeset -A opt_args\n  ") +
         "_arguments -C -S " + joined(arguments, " \\\n    ") + '\n' +
         "  case $state in\n    command)\n      local -a commands=(\n" + descriptions +
         "      )\n      _describe command commands\n      ;;\n    argument)\n      case $words[1] in\n" + cases +
         "      esac\n      ;;\n  esac\n}\n_raycone \"$@\"\n";
}

}  // namespace raycone
