#include "app/text/html.h"

#include "app/text/plain_text.h"

namespace raycone {

std::string html_text(std::string_view text) {
  std::string html;
  for (const char character : plain_text(text, "\xEF\xBF\xBD")) {
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
        html += character;
    }
  }
  return html;
}

}  // namespace raycone
