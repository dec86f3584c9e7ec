// KHR_draco_mesh_compression: meshes compressed here by Draco's encoder against their uncompressed twins, and damaged
// streams.
#include <draco/compression/encode.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "io/files/file_error.h"
#include "io/mesh/read_mesh.h"
#include "tests/support/bytes.h"
#include "tests/support/error_text.h"
#include "tests/support/glb.h"

namespace raycone {
namespace {

using Corners = std::array<Vec3, 3>;

// A grid of 2 n^2 triangles over a wave, its coordinates floats of few digits.
TriangleMesh wave(std::uint32_t n) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i <= n; ++i) {
    for (std::uint32_t j = 0; j <= n; ++j) {
      mesh.vertices.push_back({i * 0.25, j * 0.25, static_cast<double>((i * i + 3 * j) % 7) * 0.125});
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  }
  return mesh;
}

struct Encoding {
  int method = draco::MESH_EDGEBREAKER_ENCODING;
  int bits = 0;  // of quantization; 0: none
  int speed = 5;
};

template <class Number>
void add_positions(draco::Mesh& target, const TriangleMesh& mesh, draco::DataType type) {
  draco::GeometryAttribute attribute;
  attribute.Init(draco::GeometryAttribute::POSITION, nullptr, 3, type, false, 3 * sizeof(Number), 0);
  const int id = target.AddAttribute(attribute, true, static_cast<std::uint32_t>(mesh.vertices.size()));
  for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vec3& v = mesh.vertices[i];
    const std::array numbers{static_cast<Number>(v.x), static_cast<Number>(v.y), static_cast<Number>(v.z)};
    target.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), numbers.data());
  }
}

std::string compressed(const TriangleMesh& mesh, const Encoding& encoding, draco::DataType type = draco::DT_FLOAT32) {
  draco::Mesh target;
  target.set_num_points(static_cast<std::uint32_t>(mesh.vertices.size()));
  for (const Triangle& t : mesh.triangles) {
    target.AddFace({draco::PointIndex(t[0]), draco::PointIndex(t[1]), draco::PointIndex(t[2])});
  }
  if (type == draco::DT_INT16) {
    add_positions<std::int16_t>(target, mesh, type);
  } else {
    add_positions<float>(target, mesh, type);
  }
  draco::Encoder encoder;
  encoder.SetEncodingMethod(encoding.method);
  encoder.SetSpeedOptions(encoding.speed, encoding.speed);
  if (encoding.bits > 0) encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, encoding.bits);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(target, &buffer).ok());
  return {buffer.data(), buffer.size()};
}

// The parts of a document that a test replaces.
struct Asset {
  std::size_t vertices = 0;
  std::size_t corners = 0;
  std::string position_accessor = R"("componentType":5126,"type":"VEC3")";
  std::string extension = R"({"bufferView":0,"attributes":{"POSITION":0}})";
  std::string mode = "4";
  std::string indices = R"(,"indices":1)";
  std::string required = R"(,"extensionsRequired":["KHR_draco_mesh_compression"])";
  std::string more_views;
  std::size_t primitives = 1;
};

Asset asset_of(const TriangleMesh& mesh) {
  Asset asset;
  asset.vertices = mesh.vertices.size();
  asset.corners = 3 * mesh.triangles.size();
  return asset;
}

std::string glb(const Asset& asset, const std::string& draco, const std::string& more = "") {
  const std::string binary = draco + more;
  const std::string primitive = R"({"attributes":{"POSITION":0},"mode":)" + asset.mode + asset.indices +
                                R"(,"extensions":{"KHR_draco_mesh_compression":)" + asset.extension + "}}";
  std::string primitives = primitive;
  for (std::size_t n = 1; n < asset.primitives; ++n) primitives += ',' + primitive;
  const std::string json = R"({"asset":{"version":"2.0"},"extensionsUsed":["KHR_draco_mesh_compression"])" +
                           asset.required + R"(,"buffers":[{"byteLength":)" + std::to_string(binary.size()) +
                           R"(}],"bufferViews":[{"buffer":0,"byteLength":)" + std::to_string(draco.size()) + "}" +
                           asset.more_views + R"(],"accessors":[{)" + asset.position_accessor + R"(,"count":)" +
                           std::to_string(asset.vertices) + R"(},{"componentType":5125,"type":"SCALAR","count":)" +
                           std::to_string(asset.corners) + R"(}],"meshes":[{"primitives":[)" + primitives +
                           R"(]}],"nodes":[{"mesh":0}]})";
  return test::glb(json, binary);
}

