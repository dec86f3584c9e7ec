#include "app/text/plain_text.h"

#include <gtest/gtest.h>

#include <string>

#include "app/process/messages.h"
#include "app/text/html.h"

namespace raycone {
namespace {

std::string utf8(char32_t code) {
  const auto continued = [code](int shift) { return static_cast<char>(0x80U | (code >> shift & 0x3FU)); };
  if (code < 0x80) return {static_cast<char>(code)};
  if (code < 0x800) return {static_cast<char>(0xC0U | code >> 6), continued(0)};
  if (code < 0x10000) return {static_cast<char>(0xE0U | code >> 12), continued(6), continued(0)};
  return {static_cast<char>(0xF0U | code >> 18), continued(12), continued(6), continued(0)};
}

bool is_dangerous(char32_t code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0) || code == 0x61C || code == 0x200E || code == 0x200F ||
         (code >= 0x2028 && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
}

// Every character of Unicode, within a name.
TEST(PlainText, ReplacesWhatATerminalObeysAndNothingElse) {
  for (char32_t code = 0; code <= 0x10FFFF; ++code) {
    if (code >= 0xD800 && code <= 0xDFFF) continue;
    const std::string name = "a" + utf8(code) + "b";
    const std::string plain = plain_text(name, "?");
    if (plain != (is_dangerous(code) ? "a?b" : name)) ADD_FAILURE() << std::hex << static_cast<unsigned>(code);
  }
}

// Every pair and triple of bytes at the borders: what is left is valid and harmless.
TEST(PlainText, LeavesNoByteThatIsNoCharacter) {
  const std::string bytes = "\x01\x1B\x41\x7F\x80\x9B\x9F\xA0\xBF\xC0\xC1\xC2\xDF\xE0\xE2\xED\xEF\xF0\xF4\xF5\xFF";
  for (const char a : bytes) {
    for (const char b : bytes) {
      for (const char c : bytes) {
        const std::string plain = plain_text(std::string{a, b, c}, "?");
        EXPECT_EQ(plain_text(plain, "!"), plain);
        for (const char32_t code : {U'\x1B', U'\x7F', U'\x80', U'\x9B', U'\x9F'}) {
          EXPECT_EQ(plain.find(utf8(code)), std::string::npos);
        }
      }
    }
  }
  EXPECT_EQ(plain_text("\x9B"
                       "31m",
                       "?"),
            "?31m");
  EXPECT_EQ(plain_text("\xC3", "?"), "?");
}

TEST(PlainText, IsWhatMessagesAndPagesShow) {
  EXPECT_EQ(message_line("\xC2\x9B"
                         "2J.obj: \xE2\x80\xAEx"),
            "raycone: ?2J.obj: ?x\n");
  EXPECT_EQ(html_text("\xC2\x9B<\xE2\x80\xAE"), "\xEF\xBF\xBD&lt;\xEF\xBF\xBD");
  EXPECT_EQ(message_line("\xC3\xA4.obj"), "raycone: \xC3\xA4.obj\n");
}

}  // namespace
}  // namespace raycone
