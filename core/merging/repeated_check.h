// The certificate of one surface after the other, where most of each is as it was.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/cells/node_set.h"
#include "core/cells/surface_mesh.h"
#include "core/certificate/certificate.h"
#include "core/data/triangle_mesh.h"
#include "core/merging/merge_planes.h"

namespace raycone {

class RepeatedCheck {
 public:
  // `inside` must outlive this. `vertices`: how many the surface had before it was merged.
  RepeatedCheck(const NodeSet& inside, std::size_t vertices) : inside_(inside), vertices_(vertices) {}

  // The faults of a mesh, as faults_of() finds them, but that a wrong edge may count as two links. Two faces that were
  // both in the last mesh, with the same corners in the same places, are not looked at again, unless they had faults.
  // `merged`: the faces of the mesh, in its order. Sets `misplaced` to the nodes on the wrong side.
  [[nodiscard]] SurfaceFaults faults(const MergedFaces& merged, const TriangleMesh& mesh, NodeSet& misplaced) const;
  // Makes the last mesh a whole surface, before anything is merged. It has no faults, but perhaps nodes on the wrong
  // side.
  void remember_whole(const SurfaceMesh& surface);
  // Makes `mesh`, which has these faults, the last one.
  void remember(const MergedFaces& merged, const TriangleMesh& mesh, const SurfaceFaults& faults);

 private:
  [[nodiscard]] std::vector<std::uint32_t> faces_to_check(const MergedFaces& merged, const TriangleMesh& mesh) const;

  const NodeSet& inside_;
  std::size_t vertices_;
  bool is_known_ = false;  // whether there is a last one, without faults that faces_to_check() does not follow
  std::vector<std::uint32_t> faces_;
  std::vector<Triangle> triangles_;
  TriangleMesh mesh_;
  std::vector<bool> faulty_;  // of each face, whether it intersected another one
};

}  // namespace raycone
