#include "app/input/mesh_list.h"

#include <gtest/gtest.h>

#include "io/files/file_error.h"
#include "tests/support/error_text.h"

namespace raycone::test {
namespace {

using Paths = std::vector<std::string>;

TEST(MeshList, HoldsAPathALine) {
  EXPECT_EQ(paths_in_list("a b.stl\n./@c.obj\nlast", "list", PathEnd::kLineFeed),
            (Paths{"a b.stl", "./@c.obj", "last"}));
  EXPECT_EQ(paths_in_list("a.stl\r\n\r\nb\r.stl\r\n", "list", PathEnd::kLineFeed), (Paths{"a.stl", "b\r.stl"}));
  EXPECT_EQ(paths_in_list("\xEF\xBB\xBF"
                          "a.stl\n",
                          "list", PathEnd::kLineFeed),
            Paths{"a.stl"})
      << "a byte order mark";
  EXPECT_TRUE(paths_in_list("", "list", PathEnd::kLineFeed).empty());
}

TEST(MeshList, MayHaveBlankLinesAndComments) {
  EXPECT_EQ(
      paths_in_list("# all\n\n \t \na.stl\n  # one more\n#x.stl\nb #1.stl\n./#y.stl\n", "list", PathEnd::kLineFeed),
      (Paths{"a.stl", "b #1.stl", "./#y.stl"}));
  EXPECT_EQ(paths_in_list(" a.stl \n", "list", PathEnd::kLineFeed), Paths{" a.stl "}) << "blanks may be part of a name";
}

TEST(MeshList, SeparatedByNulHoldsAnyName) {
  const std::string text("#x.stl\0 \0\0a\nb\r\0last", 19);
  EXPECT_EQ(paths_in_list(text, "list", PathEnd::kNul), (Paths{"#x.stl", " ", "a\nb\r", "last"}));
}

TEST(MeshList, WithNulInItsLinesIsRefused) {
  const std::string text("# a comment\0\na.stl\0b.stl\n", 25);
  EXPECT_EQ(error_text<InputError>([&] { return paths_in_list(text, "list", PathEnd::kLineFeed, "; -0 helps"); }),
            "list:2: holds a NUL, expected a path of text; -0 helps");
}

}  // namespace
}  // namespace raycone::test