// The bytes in an allocation of their size, so that the address sanitizer sees any read behind its end.
ParsedMesh parse(const std::string& bytes) {
  const std::unique_ptr<char[]> exact(new char[bytes.size()]);
  std::copy(bytes.begin(), bytes.end(), exact.get());
  return read_gltf({"a.glb", "", {exact.get(), bytes.size()}}, nullptr);
}

std::string error_of(const std::string& bytes) {
  return test::error_text<InputError>([&] { return parse(bytes); });
}

// Sorted, each from its smallest corner on: the encoder reorders faces and turns their corners.
std::vector<Corners> triangles_of(const TriangleMesh& mesh) {
  const auto less = [](const Vec3& a, const Vec3& b) { return lexicographic_order(a, b) < 0; };
  std::vector<Corners> triangles;
  for (const Triangle& t : mesh.triangles) {
    Corners corners{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end(), less), corners.end());
    triangles.push_back(corners);
  }
  std::sort(triangles.begin(), triangles.end(), [&](const Corners& a, const Corners& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), less);
  });
  return triangles;
}

TEST(ReadGltfDraco, LosslessDataGiveTheUncompressedMesh) {
  const TriangleMesh mesh = wave(9);
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    for (const int speed : {0, 5, 10}) {
      const ParsedMesh parsed = parse(glb(asset_of(mesh), compressed(mesh, {method, 0, speed})));
      EXPECT_EQ(triangles_of(parsed.mesh), triangles_of(mesh)) << method << " " << speed;
      EXPECT_TRUE(parsed.warnings.empty());
    }
  }
}

TEST(ReadGltfDraco, QuantizedDataAreOffByHalfAStepAtMost) {
  const TriangleMesh mesh = wave(9);
  const double range = 9 * 0.25;
  for (const int bits : {8, 11, 14}) {
    const ParsedMesh parsed = parse(glb(asset_of(mesh), compressed(mesh, {draco::MESH_SEQUENTIAL_ENCODING, bits, 10})));
    ASSERT_EQ(parsed.mesh.triangles.size(), mesh.triangles.size());
    double largest = 0.0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const Vec3 off =
            parsed.mesh.vertices[parsed.mesh.triangles[i][corner]] - mesh.vertices[mesh.triangles[i][corner]];
        largest = std::max({largest, std::abs(off.x), std::abs(off.y), std::abs(off.z)});
      }
    }
    EXPECT_LE(largest, 0.5001 * range / ((1 << bits) - 1) + 1e-6);
    EXPECT_GT(largest, 0.0);  // else the bound would say nothing
  }
}

TEST(ReadGltfDraco, NormalizedIntegersAreTheRatioToTheLargest) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, -32768}, {32767, 0, 0}, {0, 16384, 1}};
  mesh.triangles = {{0, 1, 2}};
  Asset asset = asset_of(mesh);
  asset.position_accessor = R"("componentType":5122,"normalized":true,"type":"VEC3")";
  const Encoding sequential{draco::MESH_SEQUENTIAL_ENCODING};
  const TriangleMesh read = parse(glb(asset, compressed(mesh, sequential, draco::DT_INT16))).mesh;
  for (Vec3& v : mesh.vertices) v = {v.x / 32767, v.y / 32767, std::max(v.z / 32767, -1.0)};
  EXPECT_EQ(triangles_of(read), triangles_of(mesh));
}

TEST(ReadGltfDraco, IndicesMayBeLeftOut) {
  const TriangleMesh mesh = wave(3);
  Asset asset = asset_of(mesh);
  asset.indices = "";
  EXPECT_EQ(triangles_of(parse(glb(asset, compressed(mesh, {}))).mesh), triangles_of(mesh));
}

