#include "app/report/depfile.h"

#include <algorithm>
#include <cstddef>
#include <set>
#include <string_view>

#include "io/files/file_error.h"

namespace raycone {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& names) {
  throw OutputError(name + ": Make cannot read " + names + ", expected none with --depfile");
}

void refuse(const std::string& name, const char* characters, const std::string& names) {
  const std::size_t found = name.find_first_of(characters);
  if (found == std::string::npos) return;
  refuse(name, names + " with " + (name[found] == '\n' ? "line feeds" : std::string("'") + name[found] + "'"));
}

// The name as Make sees it, which drops "./".
std::string_view without_dots(std::string_view name) {
  while (name.starts_with("./")) name = name.substr(std::min(name.find_first_not_of('/', 1), name.size()));
  return name;
}

// "a(b)" is b in the archive a.
bool is_member(const std::string& name) {
  const std::size_t open = name.find('(');
  return open != std::string::npos && open > 0 && name.ends_with(')');
}

// As GCC's -MD writes them: blanks and # behind a backslash, as are backslashes before these; $ doubled. Colons, too,
// which GCC leaves as they are: Make would take the line for another rule. A leading ~ is a home.
std::string escaped(const std::string& name) {
  const auto is_control = [](char c) { return c < ' ' && c >= 0 && c != '\n'; };
  if (std::ranges::any_of(name, is_control)) refuse(name, "names with control characters");
  refuse(name, "\n;|=*?[", "names");
  if (name.ends_with(' ')) refuse(name, "names that end with a blank");
  if (without_dots(name).starts_with('~')) refuse(name, "names that begin with '~'");
  if (is_member(name)) refuse(name, "names with '(' and ')' at their end");
  if (name.ends_with('\\')) refuse(name, "names that end with '\\'");
  std::string text;
  std::string backslashes;
  for (const char c : name) {
    if (c == ' ' || c == '#' || c == ':') text += backslashes + '\\';
    if (c == '$') text += '$';
    text += c;
    backslashes = c == '\\' ? backslashes + c : "";
  }
  return text;
}

}  // namespace

std::string depfile_text(const std::string& output, const std::vector<std::string>& inputs) {
  if (output == "-") return "";
  refuse(output, "%", "names of outputs");  // of a rule for patterns; Ninja does not know how Make escapes it
  if (output.ends_with('&')) refuse(output, "names of outputs that end with '&'");
  std::string text = escaped(output) + ":";
  std::set<std::string> listed{"-"};
  for (const std::string& input : inputs) {
    if (listed.insert(input).second) text += " \\\n  " + escaped(input);
  }
  return text + "\n";
}

}  // namespace raycone
