// The OFF reader on good and on broken text.
#include <gtest/gtest.h>

#include "io/mesh/read_mesh.h"
#include "tests/support/reader_checks.h"

namespace raycone {
namespace {

using test::count_loading_prefixes;

ParsedMesh parse(const std::string& text) { return test::parse(read_off, text); }
std::string error_of(const std::string& text) { return test::error_of(read_off, text); }
std::vector<Triangle> triangles(const std::string& text) { return parse(text).mesh.triangles; }

const std::string kVertices = "0 0 0\n1 0 0\n0 1 0\n";
const std::vector<Triangle> kOneTriangle = {{0, 1, 2}};

TEST(ReadOff, TriangleKeepsCoordinatesAndOrder) {
  const ParsedMesh parsed = parse("OFF\n3 1 3\n0.1 -2 3e2\n1 0 0\n0 1 0\n3 1 2 0\n");
  EXPECT_EQ(parsed.mesh.vertices, (std::vector<Vec3>{{0.1, -2, 300}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(parsed.mesh.triangles, (std::vector<Triangle>{{1, 2, 0}}));
  EXPECT_TRUE(parsed.warnings.empty());
}

TEST(ReadOff, PolygonIsFannedFromItsFirstCorner) {
  EXPECT_EQ(triangles("OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 3 0 1 2\n"),
            (std::vector<Triangle>{{3, 0, 1}, {3, 1, 2}}));
}

TEST(ReadOff, CountsMayStandInTheFirstLine) {
  EXPECT_EQ(triangles("OFF 3 1 0\n" + kVertices + "3 0 1 2\n"), kOneTriangle);
  EXPECT_EQ(triangles("OFF3 1 0\n" + kVertices + "3 0 1 2\n"), kOneTriangle);
}

TEST(ReadOff, NumberOfEdgesMayBeMissing) { EXPECT_EQ(triangles("OFF\n3 1\n" + kVertices + "3 0 1 2\n"), kOneTriangle); }

TEST(ReadOff, CommentsAndEmptyLinesMayStandAnywhere) {
  EXPECT_EQ(triangles("# a\n\nOFF # b\n# c\n\n3 1 0#d\n\n0 0 0 # e\n1 0 0\n#f\n0 1 0\n\n3 0 1 2# g\n\n# h\n"),
            kOneTriangle);
}

TEST(ReadOff, ColoursNormalsAndTextureCoordinatesAreIgnored) {
  EXPECT_EQ(triangles("COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 0 0 0\n0 1 0 1 2 3 4\n3 0 1 2 255 0 0\n"), kOneTriangle);
  EXPECT_EQ(triangles("NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n"), kOneTriangle);
  EXPECT_EQ(triangles("STCNOFF\n3 1 0\n0 0 0 0 0 1 1 1 1 1 0 0\n1 0 0 a\n0 1 0 b\n3 0 1 2 c\n"), kOneTriangle);
}

TEST(ReadOff, KeywordMayBeMissing) { EXPECT_EQ(triangles("3 1 0\n" + kVertices + "3 0 1 2\n"), kOneTriangle); }

TEST(ReadOff, OtherDimensionsAreRefused) {
  const std::string rest = " is not supported: its points do not have three coordinates, expected OFF, COFF or NOFF";
  EXPECT_EQ(error_of("4OFF\n1 0 0\n0 0 0 1\n"), "f:1: 4OFF" + rest);
  EXPECT_EQ(error_of("nOFF\n2\n1 0 0\n0 0\n"), "f:1: nOFF" + rest);
}

TEST(ReadOff, BinaryIsRefusedByName) {
  EXPECT_EQ(error_of("OFF BINARY\n\1\2"), "f:1: binary OFF is not supported, expected ASCII OFF");
}

TEST(ReadOff, FacesOfFewerThanThreeCornersAreSkippedAndCounted) {
  const ParsedMesh parsed = parse("OFF\n3 3 0\n" + kVertices + "2 0 1\n3 0 1 2\n0\n");
  EXPECT_EQ(parsed.mesh.triangles, kOneTriangle);
  EXPECT_EQ(parsed.warnings,
            (std::vector<Warning>{{"skipped-faces", "2 faces with fewer than three corners skipped"}}));
}

TEST(ReadOff, LinesAfterTheLastFaceAreWarnedAbout) {
  EXPECT_EQ(parse("OFF\n3 1 0\n" + kVertices + "3 0 1 2\n3 0 1 2\n").warnings,
            (std::vector<Warning>{{"trailing-data", "lines after the last face ignored"}}));
}

TEST(ReadOff, NonFiniteCoordinateIsAnErrorOnlyOfAFace) {
  EXPECT_EQ(error_of("OFF\n3 1 0\n0 0 0\nnan 0 0\n0 1 0\n3 0 1 2\n"),
            "f:4: a vertex that faces use has a coordinate that is not finite, expected finite numbers");
  EXPECT_EQ(triangles("OFF\n4 1 0\n" + kVertices + "nan inf 1e400\n3 0 1 2\n"), kOneTriangle);
}

TEST(ReadOff, BadHeadersAreNamed) {
  EXPECT_EQ(error_of("OOF\n"), "f:1: expected 'OFF', found 'OOF'");
  EXPECT_EQ(error_of(" \n"), "f:2: expected 'OFF', found the end of the file");
  EXPECT_EQ(error_of("OFF\n"), "f:2: expected the number of vertices, found the end of the file");
  EXPECT_EQ(error_of("OFF\nx 1 0\n"), "f:2: expected the number of vertices, found 'x'");
  EXPECT_EQ(error_of("OFF\n3\n"), "f:2: expected the number of faces, found the end of the line");
  EXPECT_EQ(error_of("OFF\n3 -1 0\n" + kVertices), "f:2: expected 0 or more faces, found -1");
}

TEST(ReadOff, CountsThatTheFileCannotHoldAreRefusedBeforeAllocating) {
  EXPECT_EQ(error_of("OFF\n1000000000000 1 0\n" + kVertices),
            "f:2: 1000000000000 vertices announced, but only 18 bytes follow");
  EXPECT_EQ(error_of("OFF\n3 99999999999999999999 0\n" + kVertices),
            "f:2: 9223372036854775807 faces announced, but only 18 bytes follow");
}

TEST(ReadOff, MissingRowsAreCounted) {
  EXPECT_EQ(error_of("OFF\n3 2 0\n" + kVertices + "3 0 1 2\n"), "f:7: the file ends after 1 of 2 faces");
  EXPECT_EQ(error_of("OFF\n3 0 0\n0 0 0\n1 0 0 # 0 1 0\n"), "f:5: the file ends after 2 of 3 vertices");
}

TEST(ReadOff, BadRowsAreNamed) {
  EXPECT_EQ(error_of("OFF\n3 1 0\n0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
            "f:3: expected a coordinate, found the end of the line");
  EXPECT_EQ(error_of("OFF\n3 1 0\n" + kVertices + "3 0 1\n"),
            "f:6: expected a vertex index, found the end of the line");
  EXPECT_EQ(error_of("OFF\n3 1 0\n" + kVertices + "3 0 1 3\n"), "f:6: face index 3, but there are only 3 vertices");
  EXPECT_EQ(error_of("OFF\n3 1 0\n" + kVertices + "3 0 1 -1\n"), "f:6: face index -1, but there are only 3 vertices");
  EXPECT_EQ(error_of("OFF\n3 1 0\n" + kVertices + "-3 0 1 2\n"), "f:6: expected 0 or more corners, found -3");
  EXPECT_EQ(error_of("OFF\n3 1 0\n" + kVertices + "x\n"), "f:6: expected the number of corners, found 'x'");
}

TEST(ReadOff, EveryTruncationLoadsOrIsRefused) {
  // Only "...3 0 1 2" without what follows loads: the line end, and the comment byte by byte.
  EXPECT_EQ(count_loading_prefixes(read_off, "OFF # c\n3 1 0\n" + kVertices + "3 0 1 2 # c\n"), 5);
}

}  // namespace
}  // namespace raycone
