// The fields of a line of a table: separated by commas, semicolons, tabs or blanks, and quoted where they hold these.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string_view>

namespace raycone {

// The fields of a line from left to right, without quotes and surrounding blanks.
class TableFields {
 public:
  TableFields(std::string_view line, char delimiter) : rest_(line), delimiter_(delimiter) {}

  // Absent behind the last field, or where a comment starts.
  std::optional<std::string_view> next() {
    while (!rest_.empty() && is_blank(rest_.front())) rest_.remove_prefix(1);
    if (at_end_ || rest_.starts_with('#') || (delimiter_ == ' ' && rest_.empty())) return std::nullopt;
    return rest_.starts_with('"') ? next_quoted() : next_plain();
  }

  // Whether a quotation mark among the fields so far has no other one.
  [[nodiscard]] bool is_open() const { return is_open_; }

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
    is_open_ = is_open_ || size >= rest_.size();
    const std::string_view field = rest_.substr(1, std::min(size, rest_.size()) - 1);
    const std::size_t after = std::min(size + 1, rest_.size());
    std::size_t end = after;
    while (end < rest_.size() && !ends_field(rest_[end])) ++end;
    std::size_t next = after;
    while (next < end && is_blank(rest_[next])) ++next;
    const bool is_comment = next < end && next > after && rest_[next] == '#';
    const std::string_view whole = rest_.substr(0, end);  // with what is glued to the quotes: no number
    skip_delimiter(is_comment ? rest_.size() : end);
    return next == end || is_comment ? field : whole;
  }

  // Moves behind the delimiter at `position`; at the line's end or at a comment there is none.
  void skip_delimiter(std::size_t position) {
    at_end_ = position == rest_.size() || !ends_field(rest_[position]);
    rest_.remove_prefix(at_end_ ? rest_.size() : position + 1);
  }

  std::string_view rest_;
  char delimiter_;
  bool at_end_ = false, is_open_ = false;
};

}  // namespace raycone
