#include "app/text/wrapped_help.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>

#include "app/command_line/parse_command_line.h"

namespace raycone {
namespace {

std::size_t longest_line(const std::string& text) {
  std::istringstream lines(text);
  std::size_t longest = 0;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("  raycone ")) longest = std::max(longest, line.size());
  }
  return longest;
}

std::string words_of(const std::string& text) {
  std::istringstream words(text);
  std::string joined;
  for (std::string word; words >> word;) joined += word + ' ';
  return joined;
}

TEST(WrappedHelp, GoesOnBelowTheDescription) {
  const std::string option = "  -o,--output OUT" + std::string(19, ' ');  // kHelpColumn
  EXPECT_EQ(wrapped_help(option + "File to write, of any of the many formats that there are", 60),
            option + "File to write, of any of\n" + std::string(36, ' ') + "the many formats that\n" +
                std::string(36, ' ') + "there are");
}

TEST(WrappedHelp, KeepsWhatIsShortAndWhatCannotBeBroken) {
  const std::string word(70, 'x');
  EXPECT_EQ(wrapped_help("short\n\n  too\n", 60), "short\n\n  too\n");
  EXPECT_EQ(wrapped_help("  --" + word + "\n", 60), "  --" + word + "\n");
  EXPECT_EQ(wrapped_help("  a " + word + " b", 60), "  a\n  " + word + "\n  b");
  EXPECT_EQ(wrapped_help("  raycone lattice a.obj -o " + word, 60), "  raycone lattice a.obj -o " + word);
  EXPECT_EQ(wrapped_help("", 60), "");
  EXPECT_EQ(wrapped_help(word + " " + word, 59), word + " " + word) << "too narrow to be read";
}

TEST(WrappedHelp, FitsEveryCommandAndLosesNoWord) {
  for (const char* const command : {"", "lattice", "points", "slice", "surface", "info", "batch", "report"}) {
    const std::string help = help_text(command);
    for (const std::size_t width : {70U, 80U, 100U, 1000U}) {
      const std::string wrapped = wrapped_help(help, width);
      EXPECT_LE(longest_line(wrapped), width) << command;
      EXPECT_EQ(words_of(wrapped), words_of(help)) << command;
    }
  }
}

}  // namespace
}  // namespace raycone
