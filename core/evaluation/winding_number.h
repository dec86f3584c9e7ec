// The evaluator: exact generalized winding numbers of one mesh at many points.
//
//   w(q) = n(q) - (1 / 2 pi) sum over exterior edges of m_ab arg z_ab(q)
//
// n counts the triangles that the ray q + t x, t > 0, crosses; the sum is the winding number of the cone over the
// exterior edges with its apex at infinity behind the ray. Derivation and every exactness rule: docs/method.md. Method:
// "Fast and Exact Winding Numbers for Triangle Meshes" (ACM TOG 45(4), 2026), eq. 5.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/data/diagnostics.h"
#include "core/data/lattice.h"
#include "core/data/rule.h"
#include "core/data/triangle_mesh.h"
#include "core/machine/simd.h"

namespace raycone {

// Counts over the samples of one evaluation.
struct Tally {
  std::uint64_t degenerate = 0;  // edge sides that were ties, decided by the symbolic perturbation, over all samples
  std::uint64_t on_surface = 0;  // samples that lie exactly on the surface

  Tally& operator+=(const Tally& other) {
    degenerate += other.degenerate;
    on_surface += other.on_surface;
    return *this;
  }
};

// How the triangles along rays are found. Values do not depend on it.
enum class RayEngine {
  kScan,    // lattices: scan conversion; points: a grid over the projected triangles
  kEmbree,  // Embree for all
};

// What is summed up. Values agree up to rounding.
enum class Summation {
  kCheapest,   // of the following, as the mesh has it
  kCone,       // crossings, and the cone over the exterior edges
  kTriangles,  // the solid angles of all triangles
};

class WindingNumberEvaluator {
 public:
  // Prepares all that depends on the mesh alone but for prepare_points(). `mesh` is welded (core/mesh/weld.h); vertices
  // used by triangles are finite. The values of a mesh without triangles are 0. Throws std::bad_alloc, and
  // std::length_error for more than kMaxTriangles.
  explicit WindingNumberEvaluator(TriangleMesh mesh, RayEngine engine = RayEngine::kScan,
                                  SimdLevel level = SimdLevel::kBest, Summation summation = Summation::kCheapest);
  ~WindingNumberEvaluator();
  WindingNumberEvaluator(WindingNumberEvaluator&&) noexcept;
  WindingNumberEvaluator& operator=(WindingNumberEvaluator&&) noexcept;

  // Number of undirected edges of non-zero net count; 0 means closed: every value is then exactly an integer.
  [[nodiscard]] std::uint64_t exterior_edges() const;

  // Winding numbers (turns) of a block of `lattice`, x fastest: values.size() == block.size(). `done`, where given,
  // grows by one per finished sample while the call runs. Uses the threads that ThreadLimit allows; the values depend
  // on neither their number nor the block's extent, nor on whether `diagnostics` are wanted, which takes a hundred
  // times as long for open meshes. Const calls may run concurrently. Throws std::length_error for more than
  // kMaxBlockSide samples along an axis.
  Tally evaluate(const Lattice& lattice, const LatticeBlock& block, std::span<double> values,
                 std::atomic<std::uint64_t>* done = nullptr, const Diagnostics* diagnostics = nullptr) const;

  // |value - w| <= accuracy(), turns: 1e-10, or 2^-53 times the sum of |multiplicities| of exterior edges where that is
  // more, from a million edges on: doubles of such values can do no better.
  [[nodiscard]] double accuracy() const;

  // Half-integers are exact: a value is 0.5, 1.5, -0.5 ... where w cannot be told from it (kIndistinguishable), and
  // otherwise on the same side of it as w. For another number settle() says as much: `value`, evaluated at `point`, on
  // the side of `critical` on which w is, or `critical` itself. It takes a millisecond and more for each thousand
  // exterior edges, and changes nothing where the two differ by more than doubt() turns, which is 0 for closed meshes.
  // Thread-safe.
  [[nodiscard]] double doubt() const;
  [[nodiscard]] double settle(const Vec3& point, double value, double critical) const;

  // Builds the acceleration structure that points need and lattices may not; else the first evaluation of points does.
  void prepare_points() const;

  // Winding numbers (turns) at finite points, in their order: values.size() == points.size().
  Tally evaluate(std::span<const Vec3> points, std::span<double> values, std::atomic<std::uint64_t>* done = nullptr,
                 const Diagnostics* diagnostics = nullptr) const;

 private:
  struct Implementation;
  std::unique_ptr<const Implementation> implementation_;
};

}  // namespace raycone
