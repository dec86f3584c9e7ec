// What a mesh is: the counts that `raycone info` prints.
#pragma once

#include <cstdint>
#include <optional>

#include "core/data/triangle_mesh.h"

namespace raycone {

struct MeshStatistics {
  std::uint64_t exterior_edges = 0;      // undirected edges whose faces do not cancel
  std::uint64_t inconsistent_edges = 0;  // edges of exactly two faces that run along them in the same direction
  std::uint64_t nonmanifold_edges = 0;   // edges of more than two faces; one of two equal corners counts twice
  std::uint64_t degenerate_faces = 0;    // zero area, decided exactly
  std::uint64_t duplicate_faces = 0;     // beyond the first of the same three vertices, in either orientation
  std::uint64_t components = 0;          // sets of faces that are joined through vertices
  double surface_area = 0.0;             // world units squared, infinite beyond doubles
  // World units cubed, infinite beyond doubles; absent if the mesh is open. Rounding is beside the volumes of the
  // tetrahedra that it is summed of: where all cancel, some 1e-19 of them may be left.
  std::optional<double> signed_volume;

  [[nodiscard]] bool closed() const { return exterior_edges == 0; }
};

// Statistics of a welded mesh. Precondition: at least one triangle, all its vertices finite.
[[nodiscard]] MeshStatistics mesh_statistics(const TriangleMesh& welded);

}  // namespace raycone
