// The PLY reader on good and on broken files in all encodings.
#include <gtest/gtest.h>

#include <bit>

#include "io/mesh/ply.h"
#include "io/mesh/read_mesh.h"
#include "tests/support/error_text.h"
#include "tests/support/reader_checks.h"

namespace raycone {
namespace {

using test::bytes_of;
using test::count_loading_prefixes;

ParsedMesh parse(const std::string& bytes) { return test::parse(read_ply, bytes); }
std::string error_of(const std::string& bytes) { return test::error_of(read_ply, bytes); }
std::vector<Triangle> triangles(const std::string& bytes) { return parse(bytes).mesh.triangles; }

const std::vector<Triangle> kOneTriangle = {{0, 1, 2}};
const std::string kAscii = "ply\nformat ascii 1.0\n";
const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kFaces = "element face 1\nproperty list uchar int vertex_indices\n";
const std::string kHeader = kAscii + "element vertex 3\n" + kXyz + kFaces + "end_header\n";  // nine lines
const std::string kVertices = "0 0 0\n1 0 0\n0 1 0\n";

// Three vertices and a triangle in a binary encoding.
std::string binary_file(bool big_endian, const std::string& line_end = "\n") {
  const bool reversed = big_endian != (std::endian::native == std::endian::big);
  std::string header = "ply\nformat binary_" + std::string(big_endian ? "big" : "little") +
                       "_endian 1.0\nelement vertex 3\nproperty double x\nproperty float y\nproperty short z\n" +
                       kFaces + "end_header\n";
  for (std::size_t at = 0; (at = header.find('\n', at)) != std::string::npos; at += line_end.size())
    header.replace(at, 1, line_end);
  std::string body;
  for (const double v : {0.1, 1.0, 2.0})
    body += bytes_of({v}, reversed) + bytes_of({-2.5f}, reversed) + bytes_of<std::int16_t>({-300}, reversed);
  return header + body + "\3" + bytes_of<std::int32_t>({2, 0, 1}, reversed);
}

TEST(ReadPly, AsciiKeepsTheTextsPrecision) {
  const ParsedMesh parsed = parse(kHeader + "0.1 0 0\n1 0 0\n0 1 0\n3 1 2 0\n");
  EXPECT_EQ(parsed.mesh.vertices, (std::vector<Vec3>{{0.1, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(parsed.mesh.triangles, (std::vector<Triangle>{{1, 2, 0}}));
  EXPECT_TRUE(parsed.warnings.empty());
}

TEST(ReadPly, BinaryOfEitherByteOrderGivesTheSameMesh) {
  for (const bool big_endian : {false, true}) {
    const ParsedMesh parsed = parse(binary_file(big_endian));
    EXPECT_EQ(parsed.mesh.vertices, (std::vector<Vec3>{{0.1, -2.5, -300}, {1, -2.5, -300}, {2, -2.5, -300}}));
    EXPECT_EQ(parsed.mesh.triangles, (std::vector<Triangle>{{2, 0, 1}}));
    EXPECT_TRUE(parsed.warnings.empty());
  }
}

TEST(ReadPly, HeaderLinesMayEndInAnyWay) {
  for (const char* line_end : {"\r\n", "\r", " \n"})
    EXPECT_EQ(triangles(binary_file(false, line_end)), (std::vector<Triangle>{{2, 0, 1}}));
}

TEST(ReadPly, FirstBodyByteMayLookLikeALineEnd) {
  // The body of a file with CR line ends starts with the byte of LF here: the exponent of no real x, but legal.
  std::string file = binary_file(false, "\r");
  file[file.find("end_header\r") + 11] = '\n';
  EXPECT_EQ(triangles(file), (std::vector<Triangle>{{2, 0, 1}}));
}

// 2^16 searches of a list of 2^16 properties would take minutes.
TEST(ReadPly, TakesNoTimeForManyProperties) {
  std::string others, values;
  for (int n = 0; n < 1 << 16; ++n) others += "property uchar p" + std::to_string(n) + "\n", values += " 0";
  const std::string header = kAscii + "element vertex 3\n" + kXyz + others + kFaces + "end_header\n";
  EXPECT_EQ(triangles(header + "0 0 0" + values + "\n1 0 0" + values + "\n0 1 0" + values + "\n3 0 1 2\n"),
            kOneTriangle);
}

TEST(ReadPly, EveryScalarTypeServesForEverything) {
  const auto file = [](const std::string& type, const std::string& zero, const std::string& one, const std::string& two,
                       const std::string& three) {
    return "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty " + type + " x\nproperty " + type +
           " y\nproperty " + type + " z\nelement face 1\nproperty list " + type + " " + type +
           " vertex_index\nend_header\n" + zero + zero + zero + one + zero + zero + zero + one + zero + three + zero +
           one + two;
  };
  const auto check = [&](const char* name, auto number) {
    using Number = decltype(number);
    const auto bytes = [](int value) {
      return bytes_of<Number>({static_cast<Number>(value)}, std::endian::native == std::endian::big);
    };
    const ParsedMesh parsed = parse(file(name, bytes(0), bytes(1), bytes(2), bytes(3)));
    EXPECT_EQ(parsed.mesh.triangles, kOneTriangle) << name;
    EXPECT_EQ(parsed.mesh.vertices, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})) << name;
  };
  check("char", std::int8_t{});
  check("int8", std::int8_t{});
  check("uchar", std::uint8_t{});
  check("uint8", std::uint8_t{});
  check("short", std::int16_t{});
  check("int16", std::int16_t{});
  check("ushort", std::uint16_t{});
  check("uint16", std::uint16_t{});
  check("int", std::int32_t{});
  check("int32", std::int32_t{});
  check("uint", std::uint32_t{});
  check("uint32", std::uint32_t{});
  check("float", float{});
  check("float32", float{});
  check("double", double{});
  check("float64", double{});
}

TEST(ReadPly, AsciiIndicesMayBeWrittenAsFloats) {
  EXPECT_EQ(triangles(kAscii + "element vertex 3\n" + kXyz +
                      "element face 1\nproperty list float float vertex_indices\nend_header\n" + kVertices +
                      "3.0 0 1.0 2e0\n"),
            kOneTriangle);
}

TEST(ReadPly, PolygonIsFannedFromItsFirstCorner) {
  EXPECT_EQ(
      triangles(kAscii + "element vertex 4\n" + kXyz + kFaces + "end_header\n" + kVertices + "1 1 0\n4 3 0 1 2\n"),
      (std::vector<Triangle>{{3, 0, 1}, {3, 1, 2}}));
}

TEST(ReadPly, OtherElementsAndPropertiesArePassedOver) {
  const std::string header =
      "element junk 2\nproperty int a\nproperty list uchar short b\n"
      "element vertex 3\nproperty uchar red\nproperty float x\nproperty list uchar float t\nproperty float y\n"
      "property float z\nelement face 1\nproperty int material\nproperty list uchar int vertex_indices\n"
      "property list uchar float texcoord\nelement empty 9\nelement tail 1\nproperty double q\nend_header\n";
  EXPECT_EQ(
      triangles(kAscii + header + "7 2 -1 5\n7 0\n9 0 0 0 0\n9 1 1 .5 0 0\n9 0 2 nan 1 1 0\n4 3 0 1 2 1 -1.#IND\n0\n"),
      kOneTriangle);
  const std::string row = "\x09" + bytes_of({0.f}) + "\1" + bytes_of({0.f, 0.f, 0.f});
  const ParsedMesh binary = parse("ply\nformat binary_little_endian 1.0\n" + header + bytes_of<std::int32_t>({7}) +
                                  "\2" + bytes_of<std::int16_t>({-1, 5}) + bytes_of<std::int32_t>({7}) +
                                  std::string(1, '\0') + row + row + row + bytes_of<std::int32_t>({4}) + "\3" +
                                  bytes_of<std::int32_t>({0, 1, 2}) + "\1" + bytes_of({0.f}) + bytes_of({0.0}));
  EXPECT_EQ(binary.mesh.triangles, kOneTriangle);
}

TEST(ReadPly, FacesMayPrecedeVertices) {
  EXPECT_EQ(triangles(kAscii + kFaces + "element vertex 3\n" + kXyz + "end_header\n3 0 1 2\n" + kVertices),
            kOneTriangle);
}

TEST(ReadPly, TriangleStripsTurnEverySecondTriangle) {
  EXPECT_EQ(triangles(kAscii + "element vertex 5\n" + kXyz +
                      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" + kVertices +
                      "0 0 1\n0 0 2\n10 0 1 2 3 4 -1 4 3 2 1\n"),
            (std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {4, 3, 2}, {2, 3, 1}}));
}

TEST(ReadPly, StripsOfOneOrTwoVerticesAreSkippedAndCounted) {
  const ParsedMesh parsed = parse(kAscii + "element vertex 3\n" + kXyz +
                                  "element tristrips 2\nproperty list int int vertex_indices\nend_header\n" +
                                  kVertices + "8 0 -1 -1 0 1 2 -1 1\n0\n");
  EXPECT_EQ(parsed.mesh.triangles, kOneTriangle);
  EXPECT_EQ(parsed.skipped_faces, 2u);
}

TEST(ReadPly, CommentsAndObjInfoMayStandAnywhereInTheHeader) {
  EXPECT_EQ(
      triangles("ply\ncomment a\\\nformat ascii 1.0\nobj_info num_cols 512\nelement vertex 3\ncomment\n" + kXyz +
                "comment element vertex 7\n" + kFaces + "comment end_header\nend_header\n" + kVertices + "3 0 1 2"),
      kOneTriangle);
}

TEST(ReadPly, AsciiRowsMayGoOnInTheNextLineButNotShareOne) {
  EXPECT_EQ(triangles(kHeader + "0 0\n0\n1 0 0\n\n0 1 0\n3\n0 1 2\n"), kOneTriangle);
  EXPECT_EQ(error_of(kHeader + "0 0 0 1\n0 0 0 1 0\n3 0 1 2\n"),
            "f:13: 1 element 'face' announced, but only 0 bytes follow");
}

TEST(ReadPly, FacesOfOneOrTwoCornersAreSkippedAndCounted) {
  const ParsedMesh parsed = parse(kHeader + kVertices + "2 0 1\n");
  EXPECT_TRUE(parsed.mesh.triangles.empty());
  EXPECT_EQ(parsed.warnings, (std::vector<Warning>{{"skipped-faces", "1 face with fewer than three corners skipped"}}));
}

TEST(ReadPly, BytesAfterTheLastElementAreWarnedAbout) {
  EXPECT_EQ(parse(kHeader + kVertices + "3 0 1 2\n3 0 1 2").warnings,
            (std::vector<Warning>{{"trailing-data", "bytes after the last element ignored: 7"}}));
  EXPECT_EQ(parse(binary_file(true) + "abc").warnings,
            (std::vector<Warning>{{"trailing-data", "bytes after the last element ignored: 3"}}));
}

TEST(ReadPly, NonFiniteCoordinateIsAnErrorOnlyOfAFace) {
  const std::string message = "a vertex that faces use has a coordinate that is not finite, expected finite numbers";
  EXPECT_EQ(error_of(kHeader + "0 0 0\n\n1 1e400 0\n0 1 0\n3 0 1 2\n"), "f:12: " + message);
  std::string binary = binary_file(false);
  const std::size_t second = binary.find("end_header\n") + 11 + 14;
  binary.replace(second, 8, bytes_of({std::numeric_limits<double>::infinity()}));
  EXPECT_EQ(error_of(binary), "f:byte " + std::to_string(second) + ": " + message);
  EXPECT_EQ(
      triangles(kAscii + "element vertex 4\n" + kXyz + kFaces + "end_header\n" + kVertices + "nan 0 0\n3 0 1 2\n"),
      kOneTriangle);
}

TEST(ReadPly, HeaderLinesOfNoKnownKeywordAreWarnedAbout) {
  const ParsedMesh parsed =
      parse(kAscii + "made_by somebody\n" + kHeader.substr(kAscii.size(), kHeader.size() - kAscii.size() - 11) +
            "units mm 3\nend_header\n" + kVertices + "3 0 1 2\n");
  EXPECT_EQ(parsed.mesh.triangles, kOneTriangle);
  EXPECT_EQ(parsed.warnings,
            (std::vector<Warning>{{"unknown-header-lines", "2 header lines of no known keyword ignored"}}));
}

TEST(ReadPly, RowsLongerThanAnnouncedAreWarnedAbout) {
  const ParsedMesh parsed = parse(kHeader + "0 0 0 9\n1 0 0 # red\n\n0 1 0\n3 0 1 2 255 0 0");
  EXPECT_EQ(parsed.mesh.triangles, kOneTriangle);
  EXPECT_EQ(parsed.mesh.vertices, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(parsed.warnings,
            (std::vector<Warning>{{"long-rows", "3 rows longer than the header announces, what is too much ignored"}}));
  // Behind a row that took numbers of the next line they tell of a wrong header.
  EXPECT_EQ(error_of(kHeader + "0 0 0\n1 0\n0 0 1 0\n3 0 1 2\n"), "f:12: expected the end of the line, found '0'");
}

TEST(ReadPly, BadHeadersAreNamed) {
  EXPECT_EQ(error_of("play\n"), "f:1: expected 'ply' in the first line");
  EXPECT_EQ(error_of("ply\nformat ascii 1.0\n"), "f:3: expected 'end_header', found the end of the file");
  EXPECT_EQ(error_of("ply\nelement vertex 3\n" + kXyz + "end_header\n"), "f:6: the header has no line 'format'");
  EXPECT_EQ(error_of("ply\nformat binary 1.0\n"),
            "f:2: expected 'ascii', 'binary_little_endian' or 'binary_big_endian', found 'binary'");
  EXPECT_EQ(error_of(kAscii + "3 0 1 2\n"), "f:3: expected 'element', 'property' or 'end_header', found '3'");
  EXPECT_EQ(error_of(kAscii + "elements vertex 3\n"), "f:4: expected 'end_header', found the end of the file");
  EXPECT_EQ(error_of(kAscii + "element vertex -3\n"), "f:3: expected 0 or more elements 'vertex', found -3");
  EXPECT_EQ(error_of(kAscii + "element vertex\n"),
            "f:3: expected the number of elements 'vertex', found the end of the line");
  EXPECT_EQ(error_of(kAscii + "element \x1b" + std::string(200, 'x') + " -3\n"),
            "f:3: expected 0 or more elements '?" + std::string(119, 'x') + "...', found -3");
  EXPECT_EQ(error_of(kAscii + "property float x\n"), "f:3: property before the first element");
  EXPECT_EQ(error_of(kAscii + "element vertex 3\nproperty real x\n"),
            "f:4: expected a type such as 'float' or 'int32', found 'real'");
  EXPECT_EQ(error_of(kAscii + "element vertex 3\nproperty float\n"),
            "f:4: expected the property's name, found the end of the line");
  EXPECT_EQ(error_of(kAscii + "end_header\n"), "f:3: the header has no element 'vertex'");
  EXPECT_EQ(error_of(kAscii + "element vertex 0\n" + kXyz + "element vertex 0\nend_header\n"),
            "f:8: the header has two elements 'vertex'");
  EXPECT_EQ(error_of(kAscii + "element vertex 0\nproperty float x\nproperty list int int y\nend_header\n"),
            "f:6: element 'vertex' has no number 'y', expected 'x', 'y' and 'z'");
}

TEST(ReadPly, FacesWithoutAListOfIndicesAreAnError) {
  EXPECT_EQ(error_of(kAscii + "element vertex 3\n" + kXyz +
                     "element face 1\nproperty int vertex_indices\nend_header\n" + kVertices + "0\n"),
            "f:13: element 'face' has no list 'vertex_indices' or 'vertex_index'");
}

TEST(ReadPly, ANumberNamedLikeTheListHidesItNot) {
  const std::string text = kAscii + "element vertex 3\n" + kXyz +
                           "element face 1\nproperty int vertex_indices\nproperty list uchar int vertex_index\n"
                           "end_header\n" +
                           kVertices + "7 3 0 1 2\n";
  EXPECT_EQ(parse(text).mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
}

TEST(ReadPly, CountsThatTheFileCannotHoldAreRefusedBeforeAllocating) {
  EXPECT_EQ(error_of(kAscii + "element vertex 1000000000000\n" + kXyz + "end_header\n" + kVertices),
            "f:8: 1000000000000 elements 'vertex' announced, but only 18 bytes follow");
  const std::string binary = "ply\nformat binary_little_endian 1.0\n";
  const std::string vertices = binary + "element vertex 99999999999999999999\n" + kXyz + "end_header\n";
  EXPECT_EQ(error_of(vertices + std::string(24, '\0')),
            "f:byte " + std::to_string(vertices.size()) +
                ": 9223372036854775807 elements 'vertex' announced, but only 24 bytes follow");
  const std::string faces = binary + "element vertex 0\n" + kXyz +
                            "element face 1\nproperty list uint double vertex_indices\nend_header\n\xff\xff\xff\xff";
  EXPECT_EQ(error_of(faces), "f:byte " + std::to_string(faces.size()) + ": the file ends within an element");
}

TEST(ReadPly, ElementsWithoutPropertiesTakeNoTime) {
  EXPECT_EQ(triangles(kAscii + "element nothing 9000000000000000000\nelement vertex 3\n" + kXyz + kFaces +
                      "end_header\n" + kVertices + "3 0 1 2\n"),
            kOneTriangle);
}

TEST(ReadPly, BadRowsAreNamed) {
  EXPECT_EQ(error_of(kHeader + "0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n"), "f:11: expected a number, found 'x'");
  EXPECT_EQ(error_of(kHeader + kVertices + "3 0 1 3\n"), "f:13: face index 3, but there are only 3 vertices");
  EXPECT_EQ(error_of(kHeader + kVertices + "3 0 1 -1\n"), "f:13: face index -1, but there are only 3 vertices");
  EXPECT_EQ(error_of(kHeader + kVertices + "3 0 1 1.5\n"), "f:13: expected an integer, found '1.5'");
  EXPECT_EQ(error_of(kHeader + kVertices + "-3 0 1 2\n"), "f:13: list of length -3, expected 0 or more");
  EXPECT_EQ(error_of(kHeader + kVertices + "3 0 1\n"), "f:14: expected an integer, found the end of the file");
  std::string binary = binary_file(true);
  binary.back() = '\3';
  EXPECT_EQ(error_of(binary),
            "f:byte " + std::to_string(binary.size() - 4) + ": face index 3, but there are only 3 vertices");
}

TEST(ReadPly, EveryTruncationLoadsOrIsRefused) {
  EXPECT_EQ(count_loading_prefixes(read_ply, kHeader + kVertices + "3 0 1 2\n"), 1);  // without the last line end
  EXPECT_EQ(count_loading_prefixes(read_ply, binary_file(false)), 0);
  EXPECT_EQ(count_loading_prefixes(read_ply, binary_file(true, "\r\n")), 0);
}

TEST(ReadPlyVertices, ReadsAllVerticesWithoutLookingAtFaces) {
  const std::vector<Vec3> expected = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::string with_bad_face = kHeader + kVertices + "nonsense";
  EXPECT_EQ(read_ply_vertices({"f", "", with_bad_face}), expected);
  const std::string without_faces = kAscii + "element vertex 3\n" + kXyz + "end_header\n" + kVertices;
  EXPECT_EQ(read_ply_vertices({"f", "", without_faces}), expected);
  const std::string behind_faces = kAscii + kFaces + "element vertex 3\n" + kXyz + "end_header\n3 9 9 9\n" + kVertices;
  EXPECT_EQ(read_ply_vertices({"f", "", behind_faces}), expected);
  EXPECT_EQ(read_ply_vertices({"f", "", binary_file(true)}).size(), 3u);
}

TEST(ReadPlyVertices, NonFiniteVertexIsNamed) {
  const std::string file = kAscii + "element vertex 2\n" + kXyz + "end_header\n0 0 0\n0 -inf 0\n";
  EXPECT_EQ(test::error_text<InputError>([&] {
              return read_ply_vertices({"f", "", file});
            }),
            "f:9: vertex 1 has a coordinate that is not finite, expected finite numbers");
}

}  // namespace
}  // namespace raycone
