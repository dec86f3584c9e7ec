#include "io/points/table_layout.h"

#include <algorithm>

#include "io/files/counted.h"
#include "io/files/text_scanner.h"
#include "io/points/table_fields.h"

namespace raycone {
namespace {

bool are_numbers(const std::vector<std::string_view>& fields, const Columns& columns) {
  return std::ranges::all_of(columns, [&](std::size_t c) { return c < fields.size() && number_of(fields[c]); });
}

std::size_t without_empty_ends(const std::vector<std::string_view>& fields) {
  std::size_t count = fields.size();
  while (count > 0 && fields[count - 1].empty()) --count;
  return count;
}

// Names without blanks in between are in their places even where the last fields of a row are missing.
bool fit(const std::vector<std::string_view>& names, const std::vector<std::string_view>& fields, char delimiter) {
  const std::size_t named = without_empty_ends(names), found = without_empty_ends(fields);
  return delimiter == ' ' ? named == found : found <= names.size();
}

std::string mismatch(std::size_t names, std::size_t fields) {
  return "the header has " + counted(names, "column") + ", and the first row " + std::to_string(fields) +
         ", expected as many, or --columns";
}

// Where the delimiter is this one.
TableLayout layout_with(char delimiter, const std::optional<std::string>& header,
                        const std::vector<std::string_view>& fields, const std::optional<Columns>& given) {
  if (given) return {delimiter, *given, {}};
  if (!header) return {delimiter, {0, 1, 2}, {}};
  // Headers and rows may be separated by other characters.
  for (const char of_header : {delimiter, delimiter_of(*header)}) {
    const std::vector<std::string_view> names = fields_of(*header, of_header);
    const std::optional<Columns> columns = named_columns(names);
    if (!columns) continue;
    return {delimiter, *columns, fit(names, fields, of_header) ? "" : mismatch(names.size(), fields.size())};
  }
  const std::vector<std::string_view> names = fields_of(*header, delimiter);
  const bool has_index = names.size() > 1 && names.front().empty();  // as tables of R and pandas have
  return {
      delimiter, {0, 1, 2}, has_index ? "the first column has no name, expected columns x, y and z, or --columns" : ""};
}

}  // namespace

std::vector<std::string_view> fields_of(std::string_view line, char delimiter) {
  std::vector<std::string_view> all;
  TableFields fields(line, delimiter);
  while (const auto field = fields.next()) all.push_back(*field);
  return all;
}

std::optional<Columns> named_columns(const std::vector<std::string_view>& names) {
  static constexpr std::array<std::array<std::string_view, 3>, 4> kNames{
      {{"x", "y", "z"}, {"X", "Y", "Z"}, {"Points:0", "Points:1", "Points:2"}, {"Points_0", "Points_1", "Points_2"}}};
  for (const auto& wanted : kNames) {
    Columns columns{};
    std::size_t found = 0;
    for (; found < 3; ++found) {
      const auto name = std::find(names.begin(), names.end(), wanted[found]);
      if (name == names.end()) break;
      columns[found] = static_cast<std::size_t>(name - names.begin());
    }
    if (found == 3) return columns;
  }
  return std::nullopt;
}

TableLayout layout_of(const std::optional<std::string>& header, std::string_view line,
                      const std::optional<Columns>& given) {
  const char usual = delimiter_of(line);
  for (const char delimiter : {'\t', ';', ','}) {
    if (usual == ' ' || line.find(delimiter) == std::string_view::npos) continue;
    const std::vector<std::string_view> fields = fields_of(line, delimiter);
    TableLayout layout = layout_with(delimiter, header, fields, given);
    if (are_numbers(fields, layout.columns)) return layout;
  }
  // With none of them: what is no number is told by the header's, as a decimal comma between semicolons.
  const bool as_header = header && line.find(delimiter_of(*header)) != std::string_view::npos;
  const char delimiter = as_header ? delimiter_of(*header) : usual;
  return layout_with(delimiter, header, fields_of(line, delimiter), given);
}

}  // namespace raycone
