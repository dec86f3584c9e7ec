#include "app/command_line/command_spec.h"

#include "app/text/parse_value.h"

namespace raycone {

std::vector<std::string> names_of(const OptionSpec& option) {
  const std::vector<std::string_view> names = items_of(option.names);
  return {names.begin(), names.end()};
}

OptionNames option_names(const CommandSpec& spec) {
  OptionNames names;
  for (const OptionGroup& group : spec.groups) {
    for (const OptionSpec& option : group.options) {
      for (const std::string& name : names_of(option)) {
        (option.value.empty() ? names.flags : names.with_value).insert(name);
      }
    }
  }
  return names;
}

bool contains(const OptionNames& names, const std::string& name) {
  return names.with_value.contains(name) || names.flags.contains(name);
}

}  // namespace raycone
