#include "io/mesh/face_groups.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

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

TEST(GroupCollector, NumbersGroupsThatHaveTriangles) {
  GroupCollector collector;
  collector.continue_group({"default"}, 0);
  collector.continue_group({"a"}, 0);
  collector.continue_group({"none"}, 2);
  collector.continue_group({"b"}, 2);
  collector.continue_group({"a"}, 5);
  collector.start_group("a", 6);
  collector.start_group("none", 7);
  const FaceGroups groups = collector.finish(7);
  EXPECT_EQ(groups.names, (std::vector<std::string>{"a", "b", "a"}));
  EXPECT_EQ(groups.runs, (std::vector<GroupRun>{{0, 0}, {2, 1}, {5, 0}, {6, 2}}));
}

TEST(GroupCollector, TellsNamesApartThatBeginAlike) {
  const auto name = [](const std::string& end) {
    GroupName all;
    append_to_name(all, repeated("n", 300));
    append_to_name(all, end);
    return all;
  };
  EXPECT_EQ(name("left"), name("left"));
  EXPECT_FALSE(name("left") == name("right"));
  EXPECT_LT(name(repeated("n", 9000)).text.size(), 2 * kMostOfName);
  GroupCollector collector;
  collector.continue_group(name("left"), 0);
  collector.continue_group(name("right"), 1);
  collector.continue_group(name("left"), 2);
  const FaceGroups groups = collector.finish(3);
  EXPECT_EQ(groups.names, std::vector<std::string>(2, repeated("n", 255)));
  EXPECT_EQ(groups.runs, (std::vector<GroupRun>{{0, 0}, {1, 1}, {2, 0}}));
}

}  // namespace
}  // namespace raycone
