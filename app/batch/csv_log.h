// Tables in CSV that grow line by line.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/text/csv.h"
#include "io/files/descriptor.h"

namespace raycone {

// A CSV file with a fixed header that several processes may append to.
class CsvLog {
 public:
  // Whether a row is a line, but for a mesh's name. Then a quotation mark that hides rows is noticed.
  enum class Rows : std::uint8_t { kOfLines, kOfAnyText };

  // A table with the columns of an earlier version is read, too; its records have only these.
  CsvLog(std::string path, Rows rows, CsvRecord columns, std::vector<CsvRecord> former_columns)
      : path_(std::move(path)), rows_(rows), columns_(std::move(columns)), former_columns_(std::move(former_columns)) {}

  // Nothing where there is no file. Throws InputError where it is no such table, or a quotation mark in it hides rows;
  // LimitError where it would take more memory than there is.
  [[nodiscard]] std::vector<CsvRecord> read() const;
  // Whether it ends within a line, as a killed writer leaves it.
  [[nodiscard]] bool ends_within_line() const;
  // Nanoseconds since 1970; 0 where there is no file.
  [[nodiscard]] std::int64_t modified() const;
  // Throw OutputError. append() leaves the file as it was where it cannot write all of the line.
  void append(const std::string& line) const;
  void replace(const std::vector<std::string>& lines) const;  // just syncs where they are there already

 private:
  [[nodiscard]] std::string text(std::uint64_t most_bytes = UINT64_MAX) const;
  [[nodiscard]] CsvText parsed(std::string_view text) const;
  void check_rest(std::string_view rest, std::size_t line) const;
  [[nodiscard]] bool is_row(const CsvRecord& record) const;
  off_t drop_incomplete_line(const Descriptor& file) const;
  void sync() const;

  std::string path_;
  Rows rows_;
  CsvRecord columns_;
  std::vector<CsvRecord> former_columns_;
  mutable off_t complete_ = 0;  // the size that this has left behind: it ends with a complete line
};

}  // namespace raycone
