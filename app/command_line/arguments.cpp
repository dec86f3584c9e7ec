// GNU conventions: --name VALUE, --name=VALUE, -nVALUE, -n VALUE.
#include "app/command_line/arguments.h"

#include <cstddef>
#include <optional>

#include "app/process/usage_error.h"

namespace raycone {
namespace {

bool is_option(const std::string& argument) { return argument.size() > 1 && argument[0] == '-'; }

// An option's name, and the value written in the same argument, if any.
struct NameAndValue {
  std::string name;
  std::optional<std::string> value;
};

NameAndValue split_option(const std::string& argument) {
  if (argument.starts_with("--")) {
    const std::size_t equals = argument.find('=');
    if (equals == std::string::npos) return {argument, std::nullopt};
    return {argument.substr(0, equals), argument.substr(equals + 1)};
  }
  if (argument.size() == 2) return {argument, std::nullopt};
  return {argument.substr(0, 2), argument.substr(argument[2] == '=' ? 3 : 2)};
}

}  // namespace

Arguments split_arguments(const std::vector<std::string>& arguments, const OptionNames& known) {
  Arguments result;
  std::vector<std::string> operands;
  bool options_ended = false;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    if (options_ended || !is_option(argument)) {
      operands.push_back(argument);
    } else if (argument == "--") {
      options_ended = true;
    } else if (auto [name, value] = split_option(argument); known.with_value.contains(name)) {
      if (!value && i + 1 < arguments.size()) value = arguments[++i];
      if (!value || value->empty()) throw UsageError(name + ": needs a value");
      result.options.push_back({name, *value});
    } else {
      if (value && known.flags.contains(name)) throw UsageError(name + ": takes no value");
      result.options.push_back({name, ""});
    }
  }
  if (!operands.empty()) {
    result.command = operands.front();
    result.operands.assign(operands.begin() + 1, operands.end());
  }
  return result;
}

}  // namespace raycone
