// Sums of solid angles at all samples of a lattice: what is far from a block of samples acts on it as one polynomial.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/boundary/solid_angle_kernel.h"
#include "core/data/sample_box.h"
#include "core/far/cover.h"
#include "core/far/lattice_axes.h"
#include "core/far/shared_edges.h"
#include "core/far/source_tree.h"
#include "core/machine/simd.h"

namespace raycone {

// A bounded engine: sums are within `tolerance`, and rounding, of the sums of the solid angles of the triangles in
// turns. Blocks of samples are divided in two along their longer axes, again and again. A triangle that is far enough
// from a block, for its area, adds its field to the block's harmonic polynomial; the others are handed down, and those
// that are near in the end are summed exactly, ties as the exactness rules say. So a sum is that of the perturbed
// query, also on triangles.
//
// Sums depend on the triangles, their order and the lattice alone: not on threads, SIMD level, or the part of the
// lattice that is asked for.
class LatticeBlocks {
 public:
  // How triangles that are near are summed: always one by one, or by their boundary where that has few edges, as of
  // patches of a surface.
  enum class Near { kTriangles, kBoundary };

  // Of triangles in scale, with coordinates of at most 1, and a positive tolerance. Throws std::length_error for more
  // than SourceTree takes, or with kBoundary SharedEdges. Needs DefaultFloatingPoint.
  LatticeBlocks(std::vector<SolidTriangle> triangles, double tolerance, SimdLevel level, Near near = Near::kTriangles);

  // The sums of samples [x, x + sums.size()) of the row (y, z).
  using Sink = std::function<void(std::size_t x, std::size_t y, std::size_t z, std::span<const double> sums)>;

  // Calls `sink` for rows that make up the part of the lattice, from several threads. Needs DefaultFloatingPoint.
  void for_each_row(const LatticeAxes& axes, const SampleBox& part, const Sink& sink) const;

  // How long one sample of the lattice takes, about; in units of a triangle's solid angle there.
  [[nodiscard]] double cost(const LatticeAxes& axes) const;

  // Pairs that have been summed so far: of a sample with a triangle; of a sample with a multipole or with the
  // polynomial of its block. What is summed at nodes of fits counts too.
  [[nodiscard]] std::uint64_t near_terms() const { return near_terms_; }
  [[nodiscard]] std::uint64_t far_terms() const { return far_terms_; }

  // Counts what `cover` sums at so many samples among them.
  void count_terms(const Cover& cover, std::size_t samples) const;

  [[nodiscard]] SimdLevel level() const { return level_; }
  [[nodiscard]] const SourceTree& tree() const { return tree_; }
  [[nodiscard]] double tree_tolerance() const;                                        // that the tree was made with
  [[nodiscard]] std::span<const TriangleExtent> extents() const { return sources_; }  // of the tree's triangles
  // Of the tree's triangles, where what is near may be summed by its boundary; else null.
  [[nodiscard]] const SharedEdges* edges() const { return edges_ ? &*edges_ : nullptr; }

  // No sum over so many triangles is off by more, rounding included.
  [[nodiscard]] static double doubt(double tolerance, double triangles);

 private:
  friend class LatticeBlocksWalk;

  SourceTree tree_;
  std::vector<TriangleExtent> sources_;   // the triangles of the tree
  std::vector<std::uint32_t> leaf_ends_;  // of each, where those of its leaf end; in no leaf, the next one
  std::optional<SharedEdges> edges_;      // likewise, where boundaries are asked for
  double tolerance_;
  SimdLevel level_;
  mutable std::atomic<std::uint64_t> near_terms_ = 0, far_terms_ = 0;
};

}  // namespace raycone
