// Fewer triangles for the same surface.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/cells/surface_mesh.h"
#include "core/data/lattice.h"
#include "core/data/triangle_mesh.h"
#include "core/merging/patch_merger.h"

namespace raycone {

// The faces of a surface some of whose vertices are pulled into others. Vertices keep the numbers they had before.
struct MergedFaces {
  std::vector<Triangle> triangles;
  std::vector<std::int32_t> sources;
  std::vector<std::uint32_t> into;   // of each vertex, the one that it was pulled into; itself where it stayed
  std::vector<std::uint32_t> faces;  // from PlaneMerger: the numbers of the faces before, increasing; else empty
};

class BrickMerger;
struct SurfaceBricks;

// Pulls vertices of a closed surface into neighbours along edges, wherever all faces around stay in the planes that
// they are in (`input`'s, where they have a source in it): flat parts get larger faces, straight edges longer ones.
// Faces keep their order and sources, and the surface its topology. Each pull stays within `limits.most` of the planes
// around it; many in a row may add up (left_behind()). Where planes agree only up to rounding, faces that come as near
// to others may cross them. `lattice`: of about the size of the faces. Uses the threads that ThreadLimit allows; the
// same for any number of them, and whatever was kept before.
class PlaneMerger {
 public:
  // All of them must outlive this, and stay as they are.
  PlaneMerger(const SurfaceMesh& surface, const TriangleMesh& input, const Lattice& lattice, const MergeLimits& limits);

  // Leaves the vertices of `kept` where they are. Where `kept` hardly differs from the last call's, takes a fraction of
  // its time.
  [[nodiscard]] MergedFaces merge(const std::vector<bool>& kept);

 private:
  struct SecondPass;
  void merge_first_bricks(const std::vector<bool>& kept);
  void merge_second_bricks(const std::vector<bool>& kept, BrickMerger& merger, MergedFaces& merged,
                           std::vector<std::uint8_t>& settled);

  const SurfaceMesh& surface_;
  const TriangleMesh& input_;
  const Lattice& lattice_;
  MergeLimits limits_;
  // What the last call had when each first brick was merged by itself; empty before the first call.
  std::shared_ptr<const SurfaceBricks> bricks_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> into_;
  std::vector<std::uint8_t> settled_;
  std::vector<bool> kept_;
  std::shared_ptr<SecondPass> second_;  // of the last call, likewise
};

}  // namespace raycone
