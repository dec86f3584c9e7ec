#include "app/input/mesh_list.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "app/process/memory_limit.h"
#include "app/process/usage_error.h"
#include "io/files/file_error.h"
#include "io/files/file_identity.h"
#include "io/files/read_file.h"
#include "io/files/text_scanner.h"

namespace raycone {
namespace {

bool is_blank_or_comment(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t");
  return first == std::string_view::npos || line[first] == '#';
}

}  // namespace

std::string read_list(const std::string& list) {
  constexpr std::uint64_t kMemoryPerByte = 64;  // what becomes of a path takes some tens of times its bytes
  return read_file(list, available_memory() / kMemoryPerByte);
}

std::vector<std::string> paths_in_list(std::string_view text, const std::string& list, PathEnd end,
                                       const std::string& hint) {
  const bool are_lines = end == PathEnd::kLineFeed;
  if (are_lines) text = without_byte_order_mark(text);
  std::vector<std::string> paths;
  for (std::size_t number = 1; !text.empty(); ++number) {
    std::string_view line = text.substr(0, text.find(are_lines ? '\n' : '\0'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (are_lines && line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty() || (are_lines && is_blank_or_comment(line))) continue;
    if (line.find('\0') != std::string_view::npos) {
      throw InputError(list + ':' + std::to_string(number) + ": holds a NUL, expected a path of text" + hint);
    }
    paths.emplace_back(line);
  }
  return paths;
}

MeshOptions with_listed_meshes(const MeshOptions& mesh, const std::string& points) {
  MeshOptions expanded = mesh;
  std::vector<std::string> operands{mesh.path}, paths;
  operands.insert(operands.end(), mesh.further.begin(), mesh.further.end());
  const auto is_read = [](const std::string& operand) {
    return is_standard_input(operand.starts_with('@') ? operand.substr(1) : operand);
  };
  if (std::ranges::count_if(operands, is_read) + (is_standard_input(points) ? 1 : 0) > 1) {
    throw UsageError("standard input cannot be two of the inputs");
  }
  for (const std::string& operand : operands) {
    if (!operand.starts_with('@')) {
      paths.push_back(operand);
      continue;
    }
    const std::string list = operand.substr(1);
    expanded.lists.push_back(list);
    const std::vector<std::string> listed = paths_in_list(read_list(list), list, PathEnd::kLineFeed);
    if (listed.empty()) throw InputError(list + ": names no mesh, expected one a line");
    paths.insert(paths.end(), listed.begin(), listed.end());
  }
  if (paths.size() > 1 && mesh.parts.by != PartsBy::kFile) {
    throw UsageError(std::string("--parts ") + (mesh.parts.by == PartsBy::kGroup ? "group" : "component") +
                     ": has no effect on several meshes, expected one, or --parts file");
  }
  expanded.path = paths.front();
  expanded.further.assign(paths.begin() + 1, paths.end());
  return expanded;
}

}  // namespace raycone
