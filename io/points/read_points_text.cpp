// Points as text: CSV, TSV and columns between blanks. Lines are parsed as they arrive, so that memory does not grow
// and somebody who sends a point and waits for its answer gets it.
#include <algorithm>
#include <cmath>
#include <exception>
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

  // Points before a line that is none are answered first, however they arrive.
  bool next(std::vector<Vec3>& batch, std::size_t max) override {
    batch.clear();
    if (fault_) std::rethrow_exception(fault_);
    while (batch.size() < max && !fault_ && (batch.empty() || !lines_.would_wait())) {
      const auto line = lines_.next();
      if (!line) {
        check_header_alone();
        break;
      }
      const bool is_first = !std::exchange(started_, true);
      if (is_first && take_header(*line)) continue;
      take_point(*line, batch);
    }
    return !batch.empty();
  }

  [[nodiscard]] bool would_block() override { return fault_ || lines_.would_wait(); }
  [[nodiscard]] bool has_columns() const override { return true; }
  [[nodiscard]] std::vector<Warning> warnings() const override { return warnings_; }
  [[nodiscard]] std::optional<std::uint64_t> size() const override { return std::nullopt; }

 private:
  void take_point(std::string_view line, std::vector<Vec3>& batch) {
    try {
      batch.push_back(parse(line));
    } catch (const InputError&) {
      if (batch.empty()) throw;
      fault_ = std::current_exception();
    }
  }

  bool take_header(std::string_view line) {
    if (line.find('\0') != std::string_view::npos) lines_.fail("the input is binary, expected text");
    if (line.substr(0, line.find_last_not_of(" \t") + 1) == "ply") {
      lines_.fail("found 'ply', expected text; PLY is read from files by their names");
    }
    if (!is_header(line, given_)) return false;
    header_ = line;
    header_number_ = lines_.number();
    return true;
  }

  // A header without rows is a table of no points, unless it is hardly one.
  void check_header_alone() const {
    if (!header_ || delimiter_ || has_fields_for(*header_, columns_)) return;
    lines_.fail(header_number_, "found '" + excerpt(*header_) + "', expected a point, or names of columns");
  }

  void find_layout(std::string_view line) {
    const TableLayout layout = layout_of(header_, line, given_);
    if (!layout.fault.empty()) lines_.fail(layout.fault);
    if (!layout.doubt.empty()) warnings_.push_back({"columns", layout.doubt});
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
      check_quotes(fields);
      if (!field) fail_short(line, column, last);
      for (int axis = 0; axis < 3; ++axis) {
        if (columns_[static_cast<std::size_t>(axis)] == column) point[axis] = coordinate(*field, column);
      }
    }
    if (line.find('"') != std::string_view::npos) {
      while (fields.next()) {
      }
      check_quotes(fields);
    }
    return point;
  }

  void check_quotes(const TableFields& fields) const {
    if (fields.is_open()) lines_.fail("a quotation mark without its end, expected it in the same line");
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
  std::uint64_t header_number_ = 0;  // of its line
  std::optional<char> delimiter_;    // of the data, known from their first line on
  std::vector<Warning> warnings_;
  std::exception_ptr fault_;  // what comes behind the last points
};

}  // namespace

std::unique_ptr<PointReader> read_text_points(std::unique_ptr<InputBuffer> input, const ReadPointsOptions& options) {
  return std::make_unique<TextPointReader>(std::move(input), options);
}

}  // namespace raycone
