#include "app/batch/mesh_list.h"

#include <algorithm>
#include <cstddef>

#include "io/files/file_error.h"

namespace raycone {
namespace {

// What editors of Windows put first.
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

bool is_blank_or_comment(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t");
  return first == std::string_view::npos || line[first] == '#';
}

}  // namespace

std::vector<std::string> paths_in_list(std::string_view text, const std::string& list, bool nul_separated) {
  if (!nul_separated && text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  std::vector<std::string> paths;
  for (std::size_t number = 1; !text.empty(); ++number) {
    std::string_view line = text.substr(0, text.find(nul_separated ? '\0' : '\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (!nul_separated && line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty() || (!nul_separated && is_blank_or_comment(line))) continue;
    if (line.find('\0') != std::string_view::npos) {
      throw InputError(list + ':' + std::to_string(number) +
                       ": holds a NUL, expected a path of text; -0 reads lists whose paths end with NUL");
    }
    paths.emplace_back(line);
  }
  return paths;
}

}  // namespace raycone
