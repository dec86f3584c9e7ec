#include "io/mesh/face_groups.h"

#include <gtest/gtest.h>

#include <string>

namespace raycone {
namespace {

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

TEST(CutName, KeepsNamesThatAreShortEnough) {
  EXPECT_EQ(cut_name(""), "");
  EXPECT_EQ(cut_name("Körper"), "Körper");
  EXPECT_EQ(cut_name(repeated("n", 255)), repeated("n", 255));
  EXPECT_EQ(cut_name("n" + repeated("é", 127)), "n" + repeated("é", 127));
}

TEST(CutName, CutsBetweenCharacters) {
  EXPECT_EQ(cut_name(repeated("n", 300)), repeated("n", 255));
  EXPECT_EQ(cut_name(repeated("é", 200)), repeated("é", 127));
  EXPECT_EQ(cut_name(repeated("€", 100)), repeated("€", 85));
  EXPECT_EQ(cut_name("nn" + repeated("€", 100)), "nn" + repeated("€", 84));
  EXPECT_EQ(cut_name(repeated("😀", 100)), repeated("😀", 63));
}

// Latin-1, for instance.
TEST(CutName, CutsOtherBytesAnywhere) {
  EXPECT_EQ(cut_name(repeated("\xBF", 300)), repeated("\xBF", 255));
  EXPECT_GE(cut_name(repeated("\xE9", 300)).size(), 252U);
}

}  // namespace
}  // namespace raycone
