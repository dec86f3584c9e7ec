// read_gltf on assets made here, on the shared real ones, and on damaged bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "io/files/file_error.h"
#include "io/files/read_file.h"
#include "io/mesh/read_mesh.h"
#include "tests/support/bytes.h"
#include "tests/support/error_text.h"
#include "tests/support/glb.h"
#include "tests/support/temporary_directory.h"

namespace raycone {
namespace {

using test::bytes_of;
using test::glb;
using test::little_endian;
using test::TemporaryDirectory;

std::string base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t j = 0; j < 3; ++j)
      bits = bits << 8 | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0u);
    for (std::size_t j = 0; j < 4; ++j) text += i + j > bytes.size() ? '=' : kDigits[bits >> (18 - 6 * j) & 63];
  }
  return text;
}

// Four corners of a square in the plane z = 0, then six 16-bit indices of two triangles: 48 + 12 bytes.
const std::vector<float> kSquare{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
std::string square_data() { return bytes_of(kSquare) + bytes_of<std::uint16_t>({0, 1, 2, 0, 2, 3}); }

// The parts of a document, by default of the square in one node; a test replaces what it is about.
struct Asset {
  std::string binary = square_data();
  std::string buffers = R"([{"byteLength":60}])";
  std::string views = R"([{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}])";
  std::string accessors = R"([{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
                          R"({"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}])";
  std::string meshes = R"([{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}])";
  std::string nodes = R"([{"mesh":0}])";
  std::string rest = R"("scenes":[{"nodes":[0]}])";

  [[nodiscard]] std::string json() const {
    return R"({"asset":{"version":"2.0"},"buffers":)" + buffers + R"(,"bufferViews":)" + views + R"(,"accessors":)" +
           accessors + R"(,"meshes":)" + meshes + R"(,"nodes":)" + nodes + "," + rest + "}";
  }
  [[nodiscard]] std::string bytes() const { return glb(json(), binary); }
};

ParsedMesh parse(const std::string& bytes) { return read_gltf({"a.glb", "", bytes}, nullptr); }
ParsedMesh parse(const Asset& asset) { return parse(asset.bytes()); }

// The message of the InputError that reading throws; empty if it does not.
template <class Source>
std::string error_of(const Source& source) {
  return test::error_text<InputError>([&] { return parse(source); });
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

using Corners = std::array<Vec3, 3>;

std::vector<Corners> triangles_of(const TriangleMesh& mesh) {
  std::vector<Corners> triangles;
  for (const Triangle& t : mesh.triangles) {
    triangles.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
  }
  return triangles;
}

const std::vector<Corners> kSquareTriangles{{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1, 0}},
                                            {Vec3{0, 0, 0}, Vec3{1, 1, 0}, Vec3{0, 1, 0}}};

// --- Primitives and accessors ---------------------------------------------------------------------------------------

TEST(ReadGltf, GlbOfOneSquareGivesItsTwoTriangles) {
  const ParsedMesh parsed = parse(Asset{});
  EXPECT_EQ(triangles_of(parsed.mesh), kSquareTriangles);
  EXPECT_TRUE(parsed.warnings.empty());
}

TEST(ReadGltf, IndicesOfEveryWidthGiveTheSameTriangles) {
  Asset bytes;
  bytes.binary = bytes_of(kSquare) + bytes_of<std::uint8_t>({0, 1, 2, 0, 2, 3}) + "......";
  bytes.accessors = R"([{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
                    R"({"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"}])";
  EXPECT_EQ(triangles_of(parse(bytes).mesh), kSquareTriangles);

  Asset words;
  words.binary = bytes_of(kSquare) + bytes_of<std::uint32_t>({0, 1, 2, 0, 2, 3});
  words.buffers = R"([{"byteLength":72}])";
  words.views = R"([{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}])";
  words.accessors = R"([{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
                    R"({"bufferView":1,"componentType":5125,"count":6,"type":"SCALAR"}])";
  EXPECT_EQ(triangles_of(parse(words).mesh), kSquareTriangles);
}

TEST(ReadGltf, StripTurnsEveryOtherTriangleSoThatAllFaceOneSide) {
  Asset asset;
  asset.binary = bytes_of(kSquare) + bytes_of<std::uint16_t>({0, 1, 3, 2, 2, 2});
  asset.accessors = R"([{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
                    R"({"bufferView":1,"componentType":5123,"count":4,"type":"SCALAR"}])";
  asset.meshes = R"([{"primitives":[{"attributes":{"POSITION":0},"indices":1,"mode":5}]}])";
  const auto triangles = triangles_of(parse(asset).mesh);
  ASSERT_EQ(triangles.size(), 2u);
  for (const Corners& t : triangles) EXPECT_GT(cross(t[1] - t[0], t[2] - t[0]).z, 0.0);
}

TEST(ReadGltf, FanWithoutIndicesGivesTheSquare) {
  Asset asset;
  asset.meshes = R"([{"primitives":[{"attributes":{"POSITION":0},"mode":6}]}])";
  EXPECT_EQ(triangles_of(parse(asset).mesh), kSquareTriangles);
}

TEST(ReadGltf, TriangleListWithoutIndicesSkipsTheIncompleteFace) {
  Asset asset;
  asset.meshes = R"([{"primitives":[{"attributes":{"POSITION":0}}]}])";
  const ParsedMesh parsed = parse(asset);
  EXPECT_EQ(parsed.mesh.triangles.size(), 1u);
  EXPECT_EQ(parsed.skipped_faces, 1u);
  ASSERT_EQ(parsed.warnings.size(), 1u);
  EXPECT_EQ(parsed.warnings[0], (Warning{"skipped-faces", "1 face with fewer than three corners skipped"}));
}

TEST(ReadGltf, PointsAndLinesAreIgnoredWithAWarning) {
  Asset asset;
  asset.meshes = R"([{"primitives":[{"attributes":{"POSITION":0},"mode":0},{"attributes":{"POSITION":0},"mode":3},)"
                 R"({"attributes":{"POSITION":0},"indices":1}]}])";
  const ParsedMesh parsed = parse(asset);
  EXPECT_EQ(parsed.mesh.triangles.size(), 2u);
  ASSERT_EQ(parsed.warnings.size(), 1u);
  EXPECT_EQ(parsed.warnings[0], (Warning{"points-or-lines", "2 primitives of points or lines ignored"}));
}

