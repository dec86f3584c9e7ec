// The evaluator: exact generalized winding numbers of one mesh at many points.
//
//   w(q) = n(q) - (1 / 2 pi) sum over exterior edges of m_ab arg z_ab(q)
//
// n counts the triangles that the ray q + t x, t > 0, crosses, with their signs. The sum is the winding number of a
// cone: its base are the exterior edges (the boundary of the mesh), its apex lies at infinity behind the ray.
// docs/method.md has the derivation and every rule of exactness. Method: Xie, Hafner, Wojtan, "Fast and Exact Winding
// Numbers for Triangle Meshes" (ACM TOG 45(4), 2026), eq. 5.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
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
  std::uint64_t degenerate = 0;  // edge sides that were ties, which the symbolic perturbation decided
  std::uint64_t on_surface = 0;  // samples that lie exactly on the surface

  Tally& operator+=(const Tally& other) {
    degenerate += other.degenerate;
    on_surface += other.on_surface;
    return *this;
  }
};

// How to find the triangles along a ray. Values do not depend on it.
enum class RayEngine {
  kScan,    // triangles look for rays: those of a lattice, or of points; of many points, rays look into a grid
  kPasses,  // for tests: the same without the grid
  kEmbree,  // Embree for all
};

// What to sum. Values agree up to rounding.
enum class Summation {
  kCheapest,   // whichever of the following is cheaper for the mesh
  kCone,       // crossings, and the cone over the exterior edges
  kTriangles,  // the solid angles of all triangles
  // For tests: as kCheapest, but wherever the tolerance allows it, whether it pays or not,
  kFarField,  // with a far field,
  kBlocks,    // with blocks of lattices and, if Accuracy::points are given, of points
};

struct ExteriorEdge;

inline constexpr double kLeastTolerance = 1e-12;          // turns; less counts as 0
inline constexpr double kAgreeingRounding = 1.6e-14;      // turns per edge: see error_of_agreeing_roundings()
inline constexpr double kLeastToleranceOfBlocks = 1e-11;  // below, fits would round too much

// How well values are to be known.
struct Accuracy {
  // |value - w| is to be at most this, turns; more than 1/16 counts as 1/16. From kLeastTolerance on, what is far may
  // act together (docs/method.md, "Far field"), where that pays. Below, all is summed one by one, and a value is off by
  // its rounding alone.
  double tolerance = 0.0;
  // About how many samples the evaluator is for: preparing a far field must pay.
  double samples = 1e6;
  // Whether values only serve to tell sides of rules, which are exact: engines may then change as samples go on, and
  // with them, within the tolerance, a value.
  bool sides_only = false;
  // About how many points in the mesh's box evaluate() for points is for, spread over it: where they are many, space is
  // divided into blocks for them. 0: nobody knows, or they are few.
  double points = 0.0;
};

// The tolerance that sides of a rule are cheapest with, turns. With a larger one far more values would be close to a
// threshold, and those are summed again: many at once near half-integers, near others one by one.
[[nodiscard]] double tolerance_for_sides(const Rule& rule);

// Whether a search structure is likely to pay for so many points, of a mesh of so many triangles. Without one, each
// 65 536 points or more take a pass over the triangles.
[[nodiscard]] bool grid_pays_for_points(double points, double triangles);

// What values took: pairs of a sample with an edge or a triangle, and with a multipole, which stands for many.
struct Terms {
  std::uint64_t near = 0;
  std::uint64_t far = 0;

  Terms& operator+=(const Terms& other) {
    near += other.near;
    far += other.far;
    return *this;
  }
};

// How the evaluator goes about it.
struct EvaluatorOptions {
  RayEngine ray_engine = RayEngine::kScan;
  SimdLevel level = SimdLevel::kBest;
  Summation summation = Summation::kCheapest;
  Accuracy accuracy = {};  // rules do not depend on it
  // exterior_edges(mesh), to spare finding them again (core/mesh/exterior_edges.h). Used by the constructor alone.
  const std::vector<ExteriorEdge>* edges = nullptr;
};

// What uses threads throws ThreadsUnavailable (core/machine/threads.h) where none can be started, and with
// RayEngine::kEmbree std::runtime_error where Embree fails, or cannot be loaded.
class WindingNumberEvaluator {
 public:
  // Prepares what depends on the mesh alone, except what prepare_points() does. Preconditions: `mesh` is welded
  // (core/mesh/weld.h), and the vertices that triangles use are finite. All values of a mesh without triangles are 0.
  // Throws std::bad_alloc, and std::length_error for more than kMaxTriangles.
  explicit WindingNumberEvaluator(TriangleMesh mesh, const EvaluatorOptions& options = {});
  ~WindingNumberEvaluator();
  WindingNumberEvaluator(WindingNumberEvaluator&&) noexcept;
  WindingNumberEvaluator& operator=(WindingNumberEvaluator&&) noexcept;

