// The points where sharp edges pass through the faces of a lattice's tetrahedra.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/surface/cell_creases.h"
#include "core/surface/edge_points.h"
#include "core/surface/surface_cells.h"

namespace raycone {

// How far apart numbers of one plane may be, world units: a billionth of a voxel, or what the coordinates' own format
// rounds (single precision where all of them are such numbers).
[[nodiscard]] double plane_tolerance(const TriangleMesh& mesh, const Lattice& lattice);

class FacePoints {
 public:
  // Where the planes at a mixed face's two points disagree, or just one of these is in a hole: a point of a crease in
  // the face, if there is one; that where the planes meet, else the one farthest from the straight line. Points are
  // kept inside the face by the margin. They depend on the face, its two points and the mesh alone, so that both its
  // cells agree.
  FacePoints(const SurfaceCells& cells, std::span<const EdgePoint> edge_points, const CellCreases& creases,
             double tolerance, const SurfaceMargins& margins);
  FacePoints() = default;
  // These points, of faces numbered 16 * cell + face, increasing.
  FacePoints(std::vector<std::uint64_t> faces, std::vector<Vec3> positions);

  [[nodiscard]] const std::vector<std::uint64_t>& faces() const { return faces_; }
  [[nodiscard]] const std::vector<Vec3>& positions() const { return positions_; }

  // The number of the point of a face of the cell, as in kuhn::kFaces; nothing where it has none. Thread-safe.
  [[nodiscard]] std::optional<std::uint32_t> find(std::uint32_t cell, std::size_t face) const;

  // All but those of these numbers.
  [[nodiscard]] FacePoints without(const std::vector<bool>& dropped) const;

 private:
  std::vector<std::uint64_t> faces_;  // 16 * cell + face, increasing
  std::vector<Vec3> positions_;
  std::vector<std::uint32_t> first_of_cell_;  // up to the last cell that has any; one more at the end
  std::vector<std::uint16_t> faces_of_cell_;  // likewise, a bit for each
};

}  // namespace raycone
