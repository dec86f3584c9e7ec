// Words without regard to case, and numbers as text: of ASCII alone, whatever the locale.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
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

// What a message tells of a text in a file: its beginning, "..." where it goes on, and '?' for each byte that is not
// printable, so that messages are one short line of valid UTF-8 whatever a file holds.
[[nodiscard]] inline std::string excerpt(std::string_view text) {
  constexpr std::size_t kMost = 120;
  std::string beginning(text.substr(0, kMost));
  std::ranges::replace_if(
      beginning, [](char c) { return c < ' ' || c > '~'; }, '?');
  return text.size() > kMost ? beginning + "..." : beginning;
}

// Rounded to so many significant digits, at most 17, as by %.*g, for people.
[[nodiscard]] inline std::string with_digits(double number, int digits) {
  std::array<char, 32> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), number, std::chars_format::general, digits);
  return {text.data(), end.ptr};
}

// The shortest text that reads back as the same double.
[[nodiscard]] inline std::string shortest_text(double number) {
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr};
}

}  // namespace raycone
