// A cursor over the text of a mesh file: numbers, words and lines at the speed that files of 100 MB need.
//
// Lines end in LF, CR LF or CR; the first line end of the text decides, and whichever character does not end lines is a
// blank, unless take_mixed_line_ends() says otherwise. Numbers are decimal and independent of the locale. Nothing is
// copied, no line is too long.
#pragma once

#include <charconv>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include "io/files/named_bytes.h"

namespace raycone {

// Blanks and line ends, in any locale.
[[nodiscard]] inline bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

[[nodiscard]] inline bool is_digit(char c) { return c >= '0' && c <= '9'; }

inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // of UTF-8: what editors of Windows put first

[[nodiscard]] inline std::string_view without_byte_order_mark(std::string_view bytes) {
  return bytes.starts_with(kByteOrderMark) ? bytes.substr(kByteOrderMark.size()) : bytes;
}

// Whether a byte order mark announces UTF-16.
[[nodiscard]] inline bool is_utf16(std::string_view bytes) {
  return bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF");
}

// Parses the number at `first`, nearest double, and returns what follows it; nullptr where there is none. A leading '+'
// is allowed. "nan", "inf" and Microsoft's "1.#IND" are non-finite values; so is what overflows, what underflows is 0.
const char* parse_number(const char* first, const char* last, double& value);

// The number that the whole text is, by parse_number(); absent where it is none.
[[nodiscard]] inline std::optional<double> number_of(std::string_view text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  return !text.empty() && parse_number(text.data(), end, value) == end ? std::optional(value) : std::nullopt;
}

class TextScanner {
 public:
  // Starts behind a UTF-8 byte order mark; throws InputError where there is one of UTF-16. `source` must outlive this.
  explicit TextScanner(const NamedBytes& source);

  // All from here on is text: where files with other line ends have been joined to the first one, each line ends as it
  // does. Carriage returns before CR LF are blanks still, since some programs write those.
  void take_mixed_line_ends();

  [[nodiscard]] bool at_end() const { return position_ == end_; }
  // At the end of a line or of the text, or at a comment ('#').
  [[nodiscard]] bool at_line_end() const { return at_end() || is_line_end(*position_) || *position_ == '#'; }
  // At a blank, a line end, a comment, a backslash that joins lines or the end of the text.
  [[nodiscard]] bool at_token_end() const { return ends_token(position_); }
  // Position as an offset into the source's bytes.
  [[nodiscard]] std::size_t offset() const { return static_cast<std::size_t>(position_ - begin_); }
  void seek(std::size_t offset) { position_ = begin_ + offset; }
  [[nodiscard]] std::size_t remaining() const { return static_cast<std::size_t>(end_ - position_); }

  // Moves to the next token or line end. A backslash at the end of a line joins the next one to it.
  void skip_blanks() {
    while (!at_end() && !is_line_end(*position_) && (is_space(*position_) || skip_continuation())) ++position_;
  }
  // Moves past a byte order mark, which begins each of several files that have been joined.
  void skip_byte_order_mark() {
    if (peek() == '\xEF' && rest().starts_with(kByteOrderMark)) position_ += kByteOrderMark.size();
  }
  // Moves to the next token, in whichever line.
  void skip_whitespace() {
    while (!at_end() && is_space(*position_)) ++position_;
  }
  // Moves to the start of the next line.
  void skip_line() {
    if (other_end_ != line_end_) return skip_mixed_line();
    const void* found = std::memchr(position_, line_end_, remaining());
    position_ = found ? static_cast<const char*>(found) + 1 : end_;
  }
  // The same, but a line that ends in a backslash takes the next one with it; not where a comment begins before: its
  // last backslash may end the name of a directory.
  void skip_continued_line(char comment);
  // Moves to the first token of the first line, from here on, that has one; false at the end of the text.
  bool skip_empty_lines();
  [[nodiscard]] std::string_view rest() const { return {position_, remaining()}; }
  // Moves past `count` characters of the current token.
  void advance(std::size_t count) { position_ += count; }

  // Character at the position, '\0' at the end.
  [[nodiscard]] char peek() const { return at_end() ? '\0' : *position_; }
  // Token at the position, without moving: up to a blank, a comment or the line's end.
  [[nodiscard]] std::string_view peek_word() const;
  // Moves to the next blank or line end.
  void skip_token() {
    while (!at_end() && !is_space(*position_)) ++position_;
  }
  // Moves past `word`, given in lower case, if that is the token at the position, in any case of letters.
  bool skip_word(std::string_view word);

  // The number at the position, moving past it; absent, without moving, where there is none or where something is glued
  // to it, see at_token_end().
  std::optional<double> number() {
    double value = 0.0;
    const char* after = parse_number(position_, end_, value);
    if (!after || !ends_token(after)) return std::nullopt;
    position_ = after;
    return value;
  }
  // The number at the position; throws InputError where there is none. `what`: "a coordinate".
  double expected_number(const char* what) {
    const std::optional<double> value = number();
    if (!value) fail_expecting(what);
    return *value;
  }
  // number() for an integer; beyond 64 bits, the nearest that fits.
  std::optional<std::int64_t> integer() {
    const char* start = position_;
    const std::optional<std::int64_t> value = integer_prefix();
    if (value && ends_token(position_)) return value;
    position_ = start;
    return std::nullopt;
  }
  // The same whatever follows the digits.
  std::optional<std::int64_t> integer_prefix() {
    const char* first = !at_end() && *position_ == '+' ? position_ + 1 : position_;
    if (first != position_ && (first == end_ || !is_digit(*first))) return std::nullopt;
    std::int64_t value = 0;
    const auto [after, error] = std::from_chars(first, end_, value);
    if (error == std::errc::invalid_argument) return std::nullopt;
    if (error == std::errc::result_out_of_range) value = *first == '-' ? INT64_MIN : INT64_MAX;
    position_ = after;
    return value;
  }

  // Throws InputError "FILE:LINE: what", LINE being that of the offset (here: of the position).
  [[noreturn]] void fail_at(std::size_t offset, const std::string& what) const;
  [[noreturn]] void fail(const std::string& what) const { fail_at(offset(), what); }
  // "FILE:LINE: expected WHAT, found 'abc'", what is found being the token at the position, "the end of the line" or
  // "the end of the file".
  [[noreturn]] void fail_expecting(const std::string& what) const { fail("expected " + what + ", found " + found()); }

 private:
  [[nodiscard]] std::string found() const;
  [[nodiscard]] bool is_line_end(char c) const { return c == line_end_ || c == other_end_; }
  void skip_mixed_line();
  // A backslash does so only where it joins two lines: else it is part of what it is glued to.
  [[nodiscard]] bool ends_token(const char* p) const {
    return p == end_ || is_space(*p) || *p == '#' || continued_end(p) != nullptr;
  }
  // The line end behind a backslash at `p`; null where there is none.
  [[nodiscard]] const char* continued_end(const char* p) const {
    if (*p != '\\') return nullptr;
    const char* next = p + 1;
    if (end_ - next > 1 && next[0] == '\r' && next[1] == '\n' && is_line_end('\n')) ++next;
    return next != end_ && is_line_end(*next) ? next : nullptr;
  }
  // At a backslash before a line end: moves to the line end and returns true.
  bool skip_continuation();

  const std::string& name_;
  const char* begin_;
  const char* end_;
  const char* position_;
  char line_end_ = '\n';
  char other_end_ = '\n';  // the same but in a text whose lines end differently
};

}  // namespace raycone
