#include "app/command_line/value_candidates.h"

#include <algorithm>
#include <set>
#include <string_view>

#include "app/command_line/commands.h"

namespace raycone {
namespace {

bool is_small(char c) { return 'a' <= c && c <= 'z'; }
bool is_capital(char c) { return 'A' <= c && c <= 'Z'; }
bool is_in_word(char c) { return is_small(c) || ('0' <= c && c <= '9') || c == '-' || c == '.'; }

// "abs=T" as "abs=", "sdf[,...]" as "sdf".
std::string leading_word(std::string_view alternative) {
  const auto end = std::ranges::find_if_not(alternative, is_in_word);
  std::string word(alternative.begin(), end);
  if (end != alternative.end() && *end == '=') word += '=';
  return word;
}

FileCandidates leading_files(std::string_view alternative) {
  static const std::set<std::string> files{"OUT", "FILE", "GRID", "REPORT", "MESH", "POINTS"};
  const std::string name(alternative.begin(), std::ranges::find_if_not(alternative, is_capital));
  if (name == "DIR") return FileCandidates::kDirectories;
  return files.contains(name) ? FileCandidates::kAny : FileCandidates::kNone;
}

}  // namespace

ValueCandidates candidates_for(const std::string& placeholder) {
  ValueCandidates candidates;
  if (placeholder == kCommandPlaceholder) {
    for (const CommandEntry& entry : commands()) candidates.words.push_back(entry.spec.name);
  }
  candidates.list = placeholder.ends_with("[,...]");
  for (std::size_t begin = 0; begin < placeholder.size();) {
    const std::size_t end = std::min(placeholder.find('|', begin), placeholder.size());
    const std::string_view alternative = std::string_view(placeholder).substr(begin, end - begin);
    if (!alternative.empty() && is_small(alternative.front())) candidates.words.push_back(leading_word(alternative));
    if (candidates.files != FileCandidates::kAny && leading_files(alternative) != FileCandidates::kNone) {
      candidates.files = leading_files(alternative);
    }
    begin = end + 1;
  }
  return candidates;
}

}  // namespace raycone
