// Where a surface that has been sharpened crosses mixed edges of the lattice.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/cells/node_set.h"
#include "core/cells/surface_mesh.h"
#include "core/certificate/surface_edit.h"
#include "core/data/lattice.h"
#include "core/data/vec3.h"
#include "core/sharpening/sharpen.h"

namespace raycone {

// Looks for faces that cross mixed edges, those from an inside node to one that is not, off the mesh: there the lattice
// looked, and the surface was on the mesh before. All that it is given must stay.
class MixedEdges {
 public:
  MixedEdges(const SharpenInput& input, const NodeSet& inside, const SharpenLimits& limits)
      : input_(input), inside_(inside), lattice_(inside.lattice()), limits_(limits) {}

  // The vertices to keep where they were, as a face crosses a mixed edge off the mesh after `change`: those that were
  // pulled off that edge; else the face's corners that have moved; else all its corners. In no order, some more than
  // once. Crossings that fill_corner_gaps() will mend do not count: the first call that finds any tries that. Uses the
  // threads that ThreadLimit allows; the same for any number of them.
  [[nodiscard]] std::vector<std::uint32_t> vertices_off(const SurfaceMesh& surface, const SurfaceEdit& change);

 private:
  struct FaceOff {
    Triangle t;
    std::vector<Vec3> points;  // where it crosses edges
  };
  [[nodiscard]] std::vector<Vec3> points_off(const SurfaceMesh& surface, std::uint32_t face) const;
  [[nodiscard]] std::vector<FaceOff> faces_off(const SurfaceMesh& surface, const SurfaceEdit& change) const;
  [[nodiscard]] NodeSet nodes_off(const SurfaceMesh& surface, const NodeSet& beside) const;
  void find_mended(const SurfaceMesh& surface, const std::vector<FaceOff>& off);

  const SharpenInput& input_;
  const NodeSet& inside_;
  const Lattice& lattice_;
  const SharpenLimits& limits_;
  // The corners of cells where faces were off at first, and of those where they still are once corners are filled.
  std::optional<NodeSet> off_at_first_, off_when_filled_;
};

}  // namespace raycone
