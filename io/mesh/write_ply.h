// Coloured meshes as PLY files.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "io/files/output_file.h"

namespace raycone {

using Colour = std::array<std::uint8_t, 3>;  // red, green, blue; sRGB

// Indices are those of `vertices`.
struct ColouredMesh {
  struct Vertex {
    Vec3 position;
    Colour colour;
  };
  struct Face {
    Triangle corners;
    Colour colour;
  };
  struct Edge {
    std::array<std::uint32_t, 2> ends;
    Colour colour;
  };
  std::vector<Vertex> vertices;
  std::vector<Face> faces;
  std::vector<Edge> edges;
};

// Writes binary little-endian PLY and commits: elements `vertex` (x, y, z as double), `face` (vertex_indices) and
// `edge` (vertex1, vertex2), each with red, green and blue. Indices are `int`, which all programs read. Throws
// LimitError for more than 2^31 - 1 vertices, OutputError.
void write_ply(OutputFile& output, const ColouredMesh& mesh);

}  // namespace raycone
