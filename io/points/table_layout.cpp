#include "io/points/table_layout.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "io/files/ascii.h"
#include "io/files/counted.h"
#include "io/files/text_scanner.h"
#include "io/points/column_names.h"
#include "io/points/table_fields.h"

namespace raycone {
namespace {

std::vector<std::string_view> fields_of(std::string_view line, char delimiter) {
  std::vector<std::string_view> all;
  TableFields fields(line, delimiter);
  while (const auto field = fields.next()) all.push_back(*field);
  return all;
}

// What number_of() does not read may be meant as a number: "1D0", "0x1", "1 000", a Unicode minus.
bool is_like_number(std::string_view field) {
  if (number_of(field)) return true;
  for (const std::string_view sign : {"+", "-", "\u2212", "."}) {
    if (field.starts_with(sign)) field.remove_prefix(sign.size());
  }
  return !field.empty() && is_digit(field.front());
}

// Of any alphabet.
bool has_letter(std::string_view field) {
  return std::any_of(field.begin(), field.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || static_cast<unsigned char>(c) >= 0x80;
  });
}

// What programs write for a value that is missing.
bool stands_for_nothing(std::string_view field) {
  constexpr std::array<std::string_view, 5> kWords{"na", "n/a", "<na>", "null", "none"};
  return std::ranges::any_of(kWords, [&](std::string_view word) { return is_word(field, word); });
}

// Whether the fields are columns' names as far as the coordinates tell.
bool are_names(const std::vector<std::string_view>& fields, const Columns& columns) {
  bool is_short = false, are_there = false, found = false;
  for (const std::size_t column : columns) {
    if (column >= fields.size()) {
      is_short = true;
      continue;
    }
    if (is_like_number(fields[column])) return false;
    are_there = true;
    found = found || (has_letter(fields[column]) && !stands_for_nothing(fields[column]));
  }
  if (is_short && std::ranges::any_of(fields, [](std::string_view field) { return number_of(field).has_value(); })) {
    return false;
  }
  return found || !are_there;
}

bool are_numbers(const std::vector<std::string_view>& fields, const Columns& columns) {
  return std::ranges::all_of(columns, [&](std::size_t c) { return c < fields.size() && number_of(fields[c]); });
}

constexpr std::array kDelimiters{'\t', ';', ','};

// The first of these outside quotes and comments, wherever quotes begin; else a blank, for any run of blanks.
char delimiter_of(std::string_view line) {
  for (const char delimiter : kDelimiters) {
    bool quoted = false;
    char before = ' ';
    for (const char c : line) {
      if (c == '"') quoted = !quoted;
      if (!quoted && c == '#' && std::string_view(" \t,;").find(before) != std::string_view::npos) break;
      if (!quoted && c == delimiter) return delimiter;
      before = c;
    }
  }
  return ' ';
}

// All that may be between the fields of the line.
std::vector<char> delimiters_of(std::string_view line) {
  std::vector<char> found;
  for (const char delimiter : kDelimiters) {
    TableFields fields(line, delimiter);
    if (fields.next() && fields.next()) found.push_back(delimiter);
  }
  if (found.empty() || delimiter_of(line) == ' ') found.push_back(' ');
  return found;
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

std::string quoted(std::string_view name) { return "'" + excerpt(name) + "'"; }

// Of three columns people mean these, unless one is named after another axis; of more, the first may be a number of the
// row, or a time.
std::string doubt_about(const std::vector<std::string_view>& names, const std::vector<std::string_view>& fields,
                        char delimiter) {
  const std::size_t found = without_empty_ends(fields);
  if (found <= 3 && !names_axis_elsewhere(names)) return "";
  const bool are_names = names.size() >= 3 && fit(names, fields, delimiter);  // and no title
  return (found > 3 ? "the first three of " + counted(found, "column") : "the columns") +
         (are_names ? ", " + quoted(names[0]) + ", " + quoted(names[1]) + " and " + quoted(names[2]) + "," : "") +
         " are taken for x, y and z, as no names tell; --columns takes others";
}

// Where the delimiter is this one.
TableLayout layout_with(char delimiter, const std::optional<std::string>& header,
                        const std::vector<std::string_view>& fields, const std::optional<Columns>& given) {
  if (given) return {.delimiter = delimiter, .columns = *given};
  if (!header) return {.delimiter = delimiter};
  // Headers and rows may be separated by other characters.
  std::vector<char> of_headers = delimiters_of(*header);
  of_headers.insert(of_headers.begin(), delimiter);
  for (const char of_header : of_headers) {
    const std::vector<std::string_view> names = fields_of(*header, of_header);
    const std::optional<Columns> columns = named_columns(names);
    if (!columns) continue;
    return {.delimiter = delimiter,
            .columns = *columns,
            .fault = fit(names, fields, of_header) ? "" : mismatch(names.size(), fields.size())};
  }
  const std::vector<std::string_view> names = fields_of(*header, delimiter);
  const bool has_index = names.size() > 1 && names.front().empty();  // as tables of R and pandas have
  return {.delimiter = delimiter,
          .fault = has_index ? "the first column has no name, expected columns x, y and z, or --columns" : "",
          .doubt = doubt_about(names, fields, delimiter)};
}

}  // namespace

bool is_header(std::string_view line, const std::optional<Columns>& given) {
  const Columns columns = given.value_or(Columns{0, 1, 2});
  for (const char delimiter : {'\t', ';', ',', ' '}) {
    if (are_numbers(fields_of(line, delimiter), columns)) return false;
  }
  const std::vector<char> delimiters = delimiters_of(line);
  for (const char delimiter : delimiters) {
    const std::vector<std::string_view> names = fields_of(line, delimiter);
    if (const auto named = named_columns(names); named && are_names(names, given.value_or(*named))) return true;
  }
  return std::ranges::all_of(delimiters, [&](char d) { return are_names(fields_of(line, d), columns); });
}

bool has_fields_for(std::string_view header, const Columns& columns) {
  const std::size_t last = *std::ranges::max_element(columns);
  return std::ranges::any_of(delimiters_of(header), [&](char d) { return fields_of(header, d).size() > last; });
}

TableLayout layout_of(const std::optional<std::string>& header, std::string_view line,
                      const std::optional<Columns>& given) {
  for (const char delimiter : kDelimiters) {
    const std::vector<std::string_view> fields = fields_of(line, delimiter);
    TableLayout layout = layout_with(delimiter, header, fields, given);
    if (are_numbers(fields, layout.columns)) return layout;
  }
  // With none of them: what is no number is told by the header's, as a decimal comma between semicolons.
  const bool as_header = header && line.find(delimiter_of(*header)) != std::string_view::npos;
  const char delimiter = delimiter_of(as_header ? *header : line);
  return layout_with(delimiter, header, fields_of(line, delimiter), given);
}

}  // namespace raycone