TEST(ReadGltf, InterleavedPositionsAreReadByTheirStride) {
  Asset asset;
  std::vector<float> interleaved;
  for (std::size_t i = 0; i < 4; ++i) {
    interleaved.insert(interleaved.end(), {9, kSquare[3 * i], kSquare[3 * i + 1], kSquare[3 * i + 2]});
  }
  asset.binary = bytes_of(interleaved);
  asset.buffers = R"([{"byteLength":64}])";
  asset.views = R"([{"buffer":0,"byteLength":64,"byteStride":16}])";
  asset.accessors = R"([{"bufferView":0,"byteOffset":4,"componentType":5126,"count":4,"type":"VEC3"}])";
  asset.meshes = R"([{"primitives":[{"attributes":{"POSITION":0},"mode":6}]}])";
  EXPECT_EQ(triangles_of(parse(asset).mesh), kSquareTriangles);
}

// The square, but for the corners with these numbers.
Asset with_corners_instead(const std::vector<std::uint16_t>& numbers, const std::vector<float>& coordinates) {
  Asset asset;
  const std::string count = std::to_string(numbers.size()), size = std::to_string(12 * numbers.size());
  const std::string of_numbers = bytes_of(numbers), padding(of_numbers.size() % 4, '\0');
  const std::string begin = std::to_string(60 + of_numbers.size() + padding.size());
  asset.binary = square_data() + of_numbers + padding + bytes_of(coordinates);
  asset.buffers = R"([{"byteLength":)" + std::to_string(asset.binary.size()) + "}]";
  asset.views = R"([{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12},)"
                R"({"buffer":0,"byteOffset":60,"byteLength":)" +
                std::to_string(of_numbers.size()) + R"(},{"buffer":0,"byteOffset":)" + begin + R"(,"byteLength":)" +
                size + "}]";
  asset.accessors = R"([{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":)" + count +
                    R"(,"indices":{"bufferView":2,"componentType":5123},"values":{"bufferView":3}}},)"
                    R"({"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}])";
  return asset;
}

TEST(ReadGltf, SparseElementsReplaceThoseOfTheView) {
  const TriangleMesh mesh = parse(with_corners_instead({2}, {5, 6, 7})).mesh;
  EXPECT_EQ(mesh.vertices[2], (Vec3{5, 6, 7}));
  EXPECT_EQ(mesh.vertices[3], (Vec3{0, 1, 0}));
}

TEST(ReadGltf, SparseElementsAreInAscendingOrder) {
  for (const std::uint16_t second : std::array<std::uint16_t, 2>{2, 1}) {
    EXPECT_EQ(error_of(with_corners_instead({2, second}, {5, 6, 7, 8, 9, 10})),
              "a.glb: accessor 0 has sparse index " + std::to_string(second) + " behind 2, expected ascending ones");
  }
}

TEST(ReadGltf, SparseElementsWithoutAViewReplaceZeros) {
  Asset asset;  // indices 0 0 0 0 0 0, but for the three in the middle
  asset.binary = square_data() + bytes_of<std::uint8_t>({1, 2, 3, 0}) + bytes_of<std::uint16_t>({1, 2, 3});
  asset.buffers = R"([{"byteLength":70}])";
  asset.views = R"([{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":60,"byteLength":3},)"
                R"({"buffer":0,"byteOffset":64,"byteLength":6}])";
  asset.accessors = R"([{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
                    R"({"componentType":5123,"count":6,"type":"SCALAR","sparse":{"count":3,"indices":{"bufferView":1,)"
                    R"("componentType":5121},"values":{"bufferView":2}}}])";
  const TriangleMesh mesh = parse(asset).mesh;
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {3, 0, 0}}));
}

TEST(ReadGltf, QuantizedPositionsAreTheRatioToTheLargestInteger) {
  Asset asset;
  asset.binary = bytes_of<std::int8_t>({-128, 127, 64, 0, -127, 1, 0, 0, 1, 0, 0, 0});
  asset.buffers = R"([{"byteLength":12}])";
  asset.views = R"([{"buffer":0,"byteLength":12,"byteStride":4}])";
  asset.accessors = R"([{"bufferView":0,"componentType":5120,"normalized":true,"count":3,"type":"VEC3"}])";
  asset.meshes = R"([{"primitives":[{"attributes":{"POSITION":0}}]}])";
  asset.rest += R"(,"extensionsRequired":["KHR_mesh_quantization"])";
  const TriangleMesh mesh = parse(asset).mesh;
  EXPECT_EQ(mesh.vertices[0], (Vec3{-1.0, 1.0, 64.0 / 127.0}));
  EXPECT_EQ(mesh.vertices[1], (Vec3{-1.0, 1.0 / 127.0, 0.0}));
}

TEST(ReadGltf, QuantizedPositionsThatAreNotNormalizedAreIntegers) {
  Asset asset;
  asset.binary = bytes_of<std::uint16_t>({65535, 1, 0, 0, 0, 7, 0, 0, 0, 0, 0, 0});
  asset.buffers = R"([{"byteLength":24}])";
  asset.views = R"([{"buffer":0,"byteLength":24,"byteStride":8}])";
  asset.accessors = R"([{"bufferView":0,"componentType":5123,"count":3,"type":"VEC3"}])";
  asset.meshes = R"([{"primitives":[{"attributes":{"POSITION":0}}]}])";
  EXPECT_EQ(parse(asset).mesh.vertices[0], (Vec3{65535, 1, 0}));
}

TEST(ReadGltf, PrimitivesThatShareAnAccessorShareItsVertices) {
  Asset asset;
  asset.meshes =
      R"([{"primitives":[{"attributes":{"POSITION":0},"indices":1},{"attributes":{"POSITION":0},"indices":1}]}])";
  const TriangleMesh mesh = parse(asset).mesh;
  EXPECT_EQ(mesh.vertices.size(), 4u);
  EXPECT_EQ(mesh.triangles.size(), 4u);
}

// --- Nodes ----------------------------------------------------------------------------------------------------------

