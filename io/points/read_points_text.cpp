// Points as text: CSV, TSV and columns between blanks. Lines are parsed as they arrive, so that memory does not grow
// and somebody who sends a point and waits for its answer gets it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include "io/files/ascii.h"
#include "io/files/counted.h"
#include "io/files/file_error.h"
#include "io/files/text_scanner.h"
#include "io/points/point_readers.h"

namespace raycone {
namespace {

// No table has longer lines; a file without line ends is not a table.
constexpr std::size_t kMaxLine = std::size_t{1} << 20;
constexpr std::size_t kMaxQuoted = 40;

// --- Lines ----------------------------------------------------------------------------------------------------------

// The lines of the input that are neither blank nor comments.
class LineReader {
 public:
  explicit LineReader(std::unique_ptr<InputBuffer> input) : input_(std::move(input)) {}

  // The next line without its end; absent at the end of the input. Valid until the next call of anything here.
  std::optional<std::string_view> next() {
    while (!find_line()) {
      if (at_end_) return std::nullopt;
      at_end_ = !input_->fill();
    }
    return std::exchange(line_, std::nullopt);
  }

  // Whether next() would have to wait for input. Reads what has arrived: half a line, or a comment, is not a line.
  bool would_wait() {
    while (!find_line()) {
      if (at_end_) return false;
      if (input_->would_wait()) return true;
      at_end_ = !input_->fill();
    }
    return false;
  }

  // Throws InputError about the line that was returned last.
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(input_->name() + ":" + std::to_string(number_) + ": " + what);
  }

 private:
  // Sets line_ to the next line, unless what has been read holds none.
  bool find_line() {
    while (!line_) {
      const auto line = take_line();
      if (!line) return false;
      const std::size_t content = line->find_first_not_of(" \t");
      if (content != std::string_view::npos && (*line)[content] != '#') line_ = line;
    }
    return true;
  }

