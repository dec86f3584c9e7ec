// Points as text: CSV, TSV and columns between blanks. Lines are parsed as they arrive, so that memory does not grow
// and somebody who sends a point and waits for its answer gets it.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "io/files/ascii.h"
#include "io/files/counted.h"
#include "io/files/file_error.h"
#include "io/files/text_scanner.h"
#include "io/points/point_readers.h"
#include "io/points/table_fields.h"
#include "io/points/table_lines.h"

namespace raycone {
namespace {

// What number_of() does not read may be meant as a number: "1D0", "0x1", "1 000", a Unicode minus.
bool starts_like_number(std::string_view field) {
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

using Columns = std::array<std::size_t, 3>;  // of x, y and z, from 0

// The columns that a header names as coordinates.
std::optional<Columns> named_columns(const std::vector<std::string_view>& names) {
  static constexpr std::array<std::array<std::string_view, 3>, 3> kNames{
      {{"x", "y", "z"}, {"X", "Y", "Z"}, {"Points:0", "Points:1", "Points:2"}}};
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

class TextPointReader : public PointReader {
 public:
  TextPointReader(std::unique_ptr<InputBuffer> input, const ReadPointsOptions& options)
      : lines_(std::move(input)), columns_are_given_(options.columns) {
    if (!options.columns) return;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int column = (*options.columns)[axis];
      if (column < 1) throw InputError("column " + std::to_string(column) + " of points, expected 1 or more");
      columns_[axis] = static_cast<std::size_t>(column) - 1;
    }
  }

  bool next(std::vector<Vec3>& batch, std::size_t max) override {
    batch.clear();
    while (batch.size() < max && (batch.empty() || !lines_.would_wait())) {
      const auto line = lines_.next();
      if (!line) break;
      const bool is_first = !std::exchange(started_, true);
      if (is_first && take_header(*line)) continue;
      batch.push_back(parse(*line));
    }
    return !batch.empty();
  }

  [[nodiscard]] bool would_block() override { return lines_.would_wait(); }
  [[nodiscard]] bool has_columns() const override { return true; }
  [[nodiscard]] std::optional<std::uint64_t> size() const override { return std::nullopt; }

 private:
  // Whether the first line is a header, which it is if no coordinate in it is a number, or looks like one, and one of
  // them is a name. Takes the columns from it.
  bool take_header(std::string_view line) {
    if (line.find('\0') != std::string_view::npos) lines_.fail("the input is binary, expected text");
    std::vector<std::string_view> names;
    TableFields fields(line, delimiter_of(line));
    while (const auto field = fields.next()) names.push_back(*field);
    for (const std::size_t column : columns_) {
      if (column < names.size() && number_of(names[column])) return false;
    }
    const std::size_t last = *std::max_element(columns_.begin(), columns_.end());
    if (last >= names.size() && std::any_of(names.begin(), names.end(), number_of)) return false;
    const std::optional<Columns> named = named_columns(names);
    if (!named && !has_names(names)) return false;
    if (named && !columns_are_given_) columns_ = *named;
    return true;
  }

  [[nodiscard]] bool has_names(const std::vector<std::string_view>& fields) const {
    bool found = false;
    for (const std::size_t column : columns_) {
      if (column >= fields.size()) continue;
      if (starts_like_number(fields[column])) return false;
      found = found || has_letter(fields[column]);
    }
    return found || std::none_of(columns_.begin(), columns_.end(), [&](std::size_t c) { return c < fields.size(); });
  }

  Vec3 parse(std::string_view line) {
    if (!delimiter_) delimiter_ = delimiter_of(line);
    TableFields fields(line, *delimiter_);
    const std::size_t last = *std::max_element(columns_.begin(), columns_.end());
    Vec3 point;
    for (std::size_t column = 0; column <= last; ++column) {
      const auto field = fields.next();
      if (!field) fail_short(line, column, last);
      for (int axis = 0; axis < 3; ++axis) {
        if (columns_[static_cast<std::size_t>(axis)] == column) point[axis] = coordinate(*field, column);
      }
    }
    return point;
  }

  [[nodiscard]] double coordinate(std::string_view field, std::size_t column) const {
    const auto number = number_of(field);
    if (number && std::isfinite(*number)) return *number;
    lines_.fail("column " + std::to_string(column + 1) + " is " +
                (field.empty() ? "empty" : "'" + excerpt(field) + "'") + ", expected a finite number");
  }

  [[noreturn]] void fail_short(std::string_view line, std::size_t found, std::size_t last) const {
    lines_.fail("found '" + excerpt(line) + "' with " + counted(found, "column") + ", expected at least " +
                std::to_string(last + 1));
  }

  TableLines lines_;
  Columns columns_{0, 1, 2};
  bool columns_are_given_;
  bool started_ = false;
  std::optional<char> delimiter_;  // of the data, known from their first line on
};

}  // namespace

std::unique_ptr<PointReader> read_text_points(std::unique_ptr<InputBuffer> input, const ReadPointsOptions& options) {
  return std::make_unique<TextPointReader>(std::move(input), options);
}

}  // namespace raycone