TEST(ReadGltf, NodeTransformsAreComposedFromTheRoot) {
  Asset asset;
  asset.nodes = R"([{"children":[1],"scale":[2,2,2],"translation":[10,0,0]},)"
                R"({"mesh":0,"matrix":[0,1,0,0,-1,0,0,0,0,0,1,0,1,2,3,1]}])";
  // The matrix turns (x, y, z) into (-y, x, z) + (1, 2, 3); its parent doubles and moves by 10.
  EXPECT_EQ(parse(asset).mesh.vertices[1], (Vec3{12, 6, 6}));
}

TEST(ReadGltf, RotationNeedNotBeNormalized) {
  Asset asset;
  asset.nodes = R"([{"mesh":0,"rotation":[0,0,2,0]}])";  // half a turn around z
  EXPECT_EQ(parse(asset).mesh.vertices[2], (Vec3{-1, -1, 0}));
}

TEST(ReadGltf, NegativeDeterminantFlipsTheWinding) {
  Asset asset;
  asset.nodes = R"([{"mesh":0,"scale":[-1,1,1]}])";
  for (const Corners& t : triangles_of(parse(asset).mesh)) EXPECT_GT(cross(t[1] - t[0], t[2] - t[0]).z, 0.0);
  asset.nodes = R"([{"children":[1],"scale":[1,-1,1]},{"mesh":0,"matrix":[-1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}])";
  for (const Corners& t : triangles_of(parse(asset).mesh)) EXPECT_GT(cross(t[1] - t[0], t[2] - t[0]).z, 0.0);
}

// Products of two or three of these entries are 0 in doubles.
TEST(ReadGltf, TinyNegativeDeterminantFlipsTheWinding) {
  for (const char* const matrix : {"1,0,0,0,0,-1e-163,0,0,0,0,1e-163,0", "1e-163,0,0,0,0,1e-163,0,0,0,0,-1,0",
                                   "-1e-200,0,0,0,0,1,0,0,0,0,1e-200,0", "1e300,0,0,0,0,-1e-200,0,0,0,0,1e-200,0",
                                   "1,1e-170,0,0,1,-1e-170,1e-170,0,1,0,2e-170,0"}) {
    Asset asset;
    asset.nodes = std::string(R"([{"mesh":0,"matrix":[)") + matrix + ",0,0,0,1]}]";
    const TriangleMesh mesh = parse(asset).mesh;
    EXPECT_EQ(mesh.triangles.front(), (Triangle{0, 2, 1})) << matrix;
  }
}

TEST(ReadGltf, MeshOfSeveralNodesIsThereSeveralTimes) {
  Asset asset;
  asset.nodes = R"([{"mesh":0,"children":[1,2]},{"mesh":0,"translation":[5,0,0]},{"translation":[7,0,0]}])";
  const TriangleMesh mesh = parse(asset).mesh;
  ASSERT_EQ(mesh.triangles.size(), 4u);
  EXPECT_EQ(mesh.vertices[mesh.triangles[2][0]], (Vec3{5, 0, 0}));
}

TEST(ReadGltf, OnlyTheDefaultSceneIsRead) {
  Asset asset;
  asset.nodes = R"([{"mesh":0},{"mesh":0,"translation":[5,0,0]}])";
  asset.rest = R"("scenes":[{"nodes":[0]},{"nodes":[1]}],"scene":1)";
  EXPECT_EQ(parse(asset).mesh.vertices[0], (Vec3{5, 0, 0}));
  asset.rest = R"("scenes":[{"nodes":[0]},{"nodes":[1]}])";
  EXPECT_EQ(parse(asset).mesh.vertices[0], (Vec3{0, 0, 0}));
  asset.rest = R"("extras":{})";
  EXPECT_EQ(parse(asset).mesh.triangles.size(), 4u);
}

TEST(ReadGltf, WithoutNodesEveryMeshIsTakenAsItIs) {
  Asset asset;
  asset.nodes = "[]";
  asset.rest = R"("scenes":[])";
  const ParsedMesh parsed = parse(asset);
  EXPECT_EQ(parsed.mesh.triangles.size(), 2u);
  EXPECT_EQ(parsed.warnings.size(), 1u);
}

TEST(ReadGltf, SkinnedMeshIgnoresItsNodeAndWarns) {
  Asset asset;
  asset.nodes = R"([{"mesh":0,"skin":0,"translation":[5,0,0]}])";
  const ParsedMesh parsed = parse(asset);
  EXPECT_EQ(triangles_of(parsed.mesh), kSquareTriangles);
  EXPECT_EQ(
      parsed.warnings,
      (std::vector<Warning>{{"bind-pose", "1 skinned mesh instance taken in the bind pose, without its joints"}}));
}

TEST(ReadGltf, MorphTargetsAreLeftOutWithAWarning) {
  Asset asset;
  asset.meshes =
      R"([{"primitives":[{"attributes":{"POSITION":0},"indices":1,"targets":[{"POSITION":0}]}],"weights":[0.5]}])";
  const ParsedMesh parsed = parse(asset);
  EXPECT_EQ(triangles_of(parsed.mesh), kSquareTriangles);
  EXPECT_EQ(parsed.warnings.size(), 1u);
}

TEST(ReadGltf, NodeThatIsItsOwnAncestorIsAnError) {
  Asset asset;
  asset.nodes = R"([{"mesh":0},{"children":[2]},{"children":[1],"mesh":0}])";
  EXPECT_EQ(error_of(asset), "a.glb: some nodes are their own ancestors, expected a tree");
}

TEST(ReadGltf, NodeWithTwoParentsIsShownOnceForEach) {
  Asset asset;
  asset.nodes = R"([{"children":[2]},{"children":[2],"translation":[5,0,0]},{"mesh":0}])";
  asset.rest = R"("scenes":[{"nodes":[0,1]}])";
  const TriangleMesh mesh = parse(asset).mesh;
  ASSERT_EQ(mesh.triangles.size(), 4u);
  EXPECT_EQ(mesh.vertices[mesh.triangles[2][0]], (Vec3{5, 0, 0}));
}

TEST(ReadGltf, SharedChildrenOfSharedChildrenAreALimit) {
  Asset asset;  // 2^40 copies: nodes 2 i and 2 i + 1 both have 2 i + 2 and 2 i + 3 as children
  asset.nodes = "[";
  for (int i = 1; i <= 40; ++i) {
    const std::string children = std::to_string(2 * i) + "," + std::to_string(2 * i + 1);
    for (int k = 0; k < 2; ++k) asset.nodes += R"({"children":[)" + children + "]},";
  }
  asset.nodes += R"({"mesh":0},{"mesh":0}])";
  EXPECT_THROW(static_cast<void>(parse(asset)), LimitError);
}