  // The next line of any kind. It ends in LF, CR LF or CR: a CR is the end at once, since nobody may answer before the
  // next byte has come.
  std::optional<std::string_view> take_line() {
    std::string_view pending = input_->pending();
    if (ended_in_cr_ && pending.starts_with('\n')) {
      input_->consume(1);
      pending.remove_prefix(1);
      ended_in_cr_ = false;
    }
    const std::size_t line_end = end_of_line(pending);
    const bool is_last = line_end == std::string_view::npos;
    if (is_last && (!at_end_ || pending.empty())) {
      scanned_ = pending.size();
      if (scanned_ > kMaxLine) {
        ++number_;
        fail("line of more than " + std::to_string(kMaxLine) + " bytes, expected a point");
      }
      return std::nullopt;
    }
    scanned_ = 0;
    input_->consume(is_last ? pending.size() : line_end + 1);
    ended_in_cr_ = !is_last && pending[line_end] == '\r';
    ++number_;
    std::string_view line = pending.substr(0, line_end);
    if (number_ == 1) {
      if (is_utf16(line)) fail("the text is UTF-16, expected UTF-8");
      if (line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
    }
    return line;
  }

  // npos where it has none yet. Byte by byte: lines are short.
  [[nodiscard]] std::size_t end_of_line(std::string_view pending) const {
    const auto found = std::find_if(pending.begin() + static_cast<std::ptrdiff_t>(scanned_), pending.end(),
                                    [](char c) { return c == '\n' || c == '\r'; });
    return found == pending.end() ? std::string_view::npos : static_cast<std::size_t>(found - pending.begin());
  }

  std::unique_ptr<InputBuffer> input_;
  std::optional<std::string_view> line_;  // found but not yet returned
  std::uint64_t number_ = 0;              // of the line found last, from 1
  std::size_t scanned_ = 0;               // pending bytes that hold no line end
  bool ended_in_cr_ = false;              // the line before: an LF that follows is part of its end
  bool at_end_ = false;
};

// --- Fields ---------------------------------------------------------------------------------------------------------

// The character between the fields of a line: the first of comma, semicolon and tab that occurs outside quotes, else a
// blank, which stands for any run of blanks. Never guessed from the locale: a decimal comma is an error. What a comment
// holds does not count.
char delimiter_of(std::string_view line) {
  for (const char delimiter : {',', ';', '\t'}) {
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

// The fields of a line from left to right, without quotes and surrounding blanks.
class Fields {
 public:
  Fields(std::string_view line, char delimiter) : rest_(line), delimiter_(delimiter) {}

  // Absent behind the last field, or where a comment starts.
  std::optional<std::string_view> next() {
    while (!rest_.empty() && is_blank(rest_.front())) rest_.remove_prefix(1);
    if (at_end_ || rest_.starts_with('#') || (delimiter_ == ' ' && rest_.empty())) return std::nullopt;
    return rest_.starts_with('"') ? next_quoted() : next_plain();
  }

 private:
  [[nodiscard]] bool is_blank(char c) const { return c == ' ' || (c == '\t' && delimiter_ != '\t'); }
  [[nodiscard]] bool ends_field(char c) const { return delimiter_ == ' ' ? is_blank(c) : c == delimiter_; }

  std::string_view next_plain() {
    std::size_t size = 0;
    std::size_t used = 0;  // without blanks at the end
    for (; size < rest_.size() && !ends_field(rest_[size]); ++size) {
      if (rest_[size] == '#' && is_blank(rest_[size - 1])) break;
      if (!is_blank(rest_[size])) used = size + 1;
    }
    const std::string_view field = rest_.substr(0, used);
    skip_delimiter(size);
    return field;
  }

  std::string_view next_quoted() {
    std::size_t size = 1;
    while (size < rest_.size() && (rest_[size] != '"' || rest_.substr(size, 2) == "\"\"")) {
      size += rest_[size] == '"' ? 2 : 1;
    }
    const std::string_view field = rest_.substr(1, std::min(size, rest_.size()) - 1);
    while (size < rest_.size() && !ends_field(rest_[size])) ++size;
    skip_delimiter(std::min(size, rest_.size()));
    return field;
  }

  // Moves behind the delimiter at `position`; at the line's end or at a comment there is none.
  void skip_delimiter(std::size_t position) {
    at_end_ = position == rest_.size() || !ends_field(rest_[position]);
    rest_.remove_prefix(at_end_ ? rest_.size() : position + 1);
  }

  std::string_view rest_;
  char delimiter_;
  bool at_end_ = false;
};

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

// A field as part of a message.
std::string quoted(std::string_view field) {
  return "'" + printable_ascii(field.substr(0, kMaxQuoted)) + (field.size() > kMaxQuoted ? "...'" : "'");
}

// --- Columns --------------------------------------------------------------------------------------------------------

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
      : lines_(std::make_unique<LineReader>(std::move(input))), columns_are_given_(options.columns) {
    if (!options.columns) return;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int column = (*options.columns)[axis];
      if (column < 1) throw InputError("column " + std::to_string(column) + " of points, expected 1 or more");
      columns_[axis] = static_cast<std::size_t>(column) - 1;
    }
  }

  bool next(std::vector<Vec3>& batch, std::size_t max) override {
    batch.clear();
    while (batch.size() < max && (batch.empty() || !lines_->would_wait())) {
      const auto line = lines_->next();
      if (!line) break;
      const bool is_first = !std::exchange(started_, true);
      if (is_first && take_header(*line)) continue;
      batch.push_back(parse(*line));
    }
    return !batch.empty();
  }

  [[nodiscard]] bool would_block() const override { return lines_->would_wait(); }
  [[nodiscard]] bool has_columns() const override { return true; }
  [[nodiscard]] std::optional<std::uint64_t> size() const override { return std::nullopt; }

 private:
  // Whether the first line is a header, which it is if no coordinate in it is a number, or looks like one, and one of
  // them is a name. Takes the columns from it.
  bool take_header(std::string_view line) {
    if (line.find('\0') != std::string_view::npos) lines_->fail("the input is binary, expected text");
    std::vector<std::string_view> names;
    Fields fields(line, delimiter_of(line));
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
    Fields fields(line, *delimiter_);
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
    lines_->fail("column " + std::to_string(column + 1) + " is " + (field.empty() ? "empty" : quoted(field)) +
                 ", expected a finite number");
  }

  [[noreturn]] void fail_short(std::string_view line, std::size_t found, std::size_t last) const {
    lines_->fail("found " + quoted(line) + " with " + counted(found, "column") + ", expected at least " +
                 std::to_string(last + 1));
  }

  std::unique_ptr<LineReader> lines_;  // would_block() reads ahead: the points stay the same
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
