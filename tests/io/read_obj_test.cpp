// The OBJ reader on good and on broken text.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "io/mesh/read_mesh.h"
#include "tests/support/reader_checks.h"

namespace raycone {
namespace {

using test::count_loading_prefixes;

constexpr std::string_view kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";  // vertices only

ParsedMesh parse(const std::string& text) { return test::parse(read_obj, text); }
std::string error_of(const std::string& text) { return test::error_of(read_obj, text); }
std::string with_triangle(const std::string& text) { return std::string(kTriangle) + text; }

std::vector<Triangle> triangles(const std::string& text) { return parse(text).mesh.triangles; }

const std::vector<Triangle> kOneTriangle = {{0, 1, 2}};

TEST(ReadObj, TriangleKeepsCoordinatesAndOrder) {
  const ParsedMesh parsed = parse("v 0.1 -2 3e2\nv 1 0 0\nv 0 1 0\nf 2 3 1\n");
  EXPECT_EQ(parsed.mesh.vertices, (std::vector<Vec3>{{0.1, -2, 300}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(parsed.mesh.triangles, (std::vector<Triangle>{{1, 2, 0}}));
  EXPECT_TRUE(parsed.warnings.empty());
}

TEST(ReadObj, PolygonIsFannedFromItsFirstCorner) {
  EXPECT_EQ(triangles("v 0 0 0\nv 1 0 0\nv 1 1 0\nv .5 2 0\nv 0 1 0\nf 2 3 4 5 1\n"),
            (std::vector<Triangle>{{1, 2, 3}, {1, 3, 4}, {1, 4, 0}}));
}

TEST(ReadObj, AttributesOfCornersArePassedOver) {
  for (const char* face : {"f 1/4 2/5 3/6", "f 1//7 2//8 3//9", "f 1/4/7 2/5/8 3/-6/-9", "f 1// 2// 3//", "f 1/ 2/ 3/"})
    EXPECT_EQ(triangles(with_triangle(face)), kOneTriangle) << face;
}

TEST(ReadObj, NegativeIndicesCountBackFromTheLastVertexRead) {
  EXPECT_EQ(triangles(with_triangle("f -3 -2 -1\nv 5 5 5\nf -4 -3 -1\n")),
            (std::vector<Triangle>{{0, 1, 2}, {0, 1, 3}}));
}

TEST(ReadObj, FacesMayReferForward) { EXPECT_EQ(triangles("f 1 2 3\n" + std::string(kTriangle)), kOneTriangle); }

TEST(ReadObj, BackslashContinuesALine) {
  EXPECT_EQ(triangles(with_triangle("f 1 \\\n 2\\\n 3\n")), kOneTriangle);
  EXPECT_EQ(triangles(with_triangle("f 1 2 \\\r\n3\r\n")), kOneTriangle);
}

TEST(ReadObj, NamesMayHoldBackslashesAndHashes) {
  const std::array<std::array<const char*, 2>, 7> cases{{{"g a\\ b#c d\n", "a\\ b#c d"},
                                                         {"g a\\\nb\n", "a b"},
                                                         {"g a \\\r\nb\r\n", "a b"},
                                                         {"g C:\\a\\b\n", "C:\\a\\b"},
                                                         {"g a \\ b\n", "a \\ b"},
                                                         {"g a # b\n", "a"},
                                                         {"g a#\n", "a#"}}};
  for (const auto& [line, name] : cases) {
    EXPECT_EQ(parse(with_triangle(line + std::string("f 1 2 3\n"))).groups.names, std::vector<std::string>{name})
        << line;
  }
}

TEST(ReadObj, EmptyLineEndsAContinuationHoweverLinesEnd) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    EXPECT_EQ(triangles("v 0 0 0" + end + "v 1 0 0" + end + "v 0 1 0" + end + "f 1 2 3\\" + end + end + "f 1 2 3" + end)
                  .size(),
              2U)
        << (end == "\r" ? "CR" : "LF");
  }
}

TEST(ReadObj, ContinuationOfAnIgnoredStatementIsIgnored) {
  EXPECT_EQ(triangles(with_triangle("curv 0 1 \\\nf 1 1 1\nf 1 2 3\n")), kOneTriangle);
}

TEST(ReadObj, BackslashAtTheEndOfACommentDoesNotContinue) {
  EXPECT_EQ(triangles(with_triangle("# C:\\models\\\nf 1 2 3 # C:\\models\\\n")), kOneTriangle);
  EXPECT_EQ(triangles("# C:\\models\\\n" + with_triangle("f 1 2 3\n")), kOneTriangle);
  // Nor behind any other statement, whether it is read or ignored.
  EXPECT_EQ(triangles("v 0 0 0 # x\\\nv 1 0 0#\\\nv 0 1 0\nf 1 2 3\n"), kOneTriangle);
  for (const char* const before : {"usemtl a", "s off", "vn 0 0 1", "vt 0 0", "g a", "o a", "curv 1", "vp \\\n 1"}) {
    EXPECT_EQ(triangles(with_triangle(before + std::string(" # c \\\nf 1 2 3\n"))), kOneTriangle) << before;
    EXPECT_EQ(triangles(with_triangle(before + std::string(" # c \\\r\nf 1 2 3\r\n"))), kOneTriangle) << before;
  }
}

TEST(ReadObj, WeightsAndColoursBehindCoordinatesAreIgnored) {
  EXPECT_EQ(triangles("v 0 0 0 1\nv 1 0 0 .5 .5 .5\nv 0 1 0 1 1 0 0\nf 1 2 3\n"), kOneTriangle);
}

TEST(ReadObj, OtherStatementsAreIgnored) {
  EXPECT_EQ(triangles("mtllib a.mtl\no a\ng b c\ns off\nvt 0 0\nvn 0 0 1\nvp 1\nusemtl m\nl 1 2\np 1\n" +
                      with_triangle("f 1 2 3\ncstype bezier\nend\n")),
            kOneTriangle);
}

TEST(ReadObj, LinesMayEndInAnyWay) {
  EXPECT_EQ(triangles("v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3"), kOneTriangle);
  EXPECT_EQ(triangles("v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r"), kOneTriangle);
}

TEST(ReadObj, ByteOrderMarksOfJoinedFilesAreSkipped) {
  const std::string mark = "\xEF\xBB\xBF";
  EXPECT_EQ(triangles("v 0 0 0\nv 1 0 0\n" + mark + "v 0 1 0\n" + mark + "# c\n" + mark + "f 1 2 3"), kOneTriangle);
}

TEST(ReadObj, FacesMayHaveTheirFormerName) { EXPECT_EQ(triangles(with_triangle("fo 1/1 2/2 3/3")), kOneTriangle); }

TEST(ReadObj, ByteOrderMarkIsSkipped) { EXPECT_EQ(triangles("\xEF\xBB\xBF" + with_triangle("f 1 2 3")), kOneTriangle); }

TEST(ReadObj, Utf16IsRefused) {
  EXPECT_EQ(error_of("\xFF\xFEv"), "f:1: the text is UTF-16, expected UTF-8 or ASCII");
  EXPECT_EQ(error_of("\xFE\xFF"), "f:1: the text is UTF-16, expected UTF-8 or ASCII");
}

TEST(ReadObj, LinesMayBeOfAnyLength) {
  std::string face = "f";
  for (int i = 0; i < 100000; ++i) face += " 1 2 3";
  EXPECT_EQ(triangles(with_triangle(face)).size(), 299998u);
}

TEST(ReadObj, NumbersAreReadToTheNearestDouble) {
  const auto x = [](const std::string& number) { return parse("v " + number + " 0 0").mesh.vertices.at(0).x; };
  EXPECT_EQ(x("0.1"), 0.1);
  EXPECT_EQ(x("+1.5"), 1.5);
  EXPECT_EQ(x(".5"), 0.5);
  EXPECT_EQ(x("5."), 5.0);
  EXPECT_EQ(x("-1E+2"), -100.0);
  EXPECT_EQ(x("9007199254740993"), 9007199254740992.0);  // 2^53 + 1: a tie, to even
  EXPECT_EQ(x("0.1000000000000000055511151231257827"), 0.1);
  EXPECT_EQ(x("8.41470984807896504e-01"), 8.41470984807896504e-01);
  EXPECT_EQ(x("123456789012345678901234567890"), 123456789012345678901234567890.0);
  EXPECT_EQ(x("4.9e-324"), 4.9e-324);
  EXPECT_TRUE(std::signbit(x("-0.0")));
}

TEST(ReadObj, WhatUnderflowsIsZero) {
  for (const char* number : {"1e-400", "-1e-400", "0.0000001e-330", "1e-99999999999999999999"})
    EXPECT_EQ(parse("v " + std::string(number) + " 0 0").mesh.vertices.at(0).x, 0.0) << number;
}

TEST(ReadObj, NonFiniteCoordinateOfAFaceIsAnErrorAtItsVertex) {
  for (const char* number : {"nan", "-NaN", "inf", "+Infinity", "1e400", "-1e99999999999999999999", "1.#IND",
                             "-1.#INF00", "1.#QNAN", "nan(ind)"}) {
    EXPECT_EQ(error_of("v 0 0 0\nv 1 " + std::string(number) + " 0\nv 0 1 0\nv 2 nan 0\nf 1 4 2\n"),
              "f:2: a vertex that faces use has a coordinate that is not finite, expected finite numbers")
        << number;
  }
}

TEST(ReadObj, NonFiniteCoordinateOfAnUnusedVertexIsNoError) {
  EXPECT_EQ(triangles(with_triangle("v nan inf 1e400\nf 1 2 3\n")), kOneTriangle);
}

TEST(ReadObj, FacesOfOneOrTwoCornersAreSkippedAndCounted) {
  const ParsedMesh parsed = parse(with_triangle("f 1 2\nf 1 2 3\nf 3\n"));
  EXPECT_EQ(parsed.mesh.triangles, kOneTriangle);
  EXPECT_EQ(parsed.skipped_faces, 2u);
  EXPECT_EQ(parsed.warnings,
            (std::vector<Warning>{{"skipped-faces", "2 faces with fewer than three corners skipped"}}));
}

TEST(ReadObj, DegenerateFacesAreKept) { EXPECT_EQ(triangles(with_triangle("f 1 1 2\n")).size(), 1u); }

TEST(ReadObj, BadIndicesAreNamed) {
  EXPECT_EQ(error_of(with_triangle("f 1 2 0\n")), "f:4: face index 0, but OBJ counts vertices from 1");
  EXPECT_EQ(error_of(with_triangle("\nf 1 2 4\n")), "f:5: face index 4, but the file has only 3 vertices");
  EXPECT_EQ(error_of(with_triangle("f 1 2 -4\n")), "f:4: face index -4, but only 3 vertices precede it");
  EXPECT_EQ(error_of(with_triangle("f 1 2 99999999999999999999\n")),
            "f:4: face index 9223372036854775807, but the file has only 3 vertices");
  EXPECT_EQ(error_of(with_triangle("f 1 2 4294967297\n")),
            "f:4: face index 4294967297, but the file has only 3 vertices");
}

TEST(ReadObj, TheFirstForwardReferenceOutOfRangeIsNamed) {
  EXPECT_EQ(error_of("f 3 2 1\nf 1 3 5\nf 9 1 2\nf 1 2 4\n" + std::string(kTriangle)),
            "f:2: face index 5, but the file has only 3 vertices");
}

TEST(ReadObj, BadNumbersAreQuoted) {
  EXPECT_EQ(error_of("v 0 1.0abc 0\n"), "f:1: expected a coordinate, found '1.0abc'");
  EXPECT_EQ(error_of("# c\nv 0 +-1 0\n"), "f:2: expected a coordinate, found '+-1'");
  EXPECT_EQ(error_of("v 0 0x10 0\n"), "f:1: expected a coordinate, found '0x10'");
  EXPECT_EQ(error_of("v 0 1,5 0\n"), "f:1: expected a coordinate, found '1,5'");
  EXPECT_EQ(error_of("v 0 1e 0\n"), "f:1: expected a coordinate, found '1e'");
  EXPECT_EQ(error_of("v 0 0 1\\garbage\n"), "f:1: expected a coordinate, found '1\\garbage'");
  EXPECT_EQ(error_of("v 0 0\\ 1\n"), "f:1: expected a coordinate, found '0\\'");
  EXPECT_EQ(error_of("v 0 0\nv 1 1 1\n"), "f:1: expected a coordinate, found the end of the line");
  EXPECT_EQ(error_of("v 0 0"), "f:1: expected a coordinate, found the end of the file");
  EXPECT_EQ(error_of(with_triangle("f 1 2 x\n")), "f:4: expected a vertex index, found 'x'");
  EXPECT_EQ(error_of(with_triangle("f 1 2 3/a\n")), "f:4: expected a vertex index, found '3/a'");
  EXPECT_EQ(error_of(with_triangle("f 1 2 3.0\n")), "f:4: expected a vertex index, found '3.0'");
  EXPECT_EQ(error_of(with_triangle("f 1 2 4\\x 5 6\n")), "f:4: expected a vertex index, found '4\\x'");
  EXPECT_EQ(error_of(with_triangle("f 1 2 3\\")), "f:4: expected a vertex index, found '3\\'");
}

TEST(ReadObj, MessagesAreOnePrintableLine) {
  EXPECT_EQ(error_of(std::string("v 0 \0\x1b\xff 0\n", 10)),
            "f:1: expected a coordinate, found '?"
            "?"
            "?'");
  EXPECT_EQ(error_of("v " + std::string(121, 'y')),
            "f:1: expected a coordinate, found '" + std::string(120, 'y') + "...'");
}

TEST(ReadObj, LineNumbersCountContinuedLines) {
  EXPECT_EQ(error_of(with_triangle("f 1 \\\n 2 \\\n 4\n")), "f:6: face index 4, but the file has only 3 vertices");
}

TEST(ReadObj, EveryTruncationLoadsOrIsRefused) {
  EXPECT_GT(count_loading_prefixes(read_obj, with_triangle("f 1/1/1 2//2 \\\r\n -1 # c\nvn 1.#IND 1e400 nan\n")), 0);
}

// As `cat` makes them of files of several systems.
TEST(ReadObj, LinesMayEndDifferently) {
  const std::array<std::string, 3> ends{"\n", "\r\n", "\r"};
  for (int code = 0; code < 243; ++code) {
    std::string text;
    int rest = code;
    for (const std::string_view line : {"v 0 0 0 1 1 1", "v 1 0 0", "# v 9 9 9", "v 0 1 0", "f 1 2 3"}) {
      text += std::string(line) + ends[static_cast<std::size_t>(rest % 3)];
      rest /= 3;
    }
    const ParsedMesh parsed = parse(text);
    EXPECT_EQ(parsed.mesh.vertices, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})) << code;
    EXPECT_EQ(parsed.mesh.triangles, kOneTriangle) << code;
    EXPECT_EQ(error_of(text + " f 1 2 x\n"), "f:6: expected a vertex index, found 'x'") << code;
  }
  EXPECT_EQ(error_of("v 0 0 0\r\nv 1 0 0\rv 0 1 0\nf 1 2 x\n"), "f:4: expected a vertex index, found 'x'");
  EXPECT_EQ(triangles("v 0 0 0\nv 1 0 0\rv 0 1 0\nf 1 \\\r2 \\\n3\n"), kOneTriangle);
}

// Some programs turn CR LF into CR CR LF.
TEST(ReadObj, CarriageReturnsBeforeALineEndAreBlanks) {
  EXPECT_EQ(triangles("v 0 0 0\r\r\nv 1 0 0\r\r\nv 0 1 0\r\r\nf 1 2 3\r\r\n"), kOneTriangle);
  EXPECT_EQ(triangles("v 0 0 0\nv 1 0 0\r\r\nv 0 1 0\nf 1 2 3\r"), kOneTriangle);
}

}  // namespace
}  // namespace raycone
