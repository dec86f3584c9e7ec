// Which vertices of a surface merging leaves as they are, as what it makes of them has faults.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/cells/node_set.h"
#include "core/cells/surface_mesh.h"
#include "core/certificate/certificate.h"
#include "core/data/triangle_mesh.h"
#include "core/merging/merge_planes.h"

namespace raycone {

// A merged surface with faults.
struct FaultyMerge {
  const MergedFaces& merged;
  const TriangleMesh& mesh;  // the faces of `merged`, in their order
  const SurfaceFaults& faults;
  const NodeSet& misplaced;
};

class KeptVertices {
 public:
  // Near faults, vertices are kept for these many rounds; then, as the last resort, far around them.
  static constexpr int kRounds = 8, kWideRounds = 6;

  // Of a surface, which must stay. None are kept.
  explicit KeptVertices(const SurfaceMesh& surface)
      : surface_(&surface), kept_(surface.mesh.vertices.size()), at_home_(kept_) {}

  // Per vertex: whether it is not merged; and, of those, whether it is not moved either.
  [[nodiscard]] const std::vector<bool>& kept() const { return kept_; }
  [[nodiscard]] const std::vector<bool>& at_home() const { return at_home_; }

  // Keeps these vertices, too, in merging.
  void keep(std::span<const std::uint32_t> vertices);

  // Keeps more vertices, as the merge of this round (from 0) has faults. Returns whether there are any more to keep.
  bool keep_more(const FaultyMerge& found, int round);

 private:
  bool keep_at_home(const FaultyMerge& found);
  bool keep_near(const FaultyMerge& found, double most);
  bool keep_around(const FaultyMerge& found, int wide);
  template <class MayStay>
  bool keep_where(const MayStay& may_stay);
  [[nodiscard]] std::vector<bool> vertices_at_faults(const FaultyMerge& found) const;

  const SurfaceMesh* surface_;
  std::vector<bool> kept_, at_home_;
};

}  // namespace raycone
