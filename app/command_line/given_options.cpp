#include "app/command_line/given_options.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "app/text/parse_value.h"

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

// "--band=3.0" is "--band=3".
bool are_same(std::string_view option, std::string_view other) {
  if (option == other) return true;
  const std::size_t value = option.rfind('=') + 1;
  if (value == 0 || option.substr(0, value) != other.substr(0, value)) return false;
  const std::optional<double> number = number_from(option.substr(value));
  return number && number == number_from(other.substr(value));
}

}  // namespace

bool is_default(const std::string& option, const OwnDefaults& own) {
  static constexpr std::array<std::string_view, 13> kDefaults{
      "--band=3", "--orient=keep", "--resolution=64", "--rule=threshold=0.5", "--scale=1",
      "--seed=1", "--at=50%",      "--weld=exact",    "--simplify=0",         "--tolerance=1e-10",
      "--axis=z", "--size=1024",   "--parts=file"};
  const auto is_same = [&](std::string_view usual) { return are_same(option, usual); };
  return is_same(own.field) || is_same(own.dtype) || std::ranges::any_of(kDefaults, is_same);
}

std::string like_without_directory(const std::string& value) {
  return std::filesystem::path(value).filename().string();
}

std::vector<std::string> given_options(const Values& values, const OptionNames& known, const OwnDefaults& own) {
  static const std::set<std::string> without_effect{
      "--depfile", "--engine", "--format", "--memory-limit", "--no-clobber", "--output", "--progress", "--quiet",
      "--report",  "--simd",   "--strict", "--threads",      "--timeout",    "--values", "--verify"};
  std::vector<std::string> options;
  for (const auto& [name, given] : values.all()) {
    if (!name.starts_with("--") || without_effect.contains(name)) continue;
    for (const std::string& text : values_that_count(name, given)) {
      const std::string value = name == "--like" ? like_without_directory(text) : text;
      std::string option = known.flags.contains(name) ? name : name + '=' + value;
      if (!is_default(option, own)) options.push_back(std::move(option));
    }
  }
  return options;
}

}  // namespace raycone
