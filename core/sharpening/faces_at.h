// The faces at each vertex of a surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cells/surface_mesh.h"
#include "core/data/triangle_mesh.h"
#include "core/mesh/vertex_faces.h"
#include "core/sharpening/gap.h"

namespace raycone {

// The surface must stay, though it may have more faces and vertices for a while, which this does not know.
class FacesAt {
 public:
  explicit FacesAt(const SurfaceMesh& surface) : mesh_(surface.mesh), sources_(surface.sources), faces_(surface.mesh) {}

  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t vertex) const { return faces_.of(vertex); }

  // For gap.h.
  [[nodiscard]] const Triangle& triangle(std::uint32_t face) const { return mesh_.triangles[face]; }
  [[nodiscard]] std::int32_t source(std::uint32_t face) const { return sources_[face]; }
  [[nodiscard]] const Vec3& position(std::uint32_t vertex) const { return mesh_.vertices[vertex]; }
  [[nodiscard]] std::uint32_t face_with(std::uint32_t from, std::uint32_t to) const {
    for (const std::uint32_t face : of(from)) {
      if (has_side(triangle(face), from, to)) return face;
    }
    return kNoFace;
  }

 private:
  const TriangleMesh& mesh_;
  const std::vector<std::int32_t>& sources_;
  VertexFaces faces_;
};

}  // namespace raycone
