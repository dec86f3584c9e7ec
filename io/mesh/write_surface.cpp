#include "io/mesh/write_surface.h"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>

#include "io/files/ascii.h"
#include "io/files/file_error.h"

namespace raycone {
namespace {

// Hands bytes to the file in large pieces.
class Pieces {
 public:
  explicit Pieces(OutputFile& output) : output_(output) {}

  void text(std::string_view words) {
    bytes_ += words;
    if (bytes_.size() >= kPiece) flush();
  }
  template <class Number>
  void binary(Number number) {
    text({reinterpret_cast<const char*>(&number), sizeof number});
  }
  // Shortest digits that give the number back.
  template <class Number>
  void number(Number value) {
    std::array<char, 32> digits;
    text({digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr});
  }
  void flush() {
    output_.write(bytes_.data(), bytes_.size());
    bytes_.clear();
  }

 private:
  static constexpr std::size_t kPiece = std::size_t{1} << 18;
  OutputFile& output_;
  std::string bytes_;
};

void put_ply(Pieces& pieces, const TriangleMesh& mesh, std::span<const std::int32_t> sources) {
  pieces.text("ply\nformat binary_little_endian 1.0\ncomment made by raycone\nelement vertex " +
              std::to_string(mesh.vertices.size()) +
              "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
              std::to_string(mesh.triangles.size()) +
              "\nproperty list uchar int vertex_indices\nproperty int source\nend_header\n");
  for (const Vec3& p : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) pieces.binary(p[axis]);
  }
  for (std::size_t i = 0; i < sources.size(); ++i) {
    pieces.binary(std::uint8_t{3});
    for (const std::uint32_t corner : mesh.triangles[i]) pieces.binary(corner);
    pieces.binary(sources[i]);
  }
}

void put_stl(Pieces& pieces, const TriangleMesh& mesh) {
  constexpr std::size_t kHeader = 80;
  std::string header = "binary STL made by raycone";
  header.resize(kHeader, ' ');
  pieces.text(header);
  pieces.binary(static_cast<std::uint32_t>(mesh.triangles.size()));
  const auto put = [&](const Vec3& v) {
    for (int axis = 0; axis < 3; ++axis) pieces.binary(static_cast<float>(v[axis]));
  };
  for (const Triangle& t : mesh.triangles) {
    const Vec3& a = mesh.vertices[t[0]];
    const Vec3 normal = cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a);
    const double length = std::hypot(normal.x, normal.y, normal.z);
    put(length > 0.0 && std::isfinite(length) ? (1.0 / length) * normal : Vec3{});
    for (const std::uint32_t corner : t) put(mesh.vertices[corner]);
    pieces.binary(std::uint16_t{0});
  }
}

void put_numbers(Pieces& pieces, const Vec3& p) {
  for (int axis = 0; axis < 3; ++axis) {
    if (axis > 0) pieces.text(" ");
    pieces.number(p[axis]);
  }
  pieces.text("\n");
}

void put_obj(Pieces& pieces, const TriangleMesh& mesh) {
  pieces.text("# made by raycone\n");
  for (const Vec3& p : mesh.vertices) {
    pieces.text("v ");
    put_numbers(pieces, p);
  }
  for (const Triangle& t : mesh.triangles) {
    pieces.text("f");
    for (const std::uint32_t corner : t) {
      pieces.text(" ");
      pieces.number(std::uint64_t{corner} + 1);
    }
    pieces.text("\n");
  }
}

void put_off(Pieces& pieces, const TriangleMesh& mesh) {
  pieces.text("OFF\n" + std::to_string(mesh.vertices.size()) + " " + std::to_string(mesh.triangles.size()) + " 0\n");
  for (const Vec3& p : mesh.vertices) put_numbers(pieces, p);
  for (const Triangle& t : mesh.triangles) {
    pieces.text("3");
    for (const std::uint32_t corner : t) {
      pieces.text(" ");
      pieces.number(corner);
    }
    pieces.text("\n");
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
  constexpr std::size_t kMost = std::numeric_limits<std::int32_t>::max();
  if (mesh.vertices.size() > kMost) {
    throw LimitError(output.name() + ": needs " + std::to_string(mesh.vertices.size()) +
                     " vertices, but mesh files have up to " + std::to_string(kMost));
  }
  Pieces pieces(output);
  switch (format) {
    case SurfaceFormat::kPly:
      put_ply(pieces, mesh, sources);
      break;
    case SurfaceFormat::kStl:
      put_stl(pieces, mesh);
      break;
    case SurfaceFormat::kObj:
      put_obj(pieces, mesh);
      break;
    case SurfaceFormat::kOff:
      put_off(pieces, mesh);
  }
  pieces.flush();
  output.commit();
}

}  // namespace raycone
