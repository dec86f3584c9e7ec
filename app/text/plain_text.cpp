#include "app/text/plain_text.h"

#include <cstddef>

namespace raycone {
namespace {

// Bytes of the character that starts with `lead`; 0 where none does.
std::size_t length_from(unsigned char lead) {
  if (lead < 0x80) return 1;
  if (lead >= 0xC2 && lead <= 0xDF) return 2;
  if (lead >= 0xE0 && lead <= 0xEF) return 3;
  return lead >= 0xF0 && lead <= 0xF4 ? 4 : 0;
}

// Whether two to four bytes are one character: neither overlong nor a surrogate nor beyond Unicode.
bool is_character(std::string_view bytes) {
  for (const char byte : bytes.substr(1)) {
    if ((static_cast<unsigned char>(byte) & 0xC0) != 0x80) return false;
  }
  const auto lead = static_cast<unsigned char>(bytes[0]);
  const auto second = static_cast<unsigned char>(bytes[1]);
  if (lead == 0xE0) return second >= 0xA0;
  if (lead == 0xED) return second < 0xA0;
  if (lead == 0xF0) return second >= 0x90;
  return lead != 0xF4 || second < 0x90;
}

// Of a valid one.
char32_t code_of(std::string_view character) {
  const auto lead = static_cast<unsigned char>(character[0]);
  if (character.size() == 1) return lead;
  char32_t code = lead & (0x7FU >> character.size());
  for (const char byte : character.substr(1)) code = code << 6 | (static_cast<unsigned char>(byte) & 0x3FU);
  return code;
}

// The UTF-8 character at the start of `text`, which is not empty; empty where there is none, but other bytes.
std::string_view first_character(std::string_view text) {
  const std::size_t length = length_from(static_cast<unsigned char>(text[0]));
  if (length == 0 || length > text.size()) return {};
  const std::string_view character = text.substr(0, length);
  return length == 1 || is_character(character) ? character : std::string_view();
}

// Whether `character` is none that a terminal or page would obey in place of showing it: the controls of ASCII and
// Latin-1, and what breaks lines or turns the direction of writing.
bool is_shown(std::string_view character) {
  const char32_t code = code_of(character);
  const auto within = [code](char32_t first, char32_t last) { return first <= code && code <= last; };
  return !within(0, 0x1F) && !within(0x7F, 0x9F) && code != 0x61C && !within(0x200E, 0x200F) &&
         !within(0x2028, 0x202E) && !within(0x2066, 0x2069);
}

}  // namespace

std::string valid_utf8(std::string_view text) {
  std::string valid;
  while (!text.empty()) {
    const std::string_view character = first_character(text);
    valid += character.empty() ? "\xEF\xBF\xBD" : character;
    text.remove_prefix(character.empty() ? 1 : character.size());
  }
  return valid;
}

std::string plain_text(std::string_view text, std::string_view replacement) {
  std::string plain;
  while (!text.empty()) {
    const std::string_view character = first_character(text);
    plain += !character.empty() && is_shown(character) ? character : replacement;
    text.remove_prefix(character.empty() ? 1 : character.size());
  }
  return plain;
}

}  // namespace raycone
