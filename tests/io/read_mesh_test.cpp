// Dispatch, loading from files, and all shared real meshes in OBJ, PLY, STL and OFF.
#include "io/mesh/read_mesh.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "io/files/file_error.h"
#include "io/files/read_file.h"
#include "io/mesh/mesh_signature.h"
#include "tests/support/error_text.h"
#include "tests/support/temporary_directory.h"

namespace raycone {
namespace {

using test::TemporaryDirectory;

const std::string kObj = "v 1 2 3\nv 4 5 6\nv 7 8 10\nf 1 2 3\n";
const std::string kOff = "OFF\n3 1 0\n1 2 3\n4 5 6\n7 8 10\n3 0 1 2\n";
const std::string kPly =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n1 2 3\n4 5 6\n7 8 10\n3 0 1 2\n";
const std::string kStl =
    "solid\nfacet normal 0 0 0\nouter loop\nvertex 1 2 3\nvertex 4 5 6\nvertex 7 8 10\nendloop\nendfacet\nendsolid\n";
const std::vector<Vec3> kVertices = {{1, 2, 3}, {4, 5, 6}, {7, 8, 10}};

std::string write(const TemporaryDirectory& directory, const std::string& name, const std::string& bytes) {
  std::ofstream(directory / name, std::ios::binary) << bytes;
  return directory / name;
}

// The message without the path that it starts with; empty where the file loads.
std::string error_of(const std::string& path, const ReadMeshOptions& options = {}) {
  const std::string message = test::error_text<InputError>([&] { return read_mesh(path, options); });
  if (message.empty()) return {};
  EXPECT_TRUE(message.starts_with(path)) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  return message.substr(std::min(path.size(), message.size()));
}

std::vector<Vec3> vertices(const std::string& path, const ReadMeshOptions& options = {}) {
  return read_mesh(path, options).parsed.mesh.vertices;
}

TEST(ReadMesh, FormatFollowsFromTheExtensionInAnyCase) {
  const TemporaryDirectory directory;
  EXPECT_EQ(vertices(write(directory, "a.obj", kObj)), kVertices);
  EXPECT_EQ(vertices(write(directory, "a.b.OBJ", kObj)), kVertices);
  EXPECT_EQ(vertices(write(directory, "a.Off", kOff.substr(4))), kVertices);
}

TEST(ReadMesh, WrongExtensionIsHarmlessWhereTheContentHasASignature) {
  const TemporaryDirectory directory;
  for (const std::string& content : {kOff, "C" + kOff, kPly, kStl, " " + kStl})
    EXPECT_EQ(vertices(write(directory, "a.obj", content)), kVertices) << content;
  std::string binary(80 + 4 + 50, '\0');
  binary.replace(0, 8, "OFF 1 2 ");
  binary[80] = 1;
  EXPECT_EQ(vertices(write(directory, "a.ply", binary)), std::vector<Vec3>(3));
}

TEST(ReadMesh, FormatOptionNamesOnlyWhatHasNoSignature) {
  const TemporaryDirectory directory;
  ReadMeshOptions options;
  options.format = MeshFormat::kObj;
  EXPECT_EQ(vertices(write(directory, "a", kObj), options), kVertices);
  EXPECT_EQ(vertices(write(directory, "a", kPly), options), kVertices);
}

TEST(ReadMesh, WhatCannotBeRecognisedIsRefused) {
  const TemporaryDirectory directory;
  EXPECT_EQ(
      error_of(write(directory, "a.txt", kObj)),
      ": not recognised as a mesh, expected OBJ, PLY, STL, OFF, glTF, GLB or 3MF; --mesh-format names the format where "
      "neither content nor extension tells it, as in pipes");
}

TEST(ReadMesh, StandardInputIsReadUnderTheNameOfADash) {
  const TemporaryDirectory directory;
  const int saved = dup(STDIN_FILENO);
  const int file = open(write(directory, "a", kPly).c_str(), O_RDONLY);
  dup2(file, STDIN_FILENO);
  const MeshFile mesh = read_mesh("-");
  lseek(file, 20, SEEK_SET);
  const std::string error = error_of("-");
  dup2(saved, STDIN_FILENO);
  close(file);
  close(saved);
  EXPECT_EQ(mesh.parsed.mesh.vertices, kVertices);
  EXPECT_TRUE(mesh.companions.empty());
  EXPECT_EQ(
      error,
      ": not recognised as a mesh, expected OBJ, PLY, STL, OFF, glTF, GLB or 3MF; --mesh-format names the format where "
      "neither content nor extension tells it, as in pipes");
}

TEST(ReadMesh, FilesThatCannotBeReadAreNamed) {
  const TemporaryDirectory directory;
  EXPECT_EQ(error_of(directory / "none.obj"), ": cannot be read: No such file or directory");
  EXPECT_EQ(error_of(directory.path().string()), ": is a directory, expected a file");
  EXPECT_EQ(error_of(write(directory, "a.obj", "")), ": the file is empty, expected a mesh");
}

TEST(ReadMesh, MeshWithoutTrianglesIsRefused) {
  const TemporaryDirectory directory;
  EXPECT_EQ(error_of(write(directory, "a.obj", "v 0 0 0\n")), ": no triangles, expected at least one");
  EXPECT_EQ(error_of(write(directory, "a.stl", "solid\nendsolid")), ": no triangles, expected at least one");
  EXPECT_EQ(error_of(write(directory, "b.stl", std::string(84, '\0'))), ": no triangles, expected at least one");
}

TEST(ReadMesh, ScaleComesBeforeTurningUp) {
  const TemporaryDirectory directory;
  ReadMeshOptions options;
  options.scale = 1000;
  options.y_up_to_z_up = true;
  EXPECT_EQ(vertices(write(directory, "a.obj", kObj), options),
            (std::vector<Vec3>{{1000, -3000, 2000}, {4000, -6000, 5000}, {7000, -10000, 8000}}));
}

TEST(ReadMesh, ScaleThatOverflowsIsRefused) {
  const TemporaryDirectory directory;
  ReadMeshOptions options;
  options.scale = 1e300;
  EXPECT_EQ(error_of(write(directory, "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1e10 0\nf 1 2 3\n"), options),
            ": a coordinate is not finite after scaling, expected a smaller --scale");
  EXPECT_EQ(error_of(write(directory, "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nv 1e10 0 0\n"), options), "");
}

TEST(ReadMesh, HashAndNameOfTheFileAreReported) {
  const TemporaryDirectory directory;
  const std::string path = write(directory, "a.obj", kObj);
  const MeshFile file = read_mesh(path);
  EXPECT_EQ(file.sha256, sha256(kObj));
  EXPECT_TRUE(file.companions.empty());
}

TEST(RecogniseMesh, GoesByTheSignature) {
  EXPECT_EQ(recognise_mesh("glTF\2"), MeshFormat::kGlb);
  EXPECT_EQ(recognise_mesh(" {\"asset\""), MeshFormat::kGltf);
  EXPECT_EQ(recognise_mesh("ply\rformat"), MeshFormat::kPly);
  EXPECT_EQ(recognise_mesh("\xEF\xBB\xBFply\n"), MeshFormat::kPly);
  EXPECT_EQ(recognise_mesh("\n STCN4nOFF\n"), MeshFormat::kOff);
  EXPECT_EQ(recognise_mesh("OFF8 6 12"), MeshFormat::kOff);
  EXPECT_EQ(recognise_mesh("\tSOLID\n"), MeshFormat::kStl);
}

TEST(RecogniseMesh, HeadersOfBinaryStlMaySayAnything) {
  for (const std::string header : {"ply ", "ply\n", "glTF", "PK\3\4", "OFF ", "{}", "\xEF\xBB\xBFply\n"}) {
    std::string stl =
        header + std::string(80 - header.size(), ' ') + std::string("\2\0\0\0", 4) + std::string(100, '\0');
    EXPECT_EQ(recognise_mesh(stl), MeshFormat::kStl) << header;
    stl.pop_back();  // of another size, its first bytes decide
    EXPECT_NE(recognise_mesh(stl), MeshFormat::kStl) << header;
  }
}

TEST(RecogniseMesh, WordsThatOnlyStartLikeASignatureAreNone) {
  for (const char* text : {"", "plywood", "ply", "OFFICE", "offset", "STOF", "solids", "sol", "v 1 2 3"})
    EXPECT_EQ(recognise_mesh(text), std::nullopt) << text;
}

TEST(MeshFormatFromName, KnowsTheSixFormatsInAnyCase) {
  EXPECT_EQ(mesh_format_from_name("obj"), MeshFormat::kObj);
  EXPECT_EQ(mesh_format_from_name("PLY"), MeshFormat::kPly);
  EXPECT_EQ(mesh_format_from_name("Stl"), MeshFormat::kStl);
  EXPECT_EQ(mesh_format_from_name("off"), MeshFormat::kOff);
  EXPECT_EQ(mesh_format_from_name("gltf"), MeshFormat::kGltf);
  EXPECT_EQ(mesh_format_from_name("glb"), MeshFormat::kGlb);
  EXPECT_EQ(mesh_format_from_name(""), std::nullopt);
  EXPECT_EQ(mesh_format_from_name("objx"), std::nullopt);
}

TEST(Sha256, AgreesWithThePublishedExample) {
  // FIPS 180-2, appendix B.1.
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Sha256, OfAFileIsThatOfItsBytes) {
  const TemporaryDirectory directory;
  const std::string bytes(3'000'000, 'x');  // several blocks
  EXPECT_EQ(sha256_of_file(write(directory, "x", bytes)), sha256(bytes));
  EXPECT_THROW((void)sha256_of_file(directory / "absent"), InputError);
}

TEST(ReadFile, LimitHoldsForFilesAndPipes) {
  const TemporaryDirectory directory;
  const std::string path = write(directory, "a", "12345");
  EXPECT_EQ(read_file(path, 5), "12345");
  EXPECT_THROW(static_cast<void>(read_file(path, 4)), LimitError);
  EXPECT_EQ(read_file("/dev/null", 0), "");
  EXPECT_THROW(static_cast<void>(read_file("/dev/zero", 1000000)), LimitError);
}

// A row of the manifest, by column name.
using Row = std::map<std::string, std::string>;

// Fields of a line of CSV, quotes and doubled quotes undone.
std::vector<std::string> split_csv(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      fields.emplace_back();
    else
      fields.back() += c;
  }
  return fields;
}

std::vector<Row> read_manifest(const std::filesystem::path& path) {
  std::ifstream stream(path);
  std::string line;
  std::getline(stream, line);
  const std::vector<std::string> names = split_csv(line);
  std::vector<Row> rows;
  while (std::getline(stream, line)) {
    const std::vector<std::string> fields = split_csv(line);
    Row& row = rows.emplace_back();
    for (std::size_t i = 0; i < std::min(names.size(), fields.size()); ++i) row[names[i]] = fields[i];
  }
  return rows;
}

// The shared meshes in the formats of this file's readers; empty where the directory is absent.
std::vector<Row> shared_meshes() {
  std::vector<Row> rows = read_manifest(std::filesystem::path(RAYCONE_SHARED_MESHES) / "MANIFEST.csv");
  std::erase_if(rows, [](const Row& row) { return row.at("format").starts_with("gl"); });
  return rows;
}

std::string shared_path(const Row& row) {
  return (std::filesystem::path(RAYCONE_SHARED_MESHES) / row.at("file")).string();
}

// Largest difference between the box of the triangles and the manifest's, relative to its largest coordinate.
double box_error(const TriangleMesh& mesh, const std::string& expected) {
  std::istringstream numbers(expected);
  double largest_difference = 0.0;
  double largest_coordinate = 0.0;
  for (const bool is_lower : {true, false}) {
    for (int axis = 0; axis < 3; ++axis) {
      double bound = mesh.vertices.at(mesh.triangles.at(0)[0])[axis];
      for (const Triangle& triangle : mesh.triangles) {
        for (const std::uint32_t corner : triangle) {
          const double coordinate = mesh.vertices.at(corner)[axis];
          bound = is_lower ? std::min(bound, coordinate) : std::max(bound, coordinate);
        }
      }
      double known = 0.0;
      numbers >> known;
      largest_difference = std::max(largest_difference, std::abs(bound - known));
      largest_coordinate = std::max(largest_coordinate, std::abs(known));
    }
  }
  return largest_difference / largest_coordinate;
}

TEST(SharedMeshes, GoodOnesLoadAsTheManifestSays) {
  const std::vector<Row> rows = shared_meshes();
  if (rows.empty()) GTEST_SKIP() << "no shared meshes in " << RAYCONE_SHARED_MESHES;
  int loaded = 0;
  for (const Row& row : rows) {
    const bool is_good = row.at("expect").starts_with("load") || row.at("file") == "trimesh__notenoughindices.obj";
    if (!is_good) continue;
    SCOPED_TRACE(row.at("file"));
    const ParsedMesh parsed = read_mesh(shared_path(row)).parsed;
    EXPECT_EQ(std::to_string(parsed.mesh.triangles.size()), row.at("faces"));
    EXPECT_EQ(std::to_string(parsed.mesh.vertices.size()), row.at("verts_file"));
    // The manifest prints nine digits.
    EXPECT_LE(box_error(parsed.mesh, row.at("bbox")), 1e-8);
    ++loaded;
  }
  EXPECT_GT(loaded, 100);
}

TEST(SharedMeshes, BadOnesAreRefused) {
  const std::vector<Row> rows = shared_meshes();
  if (rows.empty()) GTEST_SKIP() << "no shared meshes in " << RAYCONE_SHARED_MESHES;
  int refused = 0;
  for (const Row& row : rows) {
    const bool is_bad = !row.at("expect").starts_with("load") && row.at("file") != "trimesh__notenoughindices.obj";
    if (!is_bad) continue;
    EXPECT_NE(error_of(shared_path(row)), "") << row.at("file");
    ++refused;
  }
  EXPECT_GE(refused, 10);
}

TEST(SharedMeshes, OnlyTheKnownOnesAreWarnedAbout) {
  const std::vector<Row> rows = shared_meshes();
  if (rows.empty()) GTEST_SKIP() << "no shared meshes in " << RAYCONE_SHARED_MESHES;
  const std::map<std::string, Warning> known = {
      {"trimesh__notenoughindices.obj", {"skipped-faces", "1 face with fewer than three corners skipped"}},
      {"numpy-stl__HalfDonut.stl",
       {"trailing-data", "bytes after the announced number of triangles (288) ignored: 1"}}};
  for (const Row& row : rows) {
    if (!row.at("expect").starts_with("load") && !known.count(row.at("file"))) continue;
    const std::vector<Warning> warnings = read_mesh(shared_path(row)).parsed.warnings;
    const auto expected = known.find(row.at("file"));
    EXPECT_EQ(warnings, expected == known.end() ? std::vector<Warning>() : std::vector{expected->second})
        << row.at("file");
  }
}

TEST(SharedMeshes, EncodingsOfOneMeshAgree) {
  const std::vector<Row> rows = shared_meshes();
  if (rows.empty()) GTEST_SKIP() << "no shared meshes in " << RAYCONE_SHARED_MESHES;
  const std::filesystem::path derived = std::filesystem::path(RAYCONE_SHARED_MESHES) / "derived";
  const TriangleMesh reference = read_mesh((derived / "spot_low_resolution.obj").string()).parsed.mesh;
  int compared = 0;
  for (const Row& row : rows) {
    if (row.at("expect").find("same mesh") == std::string::npos) continue;
    SCOPED_TRACE(row.at("file"));
    const TriangleMesh mesh = read_mesh(shared_path(row)).parsed.mesh;
    EXPECT_EQ(mesh.triangles, reference.triangles);
    ASSERT_EQ(mesh.vertices.size(), reference.vertices.size());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
      for (int axis = 0; axis < 3; ++axis)  // half a unit in the last place of a float
        ASSERT_NEAR(mesh.vertices[i][axis], reference.vertices[i][axis], std::abs(mesh.vertices[i][axis]) * 0x1p-24);
    ++compared;
  }
  EXPECT_EQ(compared, 5);
}

}  // namespace
}  // namespace raycone
