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
#include "io/points/table_layout.h"
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

// What programs write for a value that is missing.
bool stands_for_nothing(std::string_view field) {
  constexpr std::array<std::string_view, 5> kWords{"NA", "N/A", "null", "NULL", "None"};
  return std::ranges::find(kWords, field) != kWords.end();
}

class TextPointReader : public PointReader {
 public:
  TextPointReader(std::unique_ptr<InputBuffer> input, const ReadPointsOptions& options) : lines_(std::move(input)) {
    if (!options.columns) return;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int column = (*options.columns)[axis];
      if (column < 1) throw InputError("column " + std::to_string(column) + " of points, expected 1 or more");
      columns_[axis] = static_cast<std::size_t>(column) - 1;
    }
    given_ = columns_;
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
  // them is a name.
  bool take_header(std::string_view line) {
    if (line.find('\0') != std::string_view::npos) lines_.fail("the input is binary, expected text");
    const std::vector<std::string_view> names = fields_of(line, delimiter_of(line));
    for (const std::size_t column : columns_) {
      if (column < names.size() && number_of(names[column])) return false;
    }
    const std::size_t last = *std::max_element(columns_.begin(), columns_.end());
    if (last >= names.size() && std::any_of(names.begin(), names.end(), number_of)) return false;
    if (!named_columns(names) && !has_names(names)) return false;
    header_ = line;
    return true;
  }

  [[nodiscard]] bool has_names(const std::vector<std::string_view>& fields) const {
    bool found = false;
    for (const std::size_t column : columns_) {
      if (column >= fields.size()) continue;
      if (starts_like_number(fields[column])) return false;
      found = found || (has_letter(fields[column]) && !stands_for_nothing(fields[column]));
    }
    return found || std::none_of(columns_.begin(), columns_.end(), [&](std::size_t c) { return c < fields.size(); });
  }

  void find_layout(std::string_view line) {
    const TableLayout layout = layout_of(header_, line, given_);
    if (!layout.fault.empty()) lines_.fail(layout.fault);
    delimiter_ = layout.delimiter;
    columns_ = layout.columns;
  }

  Vec3 parse(std::string_view line) {
    if (!delimiter_) find_layout(line);
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
  std::optional<Columns> given_;
  Columns columns_{0, 1, 2};
  bool started_ = false;
  std::optional<std::string> header_;
  std::optional<char> delimiter_;  // of the data, known from their first line on
};

}  // namespace

std::unique_ptr<PointReader> read_text_points(std::unique_ptr<InputBuffer> input, const ReadPointsOptions& options) {
  return std::make_unique<TextPointReader>(std::move(input), options);
}

}  // namespace raycone