TEST(ReadGltfDraco, UncompressedDataAreTakenWhereTheExtensionIsNotRequired) {
  const TriangleMesh mesh = wave(2);
  const TriangleMesh other = wave(3);  // so that it shows which of the two was read
  std::vector<float> positions;
  std::vector<std::uint32_t> corners;
  for (const Vec3& v : other.vertices) {
    for (int axis = 0; axis < 3; ++axis) positions.push_back(static_cast<float>(v[axis]));
  }
  for (const Triangle& t : other.triangles) corners.insert(corners.end(), t.begin(), t.end());
  std::string draco = compressed(mesh, {});
  while (draco.size() % 4 != 0) draco += '\0';
  const std::size_t first = 4 * positions.size(), second = 4 * corners.size();
  const std::string more = test::bytes_of(positions) + test::bytes_of(corners);
  Asset asset = asset_of(other);
  asset.required = "";
  asset.indices = R"(,"indices":2)";
  asset.more_views = R"(,{"buffer":0,"byteOffset":)" + std::to_string(draco.size()) + R"(,"byteLength":)" +
                     std::to_string(first) + R"(},{"buffer":0,"byteOffset":)" + std::to_string(draco.size() + first) +
                     R"(,"byteLength":)" + std::to_string(second) + "}";
  asset.position_accessor = R"("bufferView":2,"componentType":5125,"type":"SCALAR","count":)" +
                            std::to_string(corners.size()) + R"(},{"bufferView":1,"componentType":5126,"type":"VEC3")";
  std::string bytes = glb(asset, draco, more);
  const std::string attribute = R"("attributes":{"POSITION":0},"mode")";
  bytes.replace(bytes.find(attribute), attribute.size(), R"("attributes":{"POSITION":1},"mode")");
  const std::string indices = R"("indices":2)";
  bytes.replace(bytes.find(indices), indices.size(), R"("indices":0)");
  EXPECT_EQ(triangles_of(parse(bytes).mesh), triangles_of(other));

  Asset without = asset_of(mesh);
  without.required = "";
  EXPECT_EQ(triangles_of(parse(glb(without, draco)).mesh), triangles_of(mesh));
}

TEST(ReadGltfDraco, WhatDoesNotAgreeWithTheAccessorsIsAnError) {
  const TriangleMesh mesh = wave(2);
  const std::string draco = compressed(mesh, {});
  const auto error = [&](auto change) {
    Asset asset = asset_of(mesh);
    change(asset);
    return error_of(glb(asset, draco));
  };
  const std::string place = "a.glb: mesh 0, primitive 0: ";
  EXPECT_EQ(error([](Asset&) {}), "");
  EXPECT_EQ(error([](Asset& a) { a.position_accessor = R"("componentType":5122,"type":"VEC3")"; }),
            place + "Draco data hold other positions than their accessor, expected the same type");
  EXPECT_EQ(error([](Asset& a) { a.position_accessor = R"("componentType":5126,"type":"VEC2")"; }),
            "a.glb: accessor 0 holds no positions, expected VEC3 of floats, bytes or shorts");
  EXPECT_EQ(error([](Asset& a) { a.extension = R"({"bufferView":0,"attributes":{"POSITION":7}})"; }),
            place + "Draco data have no attribute 7 for the positions");
  EXPECT_EQ(
      error([](Asset& a) { a.extension = R"({"bufferView":1,"attributes":{"POSITION":0}})"; }),
      "a.glb: mesh 0, primitive 0, extensions, KHR_draco_mesh_compression: bufferView refers to bufferView 1, but "
      "there are only 1");
  EXPECT_EQ(error([](Asset& a) { a.extension = R"({"attributes":{"POSITION":0}})"; }),
            place +
                "has no data but those of the extension KHR_draco_mesh_compression, which lacks a bufferView or the "
                "attribute POSITION");
  EXPECT_EQ(error([](Asset& a) { a.mode = "5"; }), place + "mode 5 with KHR_draco_mesh_compression, expected 4");
}

TEST(ReadGltfDraco, AccessorsMayCountWhatWasThereBeforeCompression) {
  const TriangleMesh mesh = wave(2);
  for (const int more : {-1, 1, 1000}) {
    Asset asset = asset_of(mesh);
    asset.vertices += more;
    asset.corners += 3 * more;
    EXPECT_EQ(triangles_of(parse(glb(asset, compressed(mesh, {}))).mesh), triangles_of(mesh)) << more;
  }
}

TEST(ReadGltfDraco, StreamsOfOtherKindsAreRefused) {
  const TriangleMesh mesh = wave(2);
  const std::string draco = compressed(mesh, {});
  const auto error = [&](std::size_t byte, char value) {
    std::string damaged = draco;
    damaged[byte] = value;
    return error_of(glb(asset_of(mesh), damaged)).substr(28);
  };
  EXPECT_EQ(error(0, 'd'), "Draco data have no valid header");
  EXPECT_EQ(error(5, 1), "Draco data are of version 1.2, expected 2.2");
  EXPECT_EQ(error(7, 0), "Draco data are not those of a triangle mesh");
  EXPECT_EQ(error(8, 9), "Draco data are of an unknown method");
}

