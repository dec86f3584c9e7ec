#include "io/mesh/write_surface.h"

#include <cmath>
#include <string>

#include "io/files/ascii.h"
#include "io/mesh/mesh_output.h"

namespace raycone {
namespace {

void put_ply(MeshOutput& file, const TriangleMesh& mesh, std::span<const std::int32_t> sources) {
  file.text(ply_head(mesh.vertices.size(), "", mesh.triangles.size(), "property int source\n"));
  for (const Vec3& p : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) file.binary(p[axis]);
  }
  for (std::size_t i = 0; i < sources.size(); ++i) {
    file.binary(std::uint8_t{3});
    for (const std::uint32_t corner : mesh.triangles[i]) file.binary(corner);
    file.binary(sources[i]);
  }
}

void put_stl(MeshOutput& file, const TriangleMesh& mesh) {
  constexpr std::size_t kHeader = 80;
  std::string header = "binary STL made by raycone";
  header.resize(kHeader, ' ');
  file.text(header);
  file.binary(static_cast<std::uint32_t>(mesh.triangles.size()));
  const auto put = [&](const Vec3& v) {
    for (int axis = 0; axis < 3; ++axis) file.binary(static_cast<float>(v[axis]));
  };
  for (const Triangle& t : mesh.triangles) {
    const Vec3& a = mesh.vertices[t[0]];
    const Vec3 normal = cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a);
    const double length = std::hypot(normal.x, normal.y, normal.z);
    put(length > 0.0 && std::isfinite(length) ? (1.0 / length) * normal : Vec3{});
    for (const std::uint32_t corner : t) put(mesh.vertices[corner]);
    file.binary(std::uint16_t{0});
  }
}

void put_numbers(MeshOutput& file, const Vec3& p) {
  for (int axis = 0; axis < 3; ++axis) {
    if (axis > 0) file.text(" ");
    file.number(p[axis]);
  }
  file.text("\n");
}

void put_obj(MeshOutput& file, const TriangleMesh& mesh) {
  file.text("# made by raycone\n");
  for (const Vec3& p : mesh.vertices) {
    file.text("v ");
    put_numbers(file, p);
  }
  for (const Triangle& t : mesh.triangles) {
    file.text("f");
    for (const std::uint32_t corner : t) {
      file.text(" ");
      file.number(std::uint64_t{corner} + 1);
    }
    file.text("\n");
  }
}

void put_off(MeshOutput& file, const TriangleMesh& mesh) {
  file.text("OFF\n" + std::to_string(mesh.vertices.size()) + " " + std::to_string(mesh.triangles.size()) + " 0\n");
  for (const Vec3& p : mesh.vertices) put_numbers(file, p);
  for (const Triangle& t : mesh.triangles) {
    file.text("3");
    for (const std::uint32_t corner : t) {
      file.text(" ");
      file.number(corner);
    }
    file.text("\n");
  }
}

}  // namespace

std::optional<SurfaceFormat> surface_format_from_name(std::string_view name) {
  const std::string small = lower_case(name);
  if (small == "ply") return SurfaceFormat::kPly;
  if (small == "stl") return SurfaceFormat::kStl;
  if (small == "obj") return SurfaceFormat::kObj;
  if (small == "off") return SurfaceFormat::kOff;
  return std::nullopt;
}

void write_surface(OutputFile& output, SurfaceFormat format, const TriangleMesh& mesh,
                   std::span<const std::int32_t> sources) {
  check_vertex_count(output, mesh.vertices.size());
  MeshOutput file(output);
  switch (format) {
    case SurfaceFormat::kPly:
      put_ply(file, mesh, sources);
      break;
    case SurfaceFormat::kStl:
      put_stl(file, mesh);
      break;
    case SurfaceFormat::kObj:
      put_obj(file, mesh);
      break;
    case SurfaceFormat::kOff:
      put_off(file, mesh);
  }
  file.finish();
}

}  // namespace raycone
