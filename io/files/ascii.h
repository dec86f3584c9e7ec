// Words without regard to case, and numbers as text: of ASCII alone, whatever the locale.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <string_view>

namespace raycone {

[[nodiscard]] constexpr char lower_case(char c) { return 'A' <= c && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

[[nodiscard]] inline std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](char c) { return lower_case(c); });
  return lower;
}

// Whether the text is, or ends with, a word in any case; `lower`: the word in small letters.
[[nodiscard]] inline bool is_word(std::string_view text, std::string_view lower) {
  return std::ranges::equal(text, lower, {}, [](char c) { return lower_case(c); });
}
[[nodiscard]] inline bool ends_with_word(std::string_view text, std::string_view lower) {
  return text.size() >= lower.size() && is_word(text.substr(text.size() - lower.size()), lower);
}

// With '?' for each other byte, so that messages are one line of valid UTF-8 whatever a file holds.
[[nodiscard]] inline std::string printable_ascii(std::string_view text) {
  std::string printable(text);
  std::ranges::replace_if(
      printable, [](char c) { return c < ' ' || c > '~'; }, '?');
  return printable;
}

// The shortest text that reads back as the same double.
[[nodiscard]] inline std::string shortest_text(double number) {
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr};
}

}  // namespace raycone
