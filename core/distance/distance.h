// Unsigned distances to the triangles of a mesh. A distance is off by less than 1e-12 of itself, or by less than 4 *
// 2^-53 times the largest coordinate of the mesh or the point (docs/method.md, "Distances"), or 2^-1074. One beyond the
// doubles is the largest double.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>

#include "core/data/lattice.h"
#include "core/data/triangle_mesh.h"
#include "core/machine/simd.h"

namespace raycone {

class DistanceBlocks;  // core/data/distance_blocks.h

// What uses threads throws ThreadsUnavailable (core/machine/threads.h) where none can be started.
class DistanceEvaluator {
 public:
  // Precondition: the vertices that triangles use are finite. A mesh without triangles is infinitely far away. Throws
  // std::length_error for more than kMaxTriangles.
  explicit DistanceEvaluator(const TriangleMesh& mesh, SimdLevel level = SimdLevel::kBest);
  ~DistanceEvaluator();
  DistanceEvaluator(DistanceEvaluator&&) noexcept;
  DistanceEvaluator& operator=(DistanceEvaluator&&) noexcept;

  // Sets the distances (world units) of a block of `lattice`, x fastest. They are cut off at `band`; below it they have
  // the bits that points would have. Precondition: distances.size() == block.size(). Uses the threads that ThreadLimit
  // allows; distances depend neither on their number nor on the block's extent. Const calls may run concurrently.
  // Throws std::length_error for more than kMaxBlockSide samples along an axis.
  void evaluate(const Lattice& lattice, const LatticeBlock& block, double band, std::span<double> distances) const;

  // The same of the samples in the band, in blocks: memory and time are in proportion to their number, beside a little
  // for each block of the lattice; in proportion to the block where a sample is 2^55 sizes of the mesh away.
  void evaluate(const Lattice& lattice, const LatticeBlock& block, double band, DistanceBlocks& distances) const;

  // Builds the search tree. Without this call, the first evaluation does.
  void prepare_points() const;

  // Sets the distances (world units) of finite points, in their order. Those above `limit` may be other numbers above
  // it: a limit spares work. Precondition: distances.size() == points.size().
  void evaluate(std::span<const Vec3> points, std::span<double> distances,
                double limit = std::numeric_limits<double>::infinity()) const;

  // Sets the numbers of the triangles that finite points are nearest to: where several are equally near up to
  // rounding, one of them, the same for any number of threads and SIMD level; triangle 0 where all of the mesh is like
  // one point, from far away. Precondition: triangles.size() == points.size(), and the mesh has a triangle.
  void find_nearest(std::span<const Vec3> points, std::span<std::uint32_t> triangles) const;

 private:
  struct Implementation;
  std::unique_ptr<const Implementation> implementation_;
};

}  // namespace raycone
