#include "app/command_line/given_options.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

namespace raycone {

namespace {

// The last one. Of --up, which tells slices both how the mesh is turned and what is up in the picture, the last of
// each.
std::vector<std::string> values_that_count(const std::string& name, const std::vector<std::string>& given) {
  if (name != "--up") return {given.back()};
  std::vector<std::string> last;
  for (const bool is_direction : {true, false}) {
    const auto found = std::find_if(given.rbegin(), given.rend(), [&](const std::string& text) {
      return (text.find(',') != std::string::npos) == is_direction;
    });
    if (found != given.rend()) last.push_back(*found);
  }
  return last;
}

}  // namespace

std::vector<std::string> given_options(const Values& values, const OptionNames& known) {
  static const std::set<std::string> without_effect{
      "--depfile", "--engine", "--format", "--memory-limit", "--no-clobber", "--output", "--progress", "--quiet",
      "--report",  "--simd",   "--strict", "--threads",      "--timeout",    "--values", "--verify"};
  static const std::set<std::string> defaults{
      "--field=winding", "--band=3", "--orient=keep",     "--resolution=64", "--rule=threshold=0.5",
      "--scale=1",       "--seed=1", "--tolerance=1e-10", "--weld=exact",    "--simplify=0",
      "--axis=z",        "--at=50%", "--size=1024"};
  std::vector<std::string> options;
  for (const auto& [name, given] : values.all()) {
    if (!name.starts_with("--") || without_effect.contains(name)) continue;
    for (const std::string& text : values_that_count(name, given)) {
      const std::string value = name == "--like" ? std::filesystem::path(text).filename().string() : text;
      std::string option = known.flags.contains(name) ? name : name + '=' + value;
      const bool is_default = defaults.contains(option) && !(name == "--field" && values.given("--sample"));
      if (!is_default) options.push_back(std::move(option));
    }
  }
  return options;
}

}  // namespace raycone
