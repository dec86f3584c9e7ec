#include "app/command_line/given_options.h"

#include <filesystem>
#include <set>
#include <utility>

namespace raycone {

std::vector<std::string> given_options(const Values& values, const OptionNames& known) {
  static const std::set<std::string> without_effect{
      "--depfile", "--engine", "--format", "--memory-limit", "--no-clobber", "--output", "--progress", "--quiet",
      "--report",  "--simd",   "--strict", "--threads",      "--timeout",    "--values", "--verify"};
  static const std::set<std::string> defaults{"--field=winding",      "--band=3",  "--orient=keep", "--resolution=64",
                                              "--rule=threshold=0.5", "--scale=1", "--seed=1",      "--tolerance=1e-10",
                                              "--weld=exact"};
  std::vector<std::string> options;
  for (const auto& [name, given] : values.all()) {
    if (!name.starts_with("--") || without_effect.contains(name)) continue;
    const std::string value = name == "--like" ? std::filesystem::path(given.back()).filename().string() : given.back();
    std::string option = known.flags.contains(name) ? name : name + '=' + value;
    if (!defaults.contains(option)) options.push_back(std::move(option));
  }
  return options;
}

}  // namespace raycone