// Numbers of 32 bits as Draco writes them: seven bits a byte, the lowest first.
std::string varint(std::uint32_t value) {
  std::string bytes;
  for (; value > 127; value >>= 7) bytes += static_cast<char>(value | 128);
  return bytes + static_cast<char>(value);
}

TEST(ReadGltfDraco, ClaimsFarBeyondTheBytesAreALimit) {
  const std::string header = "DRACO\x02\x02\x01";
  Asset asset;
  asset.vertices = 3'000'000'000;
  asset.corners = 3'000'000'000;
  const std::string flags(2, '\0');
  for (const std::uint32_t faces : {4'000'000U, 1'000'000'000U, 0xFFFFFFFFU}) {
    const std::string sequential = header + '\0' + flags + varint(faces) + varint(3) + std::string(64, '\1');
    EXPECT_THROW(static_cast<void>(parse(glb(asset, sequential))), LimitError) << faces;
    const std::string edgebreaker = header + '\1' + flags + '\0' + varint(3) + varint(faces) + std::string(64, '\1');
    EXPECT_THROW(static_cast<void>(parse(glb(asset, edgebreaker))), LimitError) << faces;
  }
  // Points alone, and connectivities of attributes.
  const std::string points = header + '\0' + flags + varint(1) + varint(0xFFFFFFFFU) + std::string(64, '\1');
  EXPECT_THROW(static_cast<void>(parse(glb(asset, points))), LimitError);
  const std::string seams = header + '\1' + flags + '\0' + varint(3) + varint(100'000) + "\xFF" + std::string(64, '\1');
  EXPECT_THROW(static_cast<void>(parse(glb(asset, seams))), LimitError);
}

// Bytes that hold few faces may take long to decode.
TEST(ReadGltfDraco, DecodingTheSameBytesAgainAndAgainIsALimit) {
  const TriangleMesh mesh = wave(2);
  Asset asset = asset_of(mesh);
  const std::string draco = compressed(mesh, {}) + std::string(std::size_t{3} << 20, '\0');  // behind it
  asset.primitives = 8;
  EXPECT_EQ(parse(glb(asset, draco)).mesh.triangles.size(), 8 * mesh.triangles.size());
  asset.primitives = 9;
  EXPECT_THROW(static_cast<void>(parse(glb(asset, draco))), LimitError);
}

void expect_mesh_or_error(const Asset& asset, const std::string& draco, int& accepted) {
  try {
    const ParsedMesh parsed = parse(glb(asset, draco));
    ++accepted;
    for (const Triangle& triangle : parsed.mesh.triangles) {
      for (const std::uint32_t corner : triangle) ASSERT_LT(corner, parsed.mesh.vertices.size());
    }
  } catch (const InputError& error) {
    ASSERT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  } catch (const LimitError&) {
  }
}

TEST(ReadGltfDraco, DamagedBytesNeverDoMoreThanThrow) {
  const TriangleMesh mesh = wave(5);
  const Asset asset = asset_of(mesh);
  int accepted = 0;
  for (const Encoding& encoding :
       {Encoding{draco::MESH_SEQUENTIAL_ENCODING, 11, 0}, Encoding{draco::MESH_SEQUENTIAL_ENCODING, 0, 10},
        Encoding{draco::MESH_EDGEBREAKER_ENCODING, 11, 0}, Encoding{draco::MESH_EDGEBREAKER_ENCODING, 11, 10}}) {
    const std::string whole = compressed(mesh, encoding);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      ASSERT_NO_FATAL_FAILURE(expect_mesh_or_error(asset, whole.substr(0, size), accepted)) << size;
    }
    for (std::size_t byte = 0; byte < whole.size(); ++byte) {
      for (const int change : {1, 2, 4, 8, 16, 32, 64, 128, 255, 127}) {
        std::string damaged = whole;
        damaged[byte] = static_cast<char>(damaged[byte] ^ change);
        ASSERT_NO_FATAL_FAILURE(expect_mesh_or_error(asset, damaged, accepted)) << byte << " " << change;
      }
    }
  }
  EXPECT_GT(accepted, 0);  // else the test would say nothing about what lies behind the decoder
}

}  // namespace
}  // namespace raycone
