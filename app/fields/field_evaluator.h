// Fields of one mesh, from whatever each of them takes.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "app/fields/fields.h"
#include "core/data/placed_lattice.h"
#include "core/data/triangle_mesh.h"
#include "core/distance/distance.h"
#include "core/evaluation/gradient.h"
#include "core/evaluation/winding_number.h"

namespace raycone {

// The tolerance that winding numbers are evaluated with, turns. Rules do not depend on it: where nothing else is asked
// for, it is what they are cheapest with.
[[nodiscard]] double tolerance_of_evaluation(const FieldOptions& options);

class FieldEvaluator {
 public:
  // Prepares what `options` need, but for prepare_points(). `mesh` and `edges` as for
  // WindingNumberEvaluator. `samples`: about how many it is for. `points`: Accuracy::points.
  FieldEvaluator(TriangleMesh mesh, const FieldOptions& options, const std::vector<ExteriorEdge>* edges = nullptr,
                 double samples = 1e6, double points = 0.0);

  [[nodiscard]] const WindingNumberEvaluator& winding_number() const { return winding_number_; }

  // What the winding numbers that it tells are expected to be off by at most, turns: 0 of closed meshes, and where it
  // tells none.
  [[nodiscard]] double expected_error() const {
    return rule_ || winding_number_.exterior_edges() == 0 ? 0.0 : winding_number_.expected_error();
  }

  // The closed surface that solid distances are to: needed before evaluate() where they are wanted.
  void set_solid(const TriangleMesh& surface) { solid_.emplace(surface, simd_); }

  // Builds the search structures of points, that of winding numbers where it is for many. Lattices need that of
  // distances alone, which evaluate() builds without this.
  void prepare_points() const;

  // Fills `samples`, made for the options of this, with all fields of a block or of finite points. On lattices, which
  // have cubic voxels then, distances are cut off at the band. `done`, where given, grows by one per sample while the
  // call runs. A lattice whose axes are the world's, in any order and direction, is evaluated as one along them;
  // others at the positions of their samples, which takes what points need. Samples that use blocks are of lattices
  // along the axes.
  Tally evaluate(const PlacedLattice& lattice, const LatticeBlock& block, FieldSamples& samples,
                 std::atomic<std::uint64_t>* done) const;
  Tally evaluate(std::span<const Vec3> points, FieldSamples& samples, std::atomic<std::uint64_t>* done) const;

 private:
  // `band_width`: where distances are cut off, world units.
  Tally evaluate_along_axes(const Lattice& lattice, const LatticeBlock& block, double band_width, FieldSamples& samples,
                            std::atomic<std::uint64_t>* done) const;
  Tally evaluate_points(std::span<const Vec3> points, double band_width, FieldSamples& samples,
                        std::atomic<std::uint64_t>* done) const;

  // Where a rule is asked for: winding numbers on the side of its threshold on which the true ones are. `point` gives
  // that of a sample's number.
  template <class Point>
  void settle(const Point& point, FieldSamples& samples) const;

  double band_;
  SimdLevel simd_;
  std::optional<Rule> rule_;                   // where nothing but it is asked of winding numbers
  std::vector<double> thresholds_;             // that values may have to be settled for
  std::optional<DistanceEvaluator> distance_;  // where wanted
  std::optional<DistanceEvaluator> solid_;     // likewise
  std::optional<GradientEvaluator> gradient_;  // likewise
  WindingNumberEvaluator winding_number_;
};

}  // namespace raycone
