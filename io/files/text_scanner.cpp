// Numbers, lines and messages of text files. Short decimals are converted exactly by one product or quotient of exactly
// representable numbers (W. D. Clinger, "How to Read Floating Point Numbers Accurately", 1990); std::from_chars does
// the others.
#include "io/files/text_scanner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "io/files/ascii.h"
#include "io/files/file_error.h"

namespace raycone {
namespace {

constexpr std::array<double, 23> kPowersOfTen = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                                 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

// Reads digits into `mantissa`, which may wrap: the caller counts them.
const char* read_digits(const char* first, const char* last, std::uint64_t& mantissa) {
  while (first != last && is_digit(*first)) mantissa = 10 * mantissa + static_cast<std::uint64_t>(*first++ - '0');
  return first;
}

// Reads an exponent of one to three digits; nullptr where it is anything else.
const char* read_exponent(const char* first, const char* last, int& exponent) {
  const bool negative = first != last && *first == '-';
  if (first != last && (*first == '-' || *first == '+')) ++first;
  std::uint64_t value = 0;
  const char* after = read_digits(first, last, value);
  if (after == first || after - first > 3) return nullptr;
  exponent = negative ? -static_cast<int>(value) : static_cast<int>(value);
  return after;
}

// A decimal whose digits and power of ten are exact doubles, so that one operation rounds it correctly; nullptr for
// everything else.
const char* parse_short_decimal(const char* first, const char* last, double& value) {
  const bool negative = first != last && *first == '-';
  const char* digits = negative ? first + 1 : first;
  std::uint64_t mantissa = 0;
  const char* after = read_digits(digits, last, mantissa);
  std::ptrdiff_t count = after - digits;
  std::ptrdiff_t decimals = 0;
  if (after != last && *after == '.') {
    const char* fraction = after + 1;
    after = read_digits(fraction, last, mantissa);
    decimals = after - fraction;
    count += decimals;
  }
  constexpr std::ptrdiff_t kMaxDigits = 19;  // 10^19 - 1 fits into 64 bits
  if (count == 0 || count > kMaxDigits || mantissa > (std::uint64_t{1} << 53)) return nullptr;
  int exponent = 0;
  if (after != last && (*after == 'e' || *after == 'E')) after = read_exponent(after + 1, last, exponent);
  if (!after) return nullptr;
  exponent -= static_cast<int>(decimals);
  const auto magnitude = static_cast<std::size_t>(std::abs(exponent));
  if (magnitude >= kPowersOfTen.size()) return nullptr;
  const auto whole = static_cast<double>(mantissa);
  const double result = exponent < 0 ? whole / kPowersOfTen[magnitude] : whole * kPowersOfTen[magnitude];
  value = negative ? -result : result;
  return after;
}

// Infinity or 0 of the right sign for a number that std::from_chars finds out of range: it does not say which. The
// decimal exponent of the leading digit tells; it cannot be near 0.
double out_of_range_value(std::string_view number) {
  const bool negative = number.front() == '-';
  const std::size_t exponent_mark = number.find_first_of("eE");
  const std::string_view digits = number.substr(0, exponent_mark);
  const std::size_t point = std::min(digits.find('.'), digits.size());
  const std::size_t leading = digits.find_first_of("123456789");
  if (leading == std::string_view::npos) return negative ? -0.0 : 0.0;
  const double shift = static_cast<double>(point) - static_cast<double>(leading);
  double exponent = 0.0;
  if (exponent_mark != std::string_view::npos) {
    // Saturates at a length of digits that no file has.
    bool below_one = false;
    for (const char c : number.substr(exponent_mark + 1)) {
      if (c == '-') below_one = true;
      if (is_digit(c)) exponent = std::min(10.0 * exponent + (c - '0'), 1e18);
    }
    if (below_one) exponent = -exponent;
  }
  const double magnitude = exponent + shift > 0.0 ? std::numeric_limits<double>::infinity() : 0.0;
  return negative ? -magnitude : magnitude;
}

// What Microsoft's C library printed for numbers that are not finite: "1.#INF", "-1.#IND", "1.#QNAN", with or without
// zeros behind. `mark` is at the '#'.
const char* skip_microsoft_suffix(const char* mark, const char* last) {
  const std::string_view rest(mark, static_cast<std::size_t>(last - mark));
  for (const std::string_view suffix : {"#INF", "#IND", "#QNAN", "#SNAN"}) {
    if (!rest.starts_with(suffix)) continue;
    const char* after = mark + suffix.size();
    while (after != last && is_digit(*after)) ++after;
    return after;
  }
  return nullptr;
}

}  // namespace

const char* parse_number(const char* first, const char* last, double& value) {
  if (first != last && *first == '+') {
    ++first;
    if (first != last && *first == '-') return nullptr;
  }
  const char* after = parse_short_decimal(first, last, value);
  if (!after) {
    const std::from_chars_result result = std::from_chars(first, last, value);
    if (result.ec == std::errc::invalid_argument) return nullptr;
    after = result.ptr;
    if (result.ec == std::errc::result_out_of_range)
      value = out_of_range_value({first, static_cast<std::size_t>(after - first)});
  }
  if (after != last && *after == '#' && after[-1] == '.') {
    if (const char* behind = skip_microsoft_suffix(after, last)) {
      value = std::numeric_limits<double>::quiet_NaN();
      return behind;
    }
  }
  return after;
}

TextScanner::TextScanner(const NamedBytes& source)
    : name_(source.name),
      begin_(source.bytes.data()),
      end_(source.bytes.data() + source.bytes.size()),
      position_(begin_) {
  if (is_utf16(source.bytes)) fail("the text is UTF-16, expected UTF-8 or ASCII");
  skip_byte_order_mark();
  const std::size_t first_end = source.bytes.find_first_of("\r\n");
  if (first_end != std::string_view::npos && source.bytes.substr(first_end, 2) != "\r\n")
    line_end_ = source.bytes[first_end];
  other_end_ = line_end_;
}

void TextScanner::take_mixed_line_ends() {
  const char other = line_end_ == '\n' ? '\r' : '\n';
  for (const char* p = position_;
       (p = static_cast<const char*>(std::memchr(p, other, static_cast<std::size_t>(end_ - p)))) != nullptr;) {
    const char* after = std::find_if(p, end_, [](char c) { return c != '\r'; });  // p itself where it is an LF
    const bool is_crlf = other == '\n' ? p != begin_ && p[-1] == '\r' : after == end_ || *after == '\n';
    if (!is_crlf) {
      other_end_ = other;
      return;
    }
    p = std::max(after, p + 1);
  }
}

// Byte by byte: lines are short, and a search for one end could pass thousands of lines with the other.
void TextScanner::skip_mixed_line() {
  position_ = std::find_if(position_, end_, [this](char c) { return is_line_end(c); });
  if (remaining() > 1 && position_[0] == '\r' && position_[1] == '\n') ++position_;
  if (!at_end()) ++position_;
}

void TextScanner::skip_continued_line(char comment) {
  do {
    const char* const from = position_;
    skip_line();
    if (std::memchr(from, comment, static_cast<std::size_t>(position_ - from))) return;
    const char* last = position_ - 1;  // the line's end, unless the text ends without one
    if (last > begin_ && *last == '\n' && last[-1] == '\r') --last;
    if (last <= begin_ || last[-1] != '\\') return;
  } while (!at_end());
}

bool TextScanner::skip_empty_lines() {
  for (;;) {
    skip_blanks();
    if (at_end()) return false;
    if (!at_line_end()) return true;
    skip_line();
  }
}

std::string_view TextScanner::peek_word() const {
  const char* after = position_;
  while (!ends_token(after)) ++after;
  return {position_, static_cast<std::size_t>(after - position_)};
}

bool TextScanner::skip_word(std::string_view word) {
  if (remaining() < word.size() || !ends_token(position_ + word.size())) return false;
  if (!is_word({position_, word.size()}, word)) return false;
  position_ += word.size();
  return true;
}

bool TextScanner::skip_continuation() {
  const char* const end = continued_end(position_);
  if (end != nullptr) position_ = end;
  return end != nullptr;
}

std::string TextScanner::found() const {
  if (at_end()) return "the end of the file";
  if (is_line_end(*position_) || *position_ == '#') return "the end of the line";
  std::string_view word = peek_word();
  if (word.empty()) word = {position_, 1};
  return "'" + excerpt(word) + "'";
}

void TextScanner::fail_at(std::size_t offset, const std::string& what) const {
  auto line = 1 + std::count(begin_, begin_ + offset, line_end_);
  if (other_end_ != line_end_) {
    for (const char* p = begin_; p != begin_ + offset; ++p) {
      const bool is_crlf = *p == '\n' && p != begin_ && p[-1] == '\r';
      line += (*p == other_end_ ? 1 : 0) - (is_crlf ? 1 : 0);
    }
  }
  throw InputError(name_ + ":" + std::to_string(line) + ": " + what);
}

}  // namespace raycone
