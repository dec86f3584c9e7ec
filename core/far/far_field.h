// The boundary term from afar: a bounded engine.
//
// Soups: w is the sum over the triangles. Other open meshes M: caps close the boundary, so that M less its caps is
// closed, and w = (crossings of M less crossings of the caps) + w of the caps. The crossings are integers, exact; what
// is left is a sum over triangles. Those that are far from a sample act together, as multipoles (source_tree.h).
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include "core/boundary/sample_tile.h"
#include "core/boundary/winding_number_engine.h"
#include "core/data/triangle_mesh.h"
#include "core/far/cap_crossings.h"
#include "core/far/far_kernel.h"
#include "core/far/source_tree.h"

namespace raycone {

// Whether preparing a far field takes no more than a small part of what direct sums at so many samples take: then its
// cost() can be looked at. `direct`: what a source takes there, in units of an exterior edge. The part is larger where
// there are many sources, as a far field saves more of them.
[[nodiscard]] bool far_field_may_pay(double samples, double sources, double direct);

class FarField final : public WindingNumberEngine {
 public:
  // Of a mesh in scale: coordinates of at most 1. The far field is off by at most `tolerance` turns, positive, what it
  // rounds included. `caps`: of the mesh's boundary, null where the triangles of the mesh are the sources. They must
  // outlive this. Needs DefaultFloatingPoint.
  FarField(const TriangleMesh& mesh, const TriangleMesh* caps, double tolerance, SimdLevel level);
  // The same where there is a tree of the sources, made with this tolerance. It must outlive this, too. Precondition:
  // no source is repeated.
  FarField(const TriangleMesh& mesh, const TriangleMesh* caps, const SourceTree& tree, double tolerance,
           SimdLevel level);

  // Whether a face or a cap is there so often that its error, multiplied, would show: then do not use this.
  [[nodiscard]] bool has_repeated_faces() const { return faces_repeat_; }

  [[nodiscard]] bool counts_crossings() const override { return has_caps_; }
  void winding_numbers(SampleTile& samples, std::span<const std::int64_t> crossings,
                       std::span<double> w) const override;
  // The same, `whole` being the crossings of the mesh less those of the caps; of sources that are caps.
  void winding_numbers_of_closed(SampleTile& samples, std::span<const std::int64_t> whole, std::span<double> w) const;
  [[nodiscard]] double doubt() const override { return doubt_; }
  // doubt() of a far field with so many sources at most.
  [[nodiscard]] static double doubt(double tolerance, double sources);

  // What a sample takes, about, in units of an exterior edge of a direct sum; counted at some places in the mesh's box.
  [[nodiscard]] double cost() const { return cost_; }
  // The same on a lattice, where samples share rays: an edge takes little more than half as long there.
  [[nodiscard]] double cost_on_lattice() const { return cost_on_lattice_; }

  [[nodiscard]] const SourceTree& sources() const { return *tree_; }

  // Pairs of samples with triangles, and with multipoles, that winding_numbers() has summed so far.
  [[nodiscard]] std::uint64_t near_terms() const { return near_terms_; }
  [[nodiscard]] std::uint64_t far_terms() const { return far_terms_; }

 private:
  // What both have; without the tree.
  FarField(const TriangleMesh* caps, SimdLevel level);
  void set_costs(const Box& box, double tolerance);

  FarKernel kernel_;
  bool has_caps_;
  CapCrossings cap_crossings_;
  std::optional<SourceTree> own_tree_;
  const SourceTree* tree_ = nullptr;
  bool faces_repeat_ = false;
  double doubt_ = 0;
  double cost_ = 0, cost_on_lattice_ = 0;
  mutable std::atomic<std::uint64_t> near_terms_ = 0, far_terms_ = 0;
};

}  // namespace raycone
