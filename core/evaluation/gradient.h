// How the winding number changes from place to place.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/data/lattice.h"
#include "core/data/triangle_mesh.h"
#include "core/evaluation/gradient_kernel.h"
#include "core/exact/scale.h"
#include "core/machine/simd.h"
#include "core/mesh/exterior_edges.h"

namespace raycone {

// The gradient of the winding number beside its jumps, turns per world unit: the law of Biot and Savart over the
// exterior edges (docs/method.md, "The gradient"). Exactly 0 for closed meshes. An edge whose line the query is on
// adds nothing: its part has no limit on the edge, and is 0 on the rest of the line. Each edge's part is off by less
// than 1e-12 of its length; a component that no double holds becomes the largest double. Thread-safe.
class GradientEvaluator {
 public:
  // Preconditions: `mesh` is welded, and the vertices that triangles use are finite. `edges`: exterior_edges(mesh).
  // `level`: values do not depend on it.
  GradientEvaluator(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges,
                    SimdLevel level = SimdLevel::kBest);

  // Sets the gradients of a block of `lattice`, x fastest, or of finite points. Preconditions: values.size() is
  // block.size(), or points.size(). `done`, where given, grows by one per sample. Some 4 ns per exterior edge and
  // sample, on the threads that ThreadLimit allows; the same for any number of them.
  void evaluate(const Lattice& lattice, const LatticeBlock& block, std::span<Vec3> values,
                std::atomic<std::uint64_t>* done = nullptr) const;
  void evaluate(std::span<const Vec3> points, std::span<Vec3> values, std::atomic<std::uint64_t>* done = nullptr) const;

 private:
  [[nodiscard]] Vec3 sum_unscaled(const Vec3& point) const;
  template <class Point, class Value>
  void evaluate_tile(std::size_t count, const Point& point, const Value& value) const;
  template <class Point>
  void evaluate_each(const Point& point, std::span<Vec3> values, std::atomic<std::uint64_t>* done) const;

  PowerOfTwo scale_, inverse_;
  std::vector<GradientSegment> segments_;  // scaled
  GradientKernel sum_parts_;
};

}  // namespace raycone
