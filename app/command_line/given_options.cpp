#include "app/command_line/given_options.h"

#include <filesystem>
#include <set>

namespace raycone {

std::vector<std::string> given_options(const Values& values, const OptionNames& known) {
  static const std::set<std::string> without_effect{
      "--depfile", "--engine", "--format", "--memory-limit", "--no-clobber", "--output", "--progress", "--quiet",
      "--report",  "--simd",   "--strict", "--threads",      "--timeout",    "--values", "--verify"};
  std::vector<std::string> options;
  for (const auto& [name, given] : values.all()) {
    if (!name.starts_with("--") || without_effect.contains(name)) continue;
    if (name == "--tolerance" && given.back() == "0") continue;  // the default, on some command lines stated
    const std::string value = name == "--like" ? std::filesystem::path(given.back()).filename().string() : given.back();
    options.push_back(known.flags.contains(name) ? name : name + '=' + value);
  }
  return options;
}

}  // namespace raycone