  // The number of exterior edges: undirected edges whose faces do not cancel. If it is 0, the mesh is closed, and each
  // value is exactly an integer.
  [[nodiscard]] std::uint64_t exterior_edges() const;

  // The accuracy that it was made with.
  [[nodiscard]] const Accuracy& asked_accuracy() const;

  // Sets the winding numbers (turns) of a block of `lattice`, x fastest. Precondition: values.size() == block.size().
  // If `done` is given, it grows by one per finished sample while the call runs. If `diagnostics` are given, they are
  // set, too; for open meshes that takes a hundred times as long. Uses the threads that ThreadLimit allows. Values
  // depend neither on how many there are, nor on the block's extent, nor on the diagnostics, unless they are for sides
  // only (Accuracy::sides_only). Const calls may run concurrently. Throws std::length_error for more than kMaxBlockSide
  // samples along an axis. Precondition: the samples of the block are finite.
  Tally evaluate(const Lattice& lattice, const LatticeBlock& block, std::span<double> values,
                 std::atomic<std::uint64_t>* done = nullptr, const Diagnostics* diagnostics = nullptr) const;

  // Sets the winding numbers of finite points, in their order; all else as for lattices. Precondition: values.size() ==
  // points.size().
  Tally evaluate(std::span<const Vec3> points, std::span<double> values, std::atomic<std::uint64_t>* done = nullptr,
                 const Diagnostics* diagnostics = nullptr) const;

  // The same values, but within doubt() of a half-integer they may be on its wrong side: they are not settled. A
  // hundred times sooner where most of them are so near, as in a search for the places where w is one.
  void evaluate_unsettled(std::span<const Vec3> points, std::span<double> values) const;

  // Prepares what points need and lattices may not, where so many are going to come: if it pays, a search structure.
  // Otherwise the evaluation builds it with which enough points have come, or fewer in small portions.
  void prepare_points(double points = std::numeric_limits<double>::infinity()) const;

  // Sets for each sample of a block of `lattice` only whether `rule` holds, 1, or not, 0: exactly. In a small part of
  // the time, if the evaluator was made for that: with accuracy {.tolerance = tolerance_for_sides(rule), .sides_only =
  // true}. With a tolerance of 0 an open mesh may take longer than evaluate(). Precondition: sides.size() ==
  // block.size().
  Tally evaluate_sides(const Rule& rule, const Lattice& lattice, const LatticeBlock& block,
                       std::span<std::uint8_t> sides, std::atomic<std::uint64_t>* done = nullptr) const;

  // What evaluate() takes for a whole lattice on one thread of this machine, about, what is prepared included. Builds
  // what it is estimated from, as an evaluation does; where that would take seconds, because boundary edges or
  // triangles are too many, it is what a direct sum takes (`at_most`).
  struct Estimate {
    double seconds;
    bool at_most;
  };
  [[nodiscard]] Estimate estimated_seconds(const Lattice& lattice) const;

  // What values may be off by where the roundings of all exterior edges agree, as next to thousands of needles around
  // one edge: the tolerance, and 1.6e-14 turns for each edge, counted with multiplicity. Measured, where doubt() is
  // proved and 30 times as much; of real meshes values are far closer.
  [[nodiscard]] double error_of_agreeing_roundings() const;

  // What values are expected to be off by at most, turns: the tolerance, or kLeastTolerance where that is less. From
  // 9000 exterior edges on, counted with multiplicity, it is 2^-53 times their number at least. What a tolerance leaves
  // out is within it. What sums round beside it is below doubt(), and on real meshes far below this; where the
  // roundings of many edges agree it may be more (docs/method.md, "What is guaranteed"). Diagnostics bound each value.
  [[nodiscard]] double expected_error() const;

  // No value is off by more, turns, but for its last rounding (docs/method.md, "What is guaranteed"). 0 for closed
  // meshes, whose values are exact.
  [[nodiscard]] double doubt() const;

  // Values are right about half-integers. A value is exactly 0.5, 1.5, -0.5 ... where w cannot be told from it
  // (kIndistinguishable). Else it is on the same side of it as w.
  //
  // settle() makes values right about another number, too. values[i], which was evaluated at points[i], is moved to the
  // side of `critical` on which w is; it is `critical` itself where w cannot be told from it. A value takes a
  // millisecond or more per thousand exterior edges where the direct sum cannot tell, else as long as that sum. None
  // need be given that may_be_across(value, critical, doubt()) says no of (core/data/rule.h). Precondition:
  // values.size() == points.size(). Thread-safe.
  void settle(std::span<const Vec3> points, double critical, std::span<double> values) const;

  // What all values that have been evaluated so far took. Not while an evaluation runs.
  [[nodiscard]] Terms terms() const;

 private:
  struct Implementation;
  std::unique_ptr<const Implementation> implementation_;
};

}  // namespace raycone