TEST(ReadGltf, RotationsHaveALength) {
  Asset asset;
  asset.nodes = R"([{"mesh":0,"rotation":[0,0,1e-150,0]}])";
  EXPECT_NEAR(parse(asset).mesh.vertices[1].x, -1, 1e-15);  // roundings of the quaternion's square
  for (const char* const number : {"0", "1e-160", "1e200"}) {
    asset.nodes = std::string(R"([{"mesh":0,"rotation":[0,0,)") + number + R"(,0]}])";
    EXPECT_EQ(error_of(asset), "a.glb: node 0: rotation is not a unit quaternion") << number;
  }
}

TEST(ReadGltf, NodesHaveAChildOnceAndScenesARoot) {
  Asset asset;
  asset.nodes = R"([{"children":[1,2,1]},{"mesh":0},{"mesh":0}])";
  EXPECT_EQ(error_of(asset), "a.glb: node 0 has the child 1 twice, expected once");
  asset.nodes = R"([{"mesh":0},{"mesh":0}])";
  asset.rest = R"("scenes":[{"nodes":[1,0,1]}])";
  EXPECT_EQ(error_of(asset), "a.glb: scene 0 names node 1 twice, expected once");
}

TEST(ReadGltf, SceneMayNameRootNodesOnly) {
  Asset asset;
  asset.nodes = R"([{"children":[1]},{"mesh":0}])";
  constexpr const char* kError = "a.glb: scene 0 names node 1, which is a child of another, expected a root node";
  asset.rest = R"("scenes":[{"nodes":[0,1]}])";
  EXPECT_EQ(error_of(asset), kError);
  asset.rest = R"("scenes":[{"nodes":[1]}])";
  asset.nodes = R"([{"children":[1],"scale":[1,1,2]},{"mesh":0}])";
  EXPECT_EQ(error_of(asset), kError);
  asset.nodes = R"([{"children":[2]},{"mesh":0},{"children":[1],"translation":[0,0,1]}])";
  EXPECT_EQ(error_of(asset), kError);
  asset.nodes = R"([{"children":[1],"extensions":{"KHR_node_visibility":{"visible":false}}},{"mesh":0}])";
  EXPECT_EQ(error_of(asset), kError);
}

// As UniGLTF writes them.
TEST(ReadGltf, NodesInNoSceneThatDoNothingMayHaveItsRootsAsChildren) {
  Asset asset;
  asset.rest = R"("scenes":[{"nodes":[1]}])";
  asset.nodes = R"([{"children":[1],"translation":[0,0,0],"rotation":[0,0,0,1],"scale":[1,1,1]},)"
                R"({"mesh":0,"scale":[2,2,2]}])";
  const ParsedMesh shown = parse(asset);
  asset.rest = R"("scenes":[{"nodes":[0]}])";
  EXPECT_EQ(shown.mesh.vertices, parse(asset).mesh.vertices);
  EXPECT_EQ(shown.mesh.triangles, parse(asset).mesh.triangles);
  EXPECT_FALSE(shown.mesh.triangles.empty());
}

TEST(ReadGltf, ChainOfManyNodesNeedsNoStack) {
  Asset asset;
  constexpr int kNodes = 200000;
  asset.nodes = "[";
  for (int i = 1; i < kNodes; ++i) asset.nodes += R"({"children":[)" + std::to_string(i) + "]},";
  asset.nodes += R"({"mesh":0}])";
  EXPECT_EQ(parse(asset).mesh.triangles.size(), 2u);
}

TEST(ReadGltf, InstancesBeyondAllReasonAreALimit) {
  Asset asset;  // 4000 nodes show a mesh of 4000 primitives: 64 million triangles from 200 kB
  asset.meshes = R"([{"primitives":[)";
  asset.nodes = "[";
  std::string roots;
  for (int i = 0; i < 4000; ++i) {
    const std::string comma = i == 0 ? "" : ",";
    asset.meshes += comma + R"({"attributes":{"POSITION":0},"indices":1})";
    asset.nodes += comma + R"({"mesh":0})";
    roots += comma + std::to_string(i);
  }
  asset.meshes += "]}]";
  asset.nodes += "]";
  asset.rest = R"("scenes":[{"nodes":[)" + roots + "]}]";
  EXPECT_THROW(static_cast<void>(parse(asset)), LimitError);
}

TEST(ReadGltf, AccessorOfManyZerosIsALimit) {
  Asset asset;
  asset.accessors = R"([{"componentType":5126,"count":4000000000,"type":"VEC3"}])";
  asset.meshes = R"([{"primitives":[{"attributes":{"POSITION":0}}]}])";
  EXPECT_THROW(static_cast<void>(parse(asset)), LimitError);
}

// --- Buffers and URIs -----------------------------------------------------------------------------------------------

TEST(ReadGltf, JsonWithADataUriEqualsTheGlb) {
  Asset asset;
  for (const char* scheme :
       {"data:application/octet-stream;base64,", "DATA:;base64,", "data:;BASE64,", "data:text/plain; base64,"}) {
    asset.buffers = R"([{"byteLength":60,"uri":")" + std::string(scheme) + base64(asset.binary) + R"("}])";
    EXPECT_EQ(triangles_of(parse(asset.json()).mesh), kSquareTriangles);
  }
}

TEST(ReadGltf, DamagedBase64IsAnError) {
  Asset asset;
  asset.buffers = R"([{"byteLength":3,"uri":"data:;base64,AA*A"}])";
  EXPECT_EQ(error_of(asset.json()), "a.glb: buffer 0: \"data:;base64\" is not followed by valid base64");
}

