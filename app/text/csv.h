// Tables as text: RFC 4180 with LF line ends.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace raycone {

using CsvRecord = std::vector<std::string>;

// `fields` joined by commas, quoted where they must be, and a line feed.
[[nodiscard]] std::string csv_line(const CsvRecord& fields);

// The records of `text`. What follows the last complete one (a writer was killed) is left out: `complete` is its
// offset.
struct CsvText {
  std::vector<CsvRecord> records;
  std::size_t complete = 0;
};
[[nodiscard]] CsvText parse_csv(std::string_view text);

}  // namespace raycone
