// The lines of a table that is read as it arrives.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "io/files/file_error.h"
#include "io/files/input_buffer.h"
#include "io/files/text_scanner.h"

namespace raycone {

// The lines of the input that are neither blank nor comments.
class TableLines {
 public:
  explicit TableLines(std::unique_ptr<InputBuffer> input) : input_(std::move(input)) {}

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

  // Of the line that was returned last, from 1 on.
  [[nodiscard]] std::uint64_t number() const { return number_; }

  // Throws InputError about a line.
  [[noreturn]] void fail(std::uint64_t line, const std::string& what) const {
    throw InputError(input_->name() + ":" + std::to_string(line) + ": " + what);
  }
  // The one that was returned last.
  [[noreturn]] void fail(const std::string& what) const { fail(number_, what); }

 private:
  // No table has longer lines; a file without line ends is not a table.
  static constexpr std::size_t kMaxLine = std::size_t{1} << 20;

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
      line = without_byte_order_mark(line);
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

}  // namespace raycone
