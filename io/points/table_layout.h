// Which fields of a table are coordinates, and what is between them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "io/points/column_names.h"

namespace raycone {

struct TableLayout {
  char delimiter = ' ';
  Columns columns{0, 1, 2};
  std::string fault{};  // why the header does not fit the line; empty where it does
  std::string doubt{};  // that the header leaves open which columns are meant; empty where it does not
};

// Whether the first line of a table is a header: whichever of tab, semicolon, comma and blanks is between its fields,
// the coordinates are not numbers; whichever of those that it has, none of them looks like one, and one is a name. So
// no point is taken for a header. `given`: the columns, whatever the header names; here and below.
[[nodiscard]] bool is_header(std::string_view line, const std::optional<Columns>& given);

// Whether a header has as many fields, by one of the characters that it may have between them.
[[nodiscard]] bool has_fields_for(std::string_view header, const Columns& columns);

// Of a table whose first line of data is `line`. The delimiter is the first of tab, semicolon and comma for which the
// coordinates are numbers; where there is none of these characters, a blank. Never guessed from the locale: a decimal
// comma is an error. A header that names coordinates must have as many fields as the line: else they may be those of
// other columns, as where rows have names, or names have blanks.
[[nodiscard]] TableLayout layout_of(const std::optional<std::string>& header, std::string_view line,
                                    const std::optional<Columns>& given);

}  // namespace raycone
