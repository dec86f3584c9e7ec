// Surfaces as mesh files.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/data/coordinate_precision.h"
#include "core/data/triangle_mesh.h"
#include "io/files/output_file.h"

namespace raycone {

enum class SurfaceFormat { kPly, kStl, kObj, kOff };

// "ply", "stl", "obj" or "off", in any case; nothing else.
[[nodiscard]] std::optional<SurfaceFormat> surface_format_from_name(std::string_view name);

[[nodiscard]] inline bool is_text(SurfaceFormat format) {
  return format == SurfaceFormat::kObj || format == SurfaceFormat::kOff;
}

// STL holds single precision; the others hold doubles as they are.
[[nodiscard]] inline CoordinatePrecision vertex_precision(SurfaceFormat format) {
  return format == SurfaceFormat::kStl ? CoordinatePrecision::kSingle : CoordinatePrecision::kDouble;
}

// Writes the mesh and commits. PLY (binary, little-endian) has vertices in double precision and a property `source` of
// faces, which is `sources`; the others leave it out. STL is binary, with unit normals. Vertices keep their numbers
// where the format has them. Throws LimitError for more than 2^31 - 1 vertices, OutputError. Precondition: as many
// sources as triangles.
void write_surface(OutputFile& output, SurfaceFormat format, const TriangleMesh& mesh,
                   std::span<const std::int32_t> sources);

}  // namespace raycone
