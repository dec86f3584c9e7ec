// The words of the command line. CLI11 checks them against the specification of the command and prints the help; values
// stay strings, as CLI11's own conversions accept infinity and let list options swallow operands.
#include "app/command_line/parse_command_line.h"

#include <unistd.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <initializer_list>
#include <map>
#include <string_view>
#include <variant>

#include "app/command_line/arguments.h"
#include "app/command_line/command_spec.h"
#include "app/command_line/commands.h"
#include "app/command_line/suggestion.h"
#include "app/command_line/values.h"
#include "app/process/terminal.h"
#include "app/process/usage_error.h"
#include "app/process/version.h"
#include "app/text/wrapped_help.h"
#include "io/files/enumerated.h"

namespace raycone {
namespace {

// --- Specifications as CLI11 wants them -----------------------------------------------------------------------------

void add_operand(CLI::App& app, const OperandSpec& spec) {
  CLI::Option* const operand = app.add_option(spec.name)->description(spec.description)->option_text(" ");
  operand->required(spec.count != OperandCount::kOptional);
  if (spec.count == OperandCount::kMany)
    operand->expected(1, CLI::detail::expected_max_vector_size)->allow_extra_args();
}

void add_option(CLI::App& app, const std::string& group, const OptionSpec& spec) {
  if (spec.value.empty()) {
    app.add_flag(spec.names)->description(spec.description)->group(group);
  } else {
    app.add_option(spec.names)->option_text(spec.value)->description(spec.description)->take_last()->group(group);
  }
}

std::string footer(const CommandSpec& spec) {
  std::string text = "Examples:";
  for (const std::string& example : spec.examples) text += "\n  " + example;
  if (!spec.notes.empty()) text += '\n';
  for (const NoteSpec& note : spec.notes) text += '\n' + note.heading + ": " + note.text;
  return text;
}

void declare(CLI::App& app, const CommandSpec& spec) {
  app.set_help_flag();  // the specification has it
  for (const OperandSpec& operand : spec.operands) add_operand(app, operand);
  for (const OptionGroup& group : spec.groups) {
    for (const OptionSpec& option : group.options) add_option(app, group.heading, option);
  }
  app.footer(footer(spec));
}

void declare_all(CLI::App& root) {
  root.require_subcommand(1);
  root.get_formatter()->column_width(kHelpColumn);
  root.get_formatter()->label("Positionals", "Operands");
  root.get_formatter()->label("SUBCOMMAND", "COMMAND");
  declare(root, program_spec());
  for (const CommandEntry& entry : commands()) {
    declare(*root.add_subcommand(entry.spec.name, entry.spec.description)->group("Commands"), entry.spec);
  }
}

// CLI11's formatter leaves two blank lines between groups and none below the description. Programs that read the help
// get a line for each option.
std::string formatted_help(const CLI::App& app, const std::string& program) {
  std::string text = app.help(program);
  for (std::size_t at = text.find("\n\n\n"); at != std::string::npos; at = text.find("\n\n\n")) text.erase(at, 1);
  return wrapped_help(text.insert(text.find("\nUsage:"), 1, '\n'), terminal_columns(STDOUT_FILENO));
}

// `arguments` in a form that CLI11 cannot take for anything else. It only counts the operands: "[a,b]" would be a list
// to it.
std::vector<std::string> unmistakable(const Arguments& arguments) {
  std::vector<std::string> result{arguments.command};
  for (const OptionArgument& option : arguments.options) {
    const bool joined_by_equals = option.name.starts_with("--") && !option.value.empty();
    result.push_back(option.name + (joined_by_equals ? "=" : "") + option.value);
  }
  result.push_back("--");
  result.insert(result.end(), arguments.operands.size(), "operand");
  return result;
}

// Its own name() is empty for options without a heading.
std::string long_name(const CLI::Option& option) {
  return option.get_lnames().empty() ? option.get_name() : "--" + option.get_lnames().back();
}

using Given = std::map<std::string, std::vector<std::string>>;

void take_operands(const CommandSpec& spec, const std::vector<std::string>& operands, Given& given) {
  auto next = operands.begin();
  for (const OperandSpec& operand : spec.operands) {
    if (next == operands.end()) return;
    const auto end = operand.count == OperandCount::kMany ? operands.end() : next + 1;
    given[operand.name].assign(next, end);
    next = end;
  }
}

Values parse_with_cli11(const CommandSpec& spec, const Arguments& arguments) {
  CLI::App root(program_spec().description, program_spec().name);
  declare_all(root);
  std::vector<std::string> reversed = unmistakable(arguments);
  std::ranges::reverse(reversed);
  try {
    root.parse(reversed);
  } catch (const CLI::ParseError& error) {
    throw UsageError(std::string(error.what()) + help_hint(arguments.command));
  }
  Given given;
  for (const CLI::Option* const option : root.get_subcommand(arguments.command)->get_options()) {
    if (option->count() > 0) given[long_name(*option)] = option->results();
  }
  take_operands(spec, arguments.operands, given);
  return Values(std::move(given));
}

// --- What CLI11 would not notice, or say less well ------------------------------------------------------------------

// Option names of all commands; each takes a value in every command that has it, or in none.
OptionNames all_option_names() {
  OptionNames all = option_names(program_spec());
  for (const CommandEntry& entry : commands()) {
    const OptionNames names = option_names(entry.spec);
    all.with_value.insert(names.with_value.begin(), names.with_value.end());
    all.flags.insert(names.flags.begin(), names.flags.end());
  }
  return all;
}

bool given(const Arguments& arguments, std::initializer_list<std::string_view> names) {
  return std::ranges::any_of(arguments.options,
                             [&](const OptionArgument& option) { return std::ranges::count(names, option.name) > 0; });
}

std::vector<std::string> command_names() {
  std::vector<std::string> names;
  for (const CommandEntry& entry : commands()) names.push_back(entry.spec.name);
  return names;
}

const CommandEntry& command_named(const std::string& name) {
  const auto found = std::ranges::find(commands(), name, [](const CommandEntry& entry) { return entry.spec.name; });
  if (found != commands().end()) return *found;
  const std::string expected = ", expected " + enumerated(command_names(), " or ") + help_hint("");
  if (name.empty()) throw UsageError("no command given" + expected);
  const std::string meant = suggestion(name, command_names());
  throw UsageError("unknown command " + name + (meant.empty() ? expected : meant));
}

// Those that the help lists.
std::vector<std::string> listed_names(const CommandSpec& spec) {
  std::vector<std::string> listed;
  for (const OptionGroup& group : spec.groups) {
    if (group.heading.empty()) continue;
    for (const OptionSpec& option : group.options) listed.push_back(names_of(option).back());
  }
  return listed;
}

// `names`: those that it may be meant to be.
[[noreturn]] void refuse_unknown(const std::string& option, const std::vector<std::string>& names,
                                 const std::string& command) {
  const bool is_output_of_batch = command == "batch" && (option == "-o" || option == "--output");
  const std::string meant = is_output_of_batch ? "; did you mean --out-dir?" : suggestion(option, names);
  throw UsageError("unknown option " + option + (meant.empty() ? help_hint(command) : meant));
}

// An option that no command has may have a value, which would be taken for the command.
void check_options_before_command(const Arguments& arguments, const OptionNames& of_all_commands) {
  if (std::ranges::count(command_names(), arguments.command) > 0) return;
  std::vector<std::string> listed = listed_names(program_spec());
  for (const CommandEntry& entry : commands()) {
    const std::vector<std::string> names = listed_names(entry.spec);
    listed.insert(listed.end(), names.begin(), names.end());
  }
  for (const OptionArgument& option : arguments.options) {
    if (!contains(of_all_commands, option.name)) refuse_unknown(option.name, listed, "");
  }
}

void refuse_repetition(const OptionSpec& option, const Arguments& arguments) {
  const std::vector<std::string> names = names_of(option);
  const auto is_option = [&](const OptionArgument& argument) { return std::ranges::count(names, argument.name) > 0; };
  if (std::ranges::count_if(arguments.options, is_option) < 2) return;
  throw UsageError(names.back() + ": given twice, expected once");
}

// CLI11 would ask for missing operands before it names a wrong option.
void check_options(const CommandSpec& spec, const Arguments& arguments) {
  const OptionNames known = option_names(spec);
  for (const OptionArgument& option : arguments.options) {
    if (!contains(known, option.name)) refuse_unknown(option.name, listed_names(spec), arguments.command);
  }
  for (const OptionGroup& group : spec.groups) {
    for (const OptionSpec& option : group.options) {
      if (option.once) refuse_repetition(option, arguments);
    }
  }
}

// CLI11 would list its own end-of-options mark among them.
void check_operand_count(const CommandSpec& spec, const Arguments& arguments) {
  const std::size_t most = spec.operands.size();
  const bool many = std::ranges::any_of(
      spec.operands, [](const OperandSpec& operand) { return operand.count == OperandCount::kMany; });
  if (arguments.operands.size() <= most || many) return;
  throw UsageError("unexpected operand " + arguments.operands[most] + help_hint(arguments.command));
}

std::string version_text() { return std::string("raycone ") + kVersion + " (" + kCommit + ")\n" + kLibraries + "\n"; }

// What the values of `spec`'s options make of it, with a suggestion where one of them is misspelt.
Command parse_values(const CommandEntry& entry, const Values& values) {
  try {
    return entry.parse(values);
  } catch (const InvalidValue& error) {
    for (const OptionGroup& group : entry.spec.groups) {
      for (const OptionSpec& option : group.options) {
        if (names_of(option).back() != error.name()) continue;
        throw UsageError(error.what() + value_suggestion(error.text(), option.value));
      }
    }
    throw;
  }
}

}  // namespace

std::string help_text(const std::string& command) {
  CLI::App root(program_spec().description, program_spec().name);
  declare_all(root);
  if (command.empty()) return formatted_help(root, "");
  return formatted_help(*root.get_subcommand(command_named(command).spec.name), program_spec().name);
}

namespace {

// For reports. PrintCommand runs nothing.
template <typename AnyCommand>
void keep_words(AnyCommand& command, const std::vector<std::string>& words) {
  if constexpr (requires { command.run.words; }) command.run.words = words;
}

}  // namespace

Command parse_command_line(const std::vector<std::string>& words) {
  const OptionNames all_names = all_option_names();
  const Arguments arguments = split_arguments(words, all_names);
  if (given(arguments, {"-V", "--version"})) return PrintCommand{version_text()};
  const bool help = given(arguments, {"-h", "--help"});
  if (help && arguments.command.empty()) return PrintCommand{help_text("")};
  if (arguments.command.empty()) check_options(program_spec(), arguments);
  check_options_before_command(arguments, all_names);
  const CommandEntry& entry = command_named(arguments.command);
  if (help) return PrintCommand{help_text(arguments.command)};
  check_options(entry.spec, arguments);
  check_operand_count(entry.spec, arguments);
  Command command = parse_values(entry, parse_with_cli11(entry.spec, arguments));
  std::visit([&words](auto& one) { keep_words(one, words); }, command);
  return command;
}

}  // namespace raycone
