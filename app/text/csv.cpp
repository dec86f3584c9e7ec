#include "app/text/csv.h"

#include <cstddef>
#include <optional>
#include <utility>

namespace raycone {
namespace {

bool needs_quotes(std::string_view field) { return field.find_first_of(",\"\r\n") != std::string_view::npos; }

std::string quoted(std::string_view field) {
  std::string text = "\"";
  for (const char character : field) {
    if (character == '"') text += '"';
    text += character;
  }
  return text + '"';
}

// Reads one field from `at` on, which moves to the comma or line feed behind it. Nothing where the text ends first.
std::optional<std::string> next_field(std::string_view text, std::size_t& at) {
  std::string field;
  bool in_quotes = false;
  for (; at < text.size(); ++at) {
    const char character = text[at];
    if (character == '"') {
      const bool escaped = in_quotes && at + 1 < text.size() && text[at + 1] == '"';
      if (escaped) field += text[++at];
      if (!escaped) in_quotes = !in_quotes;
    } else if (!in_quotes && (character == ',' || character == '\n')) {
      return field;
    } else if (in_quotes || character != '\r') {
      field += character;
    }
  }
  return std::nullopt;
}

}  // namespace

std::string csv_line(const CsvRecord& fields) {
  std::string line;
  for (const std::string& field : fields) {
    if (!line.empty() || &field != &fields.front()) line += ',';
    line += needs_quotes(field) ? quoted(field) : field;
  }
  return line + '\n';
}

CsvText parse_csv(std::string_view text) {
  CsvText result;
  CsvRecord record;
  std::size_t at = 0;
  while (std::optional<std::string> field = next_field(text, at)) {
    record.push_back(std::move(*field));
    const bool ends = text[at++] == '\n';
    if (!ends) continue;
    result.records.push_back(std::exchange(record, {}));
    result.complete = at;
  }
  return result;
}

}  // namespace raycone