TEST(ReadGltf, PercentEncodedFileBesideTheAssetIsReadAndReported) {
  const TemporaryDirectory directory;
  Asset asset;
  std::filesystem::create_directory(directory / "sub dir");
  // One byte more than byteLength, which is allowed.
  std::ofstream(directory / "sub dir/ä.bin", std::ios::binary) << asset.binary << '!';
  asset.buffers = R"([{"byteLength":60,"uri":"sub%20dir/%C3%A4.bin"}])";
  std::vector<FileRead> files;
  const ParsedMesh parsed = read_gltf({"a.gltf", directory.path().string(), asset.json()}, &files);
  EXPECT_EQ(triangles_of(parsed.mesh), kSquareTriangles);
  ASSERT_EQ(files.size(), 1U);
  EXPECT_EQ(files[0].path, directory / "sub dir/ä.bin");
  EXPECT_EQ(files[0].sha256, sha256(asset.binary + '!'));
}

// It counts once in the limits, too.
TEST(ReadGltf, FileOfSeveralBuffersIsReadOnce) {
  const TemporaryDirectory directory;
  Asset asset;
  std::ofstream(directory / "x.bin", std::ios::binary) << asset.binary << std::string(1'200'000, '\0');
  asset.buffers = R"([{"byteLength":48,"uri":"x.bin"},{"byteLength":60,"uri":"./a/../x%2Ebin"}])";
  asset.views = R"([{"buffer":0,"byteLength":48},{"buffer":1,"byteOffset":48,"byteLength":12}])";
  std::vector<FileRead> files;
  const auto read = [&] { return read_gltf({"a.gltf", directory.path().string(), asset.json()}, &files); };
  EXPECT_EQ(triangles_of(read().mesh), kSquareTriangles);
  ASSERT_EQ(files.size(), 1U);
  EXPECT_EQ(files[0].path, directory / "x.bin");
  EXPECT_EQ(files_of_gltf({"a.gltf", directory.path().string(), asset.json()}), std::vector{directory / "x.bin"});
  asset.accessors.insert(asset.accessors.size() - 1, R"(,{"componentType":5126,"count":20000000,"type":"VEC3"})");
  asset.meshes = R"([{"primitives":[{"attributes":{"POSITION":0},"indices":1},{"attributes":{"POSITION":2}}]}])";
  EXPECT_THROW(static_cast<void>(read()), LimitError);
}

TEST(ReadGltf, UriThatLeavesTheDirectoryIsRefusedByName) {
  const TemporaryDirectory directory;
  std::filesystem::create_directory(directory / "inner");
  std::ofstream(directory / "secret.bin", std::ios::binary) << square_data();
  const std::string absolute = directory / "secret.bin";
  for (const std::string& uri :
       {std::string("../secret.bin"), std::string("%2e%2e/secret.bin"), std::string("a/../../secret.bin"), absolute,
        "file://" + absolute, std::string("http://localhost/secret.bin")}) {
    Asset asset;
    asset.buffers = R"([{"byteLength":60,"uri":")" + uri + R"("}])";
    const auto read = [&] { return read_gltf({"a.gltf", directory / "inner", asset.json()}, nullptr); };
    EXPECT_EQ(test::error_text<InputError>(read),
              "a.gltf: buffer 0: \"" + uri + "\" is outside the file's directory, expected a relative path within it");
  }
}

TEST(ReadGltf, FilesThatItRefersToAreNamedThereOrNot) {
  const TemporaryDirectory directory;
  Asset asset;
  asset.buffers = R"([{"byteLength":60,"uri":"a%20b.bin"},{"byteLength":1,"uri":"../c.bin"},
      {"byteLength":1,"uri":"data:,x"},{"byteLength":1},{"byteLength":1,"uri":"d/e.bin"}])";
  const std::vector<std::string> files{directory / "a b.bin", directory / "d/e.bin"};
  EXPECT_EQ(files_of_gltf({"a.gltf", directory.path().string(), asset.json()}), files);
  std::ofstream(directory / "a.mesh", std::ios::binary) << asset.json();
  EXPECT_EQ(files_referred_to(directory / "a.mesh", {.format = MeshFormat::kGltf}), files);
  std::ofstream(directory / "b.obj") << "f 1 2 3\n";
  EXPECT_EQ(files_referred_to(directory / "b.obj"), std::vector<std::string>()) << "no mesh, but it refers to none";
  std::ofstream(directory / "c.stl", std::ios::binary) << asset.json();
  EXPECT_EQ(files_referred_to(directory / "c.stl").size(), 2U) << "its first bytes tell";
  EXPECT_TRUE(may_refer_to_files("a.GLB.gz") && may_refer_to_files("a"));
  EXPECT_FALSE(may_refer_to_files("a.stl") || may_refer_to_files("a", {.format = MeshFormat::kObj}));
}

TEST(ReadGltf, AFileThatIsCalledMinusIsNoStandardInput) {
  Asset asset;
  asset.buffers = R"([{"byteLength":60,"uri":"-"}])";
  EXPECT_EQ(files_of_gltf({"a.gltf", ".", asset.json()}), std::vector<std::string>{"./-"});
}

TEST(ReadGltf, StandardInputCannotReferToFiles) {
  Asset asset;
  asset.buffers = R"([{"byteLength":60,"uri":"x.bin"}])";
  EXPECT_EQ(error_of(asset), "a.glb: buffer 0: \"x.bin\" is another file, which standard input cannot refer to");
}

TEST(ReadGltf, FifoInPlaceOfABufferIsRefused) {
  const TemporaryDirectory directory;
  ASSERT_EQ(std::system(("mkfifo '" + (directory / "x.bin") + "'").c_str()), 0);
  Asset asset;
  asset.buffers = R"([{"byteLength":60,"uri":"x.bin"}])";
  EXPECT_THROW(static_cast<void>(read_gltf({"a.gltf", directory.path().string(), asset.json()}, nullptr)), InputError);
}

TEST(ReadGltf, ImagesMaterialsAndAnimationsAreNeverLookedAt) {
  Asset asset;
  asset.rest += R"(,"images":[{"uri":"data:image/png;base64,"},{"uri":"../no.png"},{"bufferView":99},7],)"
                R"("materials":[{"emissiveFactor":[1,1]}],"textures":3,"animations":[{}],"extras":[[[[]]]])";
  EXPECT_EQ(triangles_of(parse(asset).mesh), kSquareTriangles);
}

// --- Extensions -----------------------------------------------------------------------------------------------------

