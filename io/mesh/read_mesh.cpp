#include "io/mesh/read_mesh.h"

#include <array>
#include <filesystem>
#include <utility>

#include "core/machine/threads.h"
#include "io/files/ascii.h"
#include "io/files/byte_source.h"
#include "io/files/file_error.h"
#include "io/files/file_identity.h"
#include "io/files/input_buffer.h"
#include "io/files/read_file.h"
#include "io/files/unpack.h"
#include "io/mesh/mesh_builder.h"
#include "io/mesh/mesh_signature.h"

namespace raycone {
namespace {

constexpr std::array<std::pair<std::string_view, MeshFormat>, 7> kFormatNames = {{{"obj", MeshFormat::kObj},
                                                                                  {"ply", MeshFormat::kPly},
                                                                                  {"stl", MeshFormat::kStl},
                                                                                  {"off", MeshFormat::kOff},
                                                                                  {"gltf", MeshFormat::kGltf},
                                                                                  {"glb", MeshFormat::kGlb},
                                                                                  {"3mf", MeshFormat::k3mf}}};

std::optional<MeshFormat> format_from_extension(const std::string& path) {
  const std::string extension = std::filesystem::path(without_packing_extension(path)).extension().string();
  return extension.empty() ? std::nullopt : mesh_format_from_name(std::string_view(extension).substr(1));
}

MeshFormat format_of(const NamedBytes& source, const ReadMeshOptions& options) {
  if (const auto format = recognise_mesh(source.bytes)) return *format;
  if (options.format) return *options.format;
  if (const auto format = format_from_extension(source.name)) return *format;
  throw InputError(source.name + ": not recognised as a mesh, expected OBJ, PLY, STL, OFF, glTF, GLB or 3MF" +
                   "; --mesh-format names the format where neither content nor extension tells it, as in pipes");
}

bool is_gltf(MeshFormat format) { return format == MeshFormat::kGltf || format == MeshFormat::kGlb; }

ParsedMesh parse(const NamedBytes& source, MeshFormat format, std::vector<FileRead>* companions) {
  switch (format) {
    case MeshFormat::kObj:
      return read_obj(source);
    case MeshFormat::kPly:
      return read_ply(source);
    case MeshFormat::kStl:
      return read_stl(source);
    case MeshFormat::kOff:
      return read_off(source);
    case MeshFormat::k3mf:
      return read_3mf(source);
    case MeshFormat::kGltf:
    case MeshFormat::kGlb:
      break;
  }
  return read_gltf(source, companions);
}

void transform(std::vector<Vec3>& vertices, const ReadMeshOptions& options) {
  if (options.scale != 1.0)
    for (Vec3& vertex : vertices) vertex = options.scale * vertex;
  if (options.y_up_to_z_up)
    for (Vec3& vertex : vertices) vertex = {vertex.x, -vertex.z, vertex.y};
}

// The readers checked what the file says; scaling may overflow.
void check_finite(const TriangleMesh& mesh, const std::string& name) {
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle)
      if (!is_finite(mesh.vertices[corner]))
        throw InputError(name + ": a coordinate is not finite after scaling, expected a smaller --scale");
}

// The mesh in `bytes`, which are those of the file at `path`, or what is packed in them.
MeshFile parse_mesh(const std::string& path, std::string_view bytes, std::string_view of_file,
                    const ReadMeshOptions& options) {
  if (bytes.empty()) throw InputError(path + ": the file is empty, expected a mesh");
  const NamedBytes source{path, path == "-" ? "" : directory_of(path), bytes};
  MeshFile file;
  const MeshFormat format = format_of(source, options);
  // Hashing takes longer than parsing where the format is binary; small files are not worth a second thread.
  constexpr std::size_t kLarge = std::size_t{1} << 20;
  parallel_for(2, of_file.size() < kLarge ? 2 : 1, [&](std::size_t begin, std::size_t end) {
    if (begin == 0) file.parsed = parse(source, format, &file.companions);
    if (end == 2) file.sha256 = sha256(of_file);
  });
  if (file.parsed.mesh.triangles.empty()) throw InputError(path + ": no triangles, expected at least one");
  if (file.parsed.mesh.triangles.size() > kMaxTriangles) {
    throw LimitError(path + ": " + std::to_string(file.parsed.mesh.triangles.size()) + " triangles, expected at most " +
                     std::to_string(kMaxTriangles));
  }
  transform(file.parsed.mesh.vertices, options);
  if (options.scale != 1.0) check_finite(file.parsed.mesh, path);
  return file;
}

}  // namespace

std::vector<std::string> mesh_format_names() {
  std::vector<std::string> names;
  for (const auto& [name, format] : kFormatNames) names.emplace_back(name);
  return names;
}

std::optional<MeshFormat> mesh_format_from_name(std::string_view name) {
  for (const auto& [known, format] : kFormatNames) {
    if (is_word(name, known)) return format;
  }
  return std::nullopt;
}

MeshFile read_mesh(const std::string& path, const ReadMeshOptions& options) {
  const std::string bytes = read_file(path);
  if (!is_packed(bytes)) return parse_mesh(path, bytes, bytes, options);
  const std::string mesh = unpacked(bytes, path);
  if (is_packed(mesh)) throw InputError(path + ": is compressed twice, expected once");
  return parse_mesh(path, mesh, bytes, options);
}

bool may_refer_to_files(const std::string& path, const ReadMeshOptions& options) {
  const std::optional<MeshFormat> format = options.format ? options.format : format_from_extension(path);
  return !format || is_gltf(*format);
}

std::vector<std::string> files_referred_to(const std::string& path, const ReadMeshOptions& options) {
  constexpr std::size_t kHead = std::size_t{1} << 16;
  InputBuffer head(path, unpacked(open_source(path), path));
  while (head.pending().size() < kHead && head.fill()) continue;
  if (!is_gltf(format_of({path, directory_of(path), head.pending()}, options))) return {};
  std::string bytes = read_file(path);
  if (is_packed(bytes)) bytes = unpacked(bytes, path);
  return files_of_gltf({path, directory_of(path), bytes});
}

}  // namespace raycone
