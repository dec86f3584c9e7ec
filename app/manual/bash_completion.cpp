#include <map>
#include <set>
#include <vector>

#include "app/command_line/command_spec.h"
#include "app/command_line/commands.h"
#include "app/command_line/value_candidates.h"
#include "app/manual/completion.h"
#include "app/manual/shell_words.h"
#include "io/files/enumerated.h"

namespace raycone {
namespace {

// What is the same whatever the options are. `kind` is what the word under the cursor may be: words, list, files,
// directories, nothing, or operand, which may also begin an option.
constexpr const char* kBegin = R"(_raycone() {
  local word=${COMP_WORDS[COMP_CWORD]} option='' command='' ended='' i
  # Readline takes --weld=exact for three words.
  if [[ $word == = ]]; then
    word='' option=${COMP_WORDS[COMP_CWORD - 1]}
  elif [[ ${COMP_WORDS[COMP_CWORD - 1]} == = ]]; then
    option=${COMP_WORDS[COMP_CWORD - 2]}
  else
    option=${COMP_WORDS[COMP_CWORD - 1]}
    [[ $option == -* ]] || option=''
  fi
  COMPREPLY=()
  [[ -z $option || $option == -* ]] || return 0 # within a value such as abs=0.5
)";

// Which words take the next one as their value: known for all commands together.
constexpr const char* kFindCommand = R"(
  for ((i = 1; i < COMP_CWORD; i++)); do
    case ${COMP_WORDS[i]} in
      --) ended=yes option='' ;;
      @VALUED@)
        [[ ${COMP_WORDS[i + 1]} == = ]] && ((i++))
        ((i++)) ;;
      -* | =) ;;
      *) [[ -n $command ]] || command=${COMP_WORDS[i]} ;;
    esac
  done

  local kind=operand words='' options='' operands=''
)";

constexpr const char* kEnd = R"(
  if [[ $kind == operand && $word == -* && -z $ended ]]; then
    kind=words words=$options
  elif [[ $kind == operand ]]; then
    kind=$operands
  fi
  case $kind in
    words) COMPREPLY=($(compgen -W "$words" -- "$word")) ;;
    list)
      local chosen=''
      [[ $word == *,* ]] && chosen=${word%,*},
      COMPREPLY=($(compgen -P "$chosen" -W "$words" -- "${word##*,}"))
      compopt -o nospace ;;
    files) compopt -o default ;;
    directories) compopt -o dirnames ;;
  esac
  [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *= ]] && compopt -o nospace
  return 0
}
complete -F _raycone raycone
)";

std::string kind_of(const ValueCandidates& candidates) {
  if (!candidates.words.empty()) {
    return (candidates.list ? "kind=list words=" : "kind=words words=") + quoted(joined(candidates.words, " "));
  }
  switch (candidates.files) {
    case FileCandidates::kAny:
      return "kind=files";
    case FileCandidates::kDirectories:
      return "kind=directories";
    case FileCandidates::kNone:
      break;
  }
  return "kind=nothing";
}

// The cases of a command's options that take values, a line a kind of value.
std::string value_cases(const CommandSpec& spec) {
  std::vector<std::string> kinds;
  std::map<std::string, std::vector<std::string>> options;
  for (const OptionGroup& group : spec.groups) {
    for (const OptionSpec& option : group.options) {
      if (option.value.empty()) continue;
      const std::string kind = kind_of(candidates_for(option.value));
      if (!options.contains(kind)) kinds.push_back(kind);
      options[kind].push_back(joined(names_of(option), " | "));
    }
  }
  std::string text;
  for (const std::string& kind : kinds) text += "        " + joined(options[kind], " | ") + ") " + kind + " ;;\n";
  return text;
}

std::string listed_options(const CommandSpec& spec) {
  std::string text;
  for (const OptionGroup& group : spec.groups) {
    if (group.heading.empty()) continue;
    for (const OptionSpec& option : group.options) text += ' ' + joined(names_of(option), " ");
  }
  return text.substr(1);
}

// The case of a command: its options, their values, its operands.
std::string command_case(const std::string& name, const CommandSpec& spec, const std::string& operands) {
  std::string text = "    " + name + ")\n      options=" + quoted(listed_options(spec)) + '\n' + operands;
  const std::string values = value_cases(spec);
  if (!values.empty()) text += "      case $option in\n" + values + "      esac\n";
  return text + "      ;;\n";
}

std::string operands_of(const CommandSpec& spec) {
  const ValueCandidates candidates = candidates_for(spec.operands.front().name);
  if (!candidates.words.empty()) return "      operands=words words=" + quoted(joined(candidates.words, " ")) + '\n';
  return candidates.files == FileCandidates::kDirectories ? "      operands=directories\n" : "      operands=files\n";
}

std::string names_with_value() {
  std::set<std::string> names;
  for (const CommandEntry& entry : commands()) names.merge(option_names(entry.spec).with_value);
  return joined({names.begin(), names.end()}, " | ");
}

}  // namespace

std::string bash_completion() {
  std::string find_command = kFindCommand;
  const std::string mark = "@VALUED@";
  find_command.replace(find_command.find(mark), mark.size(), names_with_value());

  std::vector<std::string> names;
  for (const CommandEntry& entry : commands()) names.push_back(entry.spec.name);
  const std::string offer_commands = "      operands=words words=" + quoted(joined(names, " ")) + '\n';

  std::string text = "# bash completion for raycone\n" + std::string(kBegin) + find_command + "  case $command in\n";
  text += command_case("''", program_spec(), offer_commands);
  for (const CommandEntry& entry : commands()) {
    text += command_case(entry.spec.name, entry.spec, operands_of(entry.spec));
  }
  return text + "  esac\n" + kEnd;
}

}  // namespace raycone