TEST(ReadGltf, RequiredExtensionsOfAppearanceAreIgnored) {
  Asset asset;
  asset.rest += R"(,"extensionsRequired":["KHR_materials_unlit","KHR_texture_transform","KHR_lights_punctual",)"
                R"("EXT_texture_webp"])";
  EXPECT_EQ(triangles_of(parse(asset).mesh), kSquareTriangles);
}

TEST(ReadGltf, OtherRequiredExtensionsAreRefusedByName) {
  for (const std::string name : {"EXT_meshopt_compression", "VENDOR_unheard_of"}) {
    Asset asset;
    asset.rest += R"(,"extensionsRequired":[")" + name + R"("])";
    EXPECT_EQ(error_of(asset), "a.glb: requires the extension " + name + ", which is not supported");
  }
}

TEST(ReadGltf, MessagesAreOneShortLineWhateverAnExtensionIsCalled) {
  Asset asset;
  asset.rest += R"(,"extensionsRequired":["a\nb\u001b)" + std::string(200, 'c') + R"("])";
  EXPECT_EQ(error_of(asset),
            "a.glb: requires the extension a?b?" + std::string(116, 'c') + "..., which is not supported");
}

TEST(ReadGltf, TextInUtf16IsRefusedByName) {
  EXPECT_EQ(error_of(std::string("\xFF\xFE{\0}\0", 6)), "a.glb: the text is UTF-16, expected UTF-8");
}

TEST(ReadGltf, InstancingIsRefusedAlsoWhereMerelyUsed) {
  Asset asset;
  asset.nodes = R"([{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":0}}}}])";
  EXPECT_EQ(error_of(asset), "a.glb: uses the extension EXT_mesh_gpu_instancing, which is not supported");
}

TEST(ReadGltf, DracoThatIsMerelyUsedNeedsUncompressedData) {
  Asset asset;
  asset.meshes =
      R"([{"primitives":[{"attributes":{"POSITION":0},"indices":1,"extensions":{"KHR_draco_mesh_compression":{}}}]}])";
  EXPECT_EQ(triangles_of(parse(asset).mesh), kSquareTriangles);
  asset.accessors = R"([{"componentType":5126,"count":4,"type":"VEC3"},)"
                    R"({"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}])";
  EXPECT_TRUE(contains(error_of(asset), "KHR_draco_mesh_compression"));
}

TEST(ReadGltf, MeshoptFallbackBufferWithoutDataIsRefusedByName) {
  Asset asset;
  asset.buffers = R"([{"byteLength":60},{"byteLength":60,"extensions":{"EXT_meshopt_compression":{"fallback":true}}}])";
  asset.views = R"([{"buffer":1,"byteLength":48},{"buffer":1,"byteOffset":48,"byteLength":12}])";
  EXPECT_EQ(error_of(asset),
            "a.glb: buffer 1 has no data but those of the extension EXT_meshopt_compression, which is not supported");
}

// --- Broken files ---------------------------------------------------------------------------------------------------

TEST(ReadGltf, IndexOutOfRangeNamesMeshPrimitiveIndexAndCount) {
  Asset asset;
  asset.binary = bytes_of(kSquare) + bytes_of<std::uint16_t>({0, 1, 2, 0, 2, 4});
  EXPECT_EQ(error_of(asset), "a.glb: mesh 0, primitive 0: index 4, but only 4 vertices");
}

TEST(ReadGltf, RestartValueIsAnError) {
  Asset asset;
  asset.binary = bytes_of(kSquare) + bytes_of<std::uint16_t>({0, 1, 2, 0, 2, 65535});
  EXPECT_EQ(error_of(asset), "a.glb: mesh 0, primitive 0: index 65535 is the restart value, expected a vertex");
}

TEST(ReadGltf, NonFinitePositionIsAnErrorOnlyWhereAFaceUsesIt) {
  Asset asset;
  std::vector<float> positions = kSquare;
  positions[9] = std::numeric_limits<float>::infinity();
  asset.binary = bytes_of(positions) + bytes_of<std::uint16_t>({0, 1, 2, 0, 2, 3});
  EXPECT_EQ(error_of(asset),
            "a.glb: mesh 0, primitive 0: vertex 3 is (inf, 1.000000, 0.000000), expected finite coordinates");
  asset.binary = bytes_of(positions) + bytes_of<std::uint16_t>({0, 1, 2, 0, 2, 1});
  EXPECT_EQ(parse(asset).mesh.triangles.size(), 2u);
}

TEST(ReadGltf, TransformThatOverflowsIsAnError) {
  Asset asset;
  asset.nodes = R"([{"children":[1],"scale":[1e300,1,1]},{"mesh":0,"scale":[1e300,1,1]}])";
  EXPECT_EQ(error_of(asset),
            "a.glb: mesh 0: vertex 0 is not finite once its transform is applied, expected finite coordinates");
}

TEST(ReadGltf, AccessorBeyondItsViewIsAnError) {
  for (const char* accessor :
       {R"({"bufferView":0,"componentType":5126,"count":5,"type":"VEC3"})",
        R"({"bufferView":0,"componentType":5126,"count":18446744073709551615,"type":"VEC3"})",
        R"({"bufferView":0,"byteOffset":18446744073709551615,"componentType":5126,"count":4,"type":"VEC3"})"}) {
    Asset asset;
    asset.accessors =
        "[" + std::string(accessor) + R"(,{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}])";
    EXPECT_TRUE(contains(error_of(asset), "a.glb: accessor 0 has ")) << error_of(asset);
  }
}

TEST(ReadGltf, ViewBeyondItsBufferIsAnError) {
  Asset asset;
  asset.views = R"([{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":18446744073709551600,"byteLength":20}])";
  EXPECT_EQ(error_of(asset), "a.glb: bufferView 1: 20 bytes at byte 18446744073709551600, but buffer 0 has only 60");
}

TEST(ReadGltf, BufferShorterThanAnnouncedIsAnError) {
  Asset asset;
  asset.buffers = R"([{"byteLength":64}])";
  EXPECT_EQ(error_of(asset), "a.glb: buffer 0 has 60 bytes, expected 64");
}

