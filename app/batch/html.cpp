#include "app/batch/html.h"

#include <cstddef>
#include <cstdint>

namespace raycone {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

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

// The length of the valid character at the start of `text`, which is not empty; 0 where there is none.
std::size_t valid_length(std::string_view text) {
  const std::size_t length = length_from(static_cast<unsigned char>(text[0]));
  if (length <= 1) return length;
  return length <= text.size() && is_character(text.substr(0, length)) ? length : 0;
}

void append_ascii(std::string& html, char character) {
  switch (character) {
    case '&':
      html += "&amp;";
      break;
    case '<':
      html += "&lt;";
      break;
    case '>':
      html += "&gt;";
      break;
    case '"':
      html += "&quot;";
      break;
    default:
      if (static_cast<unsigned char>(character) < 0x20 || character == 0x7f) {
        html += kReplacement;
      } else {
        html += character;
      }
  }
}

}  // namespace

std::string html_text(std::string_view text) {
  std::string html;
  while (!text.empty()) {
    const std::size_t length = valid_length(text);
    if (length == 1) append_ascii(html, text[0]);
    if (length != 1) html += length == 0 ? kReplacement : text.substr(0, length);
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return html;
}

}  // namespace raycone
