// Reading of triangle meshes: OBJ, PLY, STL, OFF, glTF, GLB and 3MF. What each reader accepts: docs/formats.md.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/data/polygon_fan.h"
#include "core/data/triangle_mesh.h"
#include "core/data/warning.h"
#include "io/files/named_bytes.h"
#include "io/mesh/face_groups.h"

namespace raycone {

enum class MeshFormat { kObj, kPly, kStl, kOff, kGltf, kGlb, k3mf };

// "obj", "ply", "stl", "off", "gltf", "glb", "3mf".
[[nodiscard]] std::vector<std::string> mesh_format_names();
// In any case.
[[nodiscard]] std::optional<MeshFormat> mesh_format_from_name(std::string_view name);

struct ReadMeshOptions {
  std::optional<MeshFormat> format;  // where the content does not tell; without, the extension does
  double scale = 1.0;                // multiplies every coordinate
  bool y_up_to_z_up = false;         // (x, y, z) becomes (x, -z, y), after scaling
};

// What a format's reader returns.
struct ParsedMesh {
  TriangleMesh mesh;                 // polygons as fans around their first corners
  std::vector<PolygonFan> polygons;  // those of more than three corners, which may leave the polygon if it is concave
  std::uint64_t skipped_faces = 0;   // faces of one or two corners
  std::vector<Warning> warnings;     // one per kind, with its count
  FaceGroups groups;
  std::string unit;  // of length, as the file names it; empty where its format has none
};

struct FileRead {
  std::string path;
  std::string sha256;  // of the bytes that were read, 64 hexadecimal digits

  friend bool operator==(const FileRead&, const FileRead&) = default;
};

struct MeshFile {
  ParsedMesh parsed;
  std::string sha256;                // of the file's bytes, 64 hexadecimal digits
  std::vector<FileRead> companions;  // further files, which the mesh refers to
};

// Reads `path`, or standard input for "-". At least one triangle, all indices in range, all vertices of triangles
// finite; else, or where the file cannot be read, throws InputError. LimitError where it takes too much memory.
[[nodiscard]] MeshFile read_mesh(const std::string& path, const ReadMeshOptions& options = {});

// Whether a mesh may refer to further files, as far as its name and `options` tell: all but glTF do not.
[[nodiscard]] bool may_refer_to_files(const std::string& path, const ReadMeshOptions& options = {});

// The further files that a mesh in a regular file refers to, there or not, whether or not it is good otherwise. Of
// other formats than glTF only the first bytes are read. Throws as read_mesh().
[[nodiscard]] std::vector<std::string> files_referred_to(const std::string& path, const ReadMeshOptions& options = {});

// The readers behind it, one per format: same guarantees but for "at least one triangle" and sha256.
[[nodiscard]] ParsedMesh read_obj(const NamedBytes& source);
[[nodiscard]] ParsedMesh read_ply(const NamedBytes& source);
[[nodiscard]] ParsedMesh read_stl(const NamedBytes& source);
[[nodiscard]] ParsedMesh read_off(const NamedBytes& source);
// glTF (JSON) or GLB, told apart by content. Files referred to are appended to *companions.
[[nodiscard]] ParsedMesh read_gltf(const NamedBytes& source, std::vector<FileRead>* companions);
// The paths of the files that its buffers name, but for those that are refused wherever they are.
[[nodiscard]] std::vector<std::string> files_of_gltf(const NamedBytes& source);
// The items of the build, components resolved, in the file's unit. Groups are objects with triangles.
[[nodiscard]] ParsedMesh read_3mf(const NamedBytes& source);

}  // namespace raycone