// Each of these is silently dropped, cut or wrapped by readers that convert leniently.
TEST(ReadGltf, ReferencesThatAreNotNumbersInRangeAreErrors) {
  Asset asset;
  asset.nodes = R"([{"mesh":4294967296}])";
  EXPECT_EQ(error_of(asset), "a.glb: node 0: mesh refers to mesh 4294967296, but there are only 1");
  asset.nodes = R"([{"mesh":"0"}])";
  EXPECT_EQ(error_of(asset), "a.glb: node 0: mesh is \"0\", expected a non-negative integer");
  asset.nodes = R"([{"mesh":0,"children":[null]}])";
  EXPECT_EQ(error_of(asset), "a.glb: node 0: children holds null, expected a non-negative integer");
  asset = {};
  asset.meshes = R"([{"primitives":[{"attributes":{"POSITION":-1}}]}])";
  EXPECT_EQ(error_of(asset), "a.glb: mesh 0, primitive 0, attributes: POSITION is -1, expected a non-negative integer");
}

TEST(ReadGltf, SyntaxErrorNamesItsLine) {
  EXPECT_EQ(
      error_of(std::string("{\n\"asset\": {\n  oops")),
      "a.glb:3: while parsing object key - invalid literal; last read: '\"asset\": {<U+000A>  o'; expected string "
      "literal, expected a glTF document");
  EXPECT_TRUE(contains(error_of(glb("{x", "")), "a.glb:byte 22: "));
}

TEST(ReadGltf, DeeplyNestedJsonIsAnError) {
  for (const int depth : {300, 20000, 1000000}) {
    Asset asset;
    asset.rest += R"(,"extras":)" + std::string(static_cast<std::size_t>(depth), '[') +
                  std::string(static_cast<std::size_t>(depth), ']');
    EXPECT_EQ(error_of(asset.json()), "a.glb: JSON is nested deeper than 256 levels");
  }
  EXPECT_FALSE(error_of(std::string(1000000, '[')).empty());
}

Asset with_nodes(const std::string& nodes) {
  Asset asset;
  asset.nodes = nodes;
  return asset;
}

TEST(ReadGltf, InvisibleNodesAreHiddenWithTheirChildren) {
  const std::string hidden = R"("extensions":{"KHR_node_visibility":{"visible":false}})";
  const std::string shown = R"("extensions":{"KHR_node_visibility":{"visible":true}})";
  const auto count = [](const std::string& nodes) { return parse(with_nodes(nodes)).mesh.triangles.size(); };
  EXPECT_EQ(count(R"([{"mesh":0},{"mesh":0}])"), 2U);
  EXPECT_EQ(count(R"([{"mesh":0,)" + hidden + R"(}])"), 0U);
  EXPECT_EQ(count(R"([{"mesh":0,)" + shown + R"(}])"), 2U);
  EXPECT_EQ(count(R"([{"mesh":0,"extensions":{"KHR_node_visibility":{}}}])"), 2U);
  EXPECT_EQ(count(R"([{"children":[1,2]},{"mesh":0,"children":[3],)" + hidden + R"(},{"mesh":0},{"mesh":0}])"), 2U);
  // Shared children are shown where one of their parents is.
  EXPECT_EQ(count(R"([{"children":[1,2]},{"children":[3],)" + hidden + R"(},{"children":[3]},{"mesh":0}])"), 2U);
  Asset required = with_nodes(R"([{"mesh":0,)" + hidden + R"(}])");
  required.rest += R"(,"extensionsUsed":["KHR_node_visibility"],"extensionsRequired":["KHR_node_visibility"])";
  EXPECT_EQ(parse(required).mesh.triangles.size(), 0U);
  EXPECT_EQ(error_of(with_nodes(R"([{"mesh":0,"extensions":{"KHR_node_visibility":{"visible":0}}}])")),
            "a.glb: node 0, extensions, KHR_node_visibility: visible is 0, expected true or false");
}

TEST(ReadGltf, TwoMembersOfOneNameAreRefused) {
  EXPECT_EQ(error_of(with_nodes(R"([{"mesh":0,"mesh":0}])")),
            "a.glb: JSON with two members 'mesh' in one object, expected one");
  Asset scenes;
  scenes.rest += R"(,"scenes":[])";
  EXPECT_EQ(error_of(scenes), "a.glb: JSON with two members 'scenes' in one object, expected one");
  EXPECT_EQ(error_of(with_nodes(R"([{"mesh":0,"m\u0065sh":0}])")),  // the same name, written in another way
            "a.glb: JSON with two members 'mesh' in one object, expected one");
  // What is not looked at does no harm.
  EXPECT_EQ(error_of(with_nodes(R"([{"mesh":0,"extras":{"a":1,"a":2},"extras":3}])")), "");
}

TEST(ReadGltf, VersionsThatTakeALaterReaderAreRefused) {
  const auto error = [](const std::string& asset) {
    std::string json = Asset().json();
    json.replace(json.find(R"("version":"2.0")"), 15, asset);
    return error_of(glb(json, square_data()));
  };
  EXPECT_EQ(error(R"("version":"2.0","minVersion":"2.0")"), "");
  EXPECT_EQ(error(R"("version":"2.7","minVersion":"2.0")"), "");
  EXPECT_EQ(error(R"("version":"2.1","minVersion":"1.0")"), "");
  EXPECT_EQ(error(R"("version":"2.1","minVersion":"2.1")"), "a.glb: document: minVersion 2.1, expected glTF 2.0");
  EXPECT_EQ(error(R"("version":"2.0","minVersion":"3.0")"), "a.glb: document: minVersion 3.0, expected glTF 2.0");
  EXPECT_EQ(error(R"("version":"2.0","minVersion":"2.10")"), "a.glb: document: minVersion 2.10, expected glTF 2.0");
  EXPECT_EQ(error(R"("version":"2.0","minVersion":"2")"), "a.glb: document: minVersion 2, expected glTF 2.0");
  EXPECT_EQ(error(R"("version":"2.0","minVersion":2.0)"),
            "a.glb: document, asset: minVersion is 2.0, expected a string");
  EXPECT_EQ(error(R"("version":"2.x")"), "a.glb: document: version 2.x, expected glTF 2.0");
}

TEST(ReadGltf, OldVersionsAreRefused) {
  EXPECT_EQ(error_of(std::string(R"({"asset":{"version":"1.0"}})")), "a.glb: document: version 1.0, expected glTF 2.0");
  EXPECT_EQ(error_of("glTF" + little_endian(1) + little_endian(20) + std::string(8, '\0')),
            "a.glb:byte 4: GLB version 1, expected 2");
}

