#include "app/text/wrapped_help.h"

#include <algorithm>

namespace raycone {
namespace {

constexpr std::string_view kExample = "  raycone ";

std::size_t indentation_of(std::string_view line) {
  const std::size_t own = std::min(line.find_first_not_of(' '), line.size());
  const bool has_description = own > 0 && own < kHelpColumn && line.size() > kHelpColumn &&
                               line[kHelpColumn - 1] == ' ' && line[kHelpColumn] != ' ';
  return has_description ? kHelpColumn : own;
}

void add_wrapped(std::string_view line, std::size_t width, std::string& text) {
  const std::string indentation(indentation_of(line), ' ');
  std::string begin;  // of all lines but the first one
  while (begin.size() + line.size() > width) {
    // After what must stay in front.
    const std::size_t least = begin.empty() ? indentation.size() + 1 : 1, most = width - begin.size();
    std::size_t at = line.rfind(' ', most);
    if (at == std::string_view::npos || at < least) at = line.find(' ', most);
    if (at == std::string_view::npos) break;
    text += begin;
    text += line.substr(0, at);
    text += '\n';
    line.remove_prefix(at + 1);
    begin = indentation;
  }
  text += begin;
  text += line;
}

}  // namespace

std::string wrapped_help(std::string_view text, std::size_t width) {
  constexpr std::size_t kLeastWidth = 60;
  if (width < kLeastWidth) return std::string(text);
  std::string wrapped;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    if (line.starts_with(kExample)) {
      wrapped += line;
    } else {
      add_wrapped(line, width, wrapped);
    }
    if (end == std::string_view::npos) break;
    wrapped += '\n';
    text.remove_prefix(end + 1);
  }
  return wrapped;
}

}  // namespace raycone