TEST(ReadGltf, BytesAfterTheAnnouncedLengthAreIgnoredWithAWarning) {
  EXPECT_TRUE(parse(Asset().bytes()).warnings.empty());
  const ParsedMesh parsed = parse(Asset().bytes() + std::string(32, 'x'));
  EXPECT_EQ(triangles_of(parsed.mesh), kSquareTriangles);
  EXPECT_EQ(parsed.warnings, (std::vector<Warning>{{"trailing-data", "bytes after the announced length ignored: 32"}}));
}

TEST(ReadGltf, GlbCutShortAnywhereIsAnError) {
  const std::string whole = Asset{}.bytes();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    // An allocation of exactly this size, so that the address sanitizer sees any read behind its end.
    const std::unique_ptr<char[]> cut(new char[size]);
    std::copy_n(whole.begin(), size, cut.get());
    EXPECT_THROW(static_cast<void>(read_gltf({"a.glb", "", {cut.get(), size}}, nullptr)), InputError) << size;
  }
}

TEST(ReadGltf, FlippedBytesNeverDoMoreThanThrow) {
  Asset asset;
  asset.binary = square_data() + bytes_of<std::uint16_t>({2, 0}) + bytes_of<float>({5, 6, 7});
  asset.buffers = R"([{"byteLength":76}])";
  asset.views = R"([{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12},)"
                R"({"buffer":0,"byteOffset":60,"byteLength":2},{"buffer":0,"byteOffset":64,"byteLength":12}])";
  asset.accessors = R"([{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":1,)"
                    R"("indices":{"bufferView":2,"componentType":5123},"values":{"bufferView":3}}},)"
                    R"({"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}])";
  asset.nodes = R"([{"mesh":0,"children":[1]},{"mesh":0,"scale":[1,2,-3],"rotation":[0,0,1,0]}])";
  const std::string whole = asset.bytes();
  ASSERT_EQ(parse(whole).mesh.triangles.size(), 4u);

  std::mt19937 random(1);
  int accepted = 0;
  for (int i = 0; i < 10000; ++i) {
    std::string damaged = whole;
    const std::size_t flips = 1 + random() % 3;
    for (std::size_t k = 0; k < flips; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
    const std::unique_ptr<char[]> exact(new char[damaged.size()]);
    std::copy(damaged.begin(), damaged.end(), exact.get());
    try {
      const ParsedMesh parsed = read_gltf({"a.glb", "", {exact.get(), damaged.size()}}, nullptr);
      ++accepted;
      for (const Triangle& triangle : parsed.mesh.triangles) {
        for (const std::uint32_t corner : triangle) ASSERT_LT(corner, parsed.mesh.vertices.size());
      }
    } catch (const InputError& error) {
      ASSERT_FALSE(contains(error.what(), "\n"));
    } catch (const LimitError&) {
    }
  }
  EXPECT_GT(accepted, 0);  // else the test would say nothing about what lies behind the parser
}

// --- Shared meshes --------------------------------------------------------------------------------------------------

// The rows of a CSV file by column name (RFC 4180 without line ends in fields).
std::vector<std::map<std::string, std::string>> read_table(const std::string& path) {
  std::ifstream file(path);
  std::vector<std::string> names;
  std::vector<std::map<std::string, std::string>> rows;
  for (std::string line; std::getline(file, line);) {
    std::vector<std::string> fields(1);
    bool quoted = false;
    for (const char c : line) {
      if (c == '"') {
        quoted = !quoted;
      } else if (c == ',' && !quoted) {
        fields.emplace_back();
      } else {
        fields.back() += c;
      }
    }
    if (names.empty()) {
      names = fields;
      continue;
    }
    auto& row = rows.emplace_back();
    for (std::size_t i = 0; i < names.size() && i < fields.size(); ++i) row[names[i]] = fields[i];
  }
  return rows;
}

TEST(ReadGltf, SharedMeshesHaveTheirFacesOrAreRefused) {
  const std::string directory = RAYCONE_SHARED_MESHES;
  if (!std::filesystem::exists(directory + "/MANIFEST.csv")) GTEST_SKIP() << "no shared meshes in " << directory;
  int read = 0;
  for (auto& row : read_table(directory + "/MANIFEST.csv")) {
    const std::filesystem::path path = directory + "/" + row["file"];
    if (path.extension() != ".glb" && path.extension() != ".gltf") continue;
    SCOPED_TRACE(row["file"]);
    const std::string bytes = read_file(path.string());
    const NamedBytes source{path.filename().string(), path.parent_path().string(), bytes};
    if (row["file"] == "draco__Box_Draco.glb") {  // which the manifest takes to be refused
      EXPECT_EQ(read_gltf(source, nullptr).mesh.triangles.size(), 12U);
      continue;
    }
    if (row["expect"].starts_with("refuse")) {
      EXPECT_THROW(static_cast<void>(read_gltf(source, nullptr)), InputError);
      continue;
    }
    const TriangleMesh mesh = read_gltf(source, nullptr).mesh;
    ASSERT_EQ(mesh.triangles.size(), std::stoull(row["faces"]));
    ++read;
    if (mesh.triangles.empty()) continue;
    // The manifest was computed from quaternions as they stand, rounded to the seven digits of a float.
    Vec3 lower = mesh.vertices[mesh.triangles[0][0]];
    Vec3 upper = lower;
    for (const Triangle& triangle : mesh.triangles) {
      for (const std::uint32_t corner : triangle) {
        for (int axis = 0; axis < 3; ++axis) {
          lower[axis] = std::min(lower[axis], mesh.vertices[corner][axis]);
          upper[axis] = std::max(upper[axis], mesh.vertices[corner][axis]);
        }
      }
    }
    std::istringstream box(row["bbox"]);
    for (const Vec3& corner : {lower, upper}) {
      for (int axis = 0; axis < 3; ++axis) {
        double expected = 0.0;
        ASSERT_TRUE(box >> expected);
        EXPECT_NEAR(corner[axis], expected, 1e-7 * (1.0 + std::abs(expected)));
      }
    }
  }
  EXPECT_GT(read, 20);
}

}  // namespace
}  // namespace raycone
