// A mesh in a scale in which predicates are fast, with all that is needed to evaluate queries in that scale.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>

#include "core/boundary/boundary.h"
#include "core/boundary/change_bound.h"
#include "core/boundary/sample_tile.h"
#include "core/boundary/winding_number_engine.h"
#include "core/crossings/crossings.h"
#include "core/crossings/projected_grid.h"
#include "core/crossings/ray_caster.h"
#include "core/crossings/slab_order.h"
#include "core/data/box.h"
#include "core/data/triangle_mesh.h"
#include "core/evaluation/grid_choice.h"
#include "core/evaluation/summation_choice.h"
#include "core/evaluation/winding_number.h"
#include "core/exact/scale.h"
#include "core/far/cap_crossings.h"
#include "core/far/far_field.h"
#include "core/far/lattice_blocks.h"
#include "core/far/point_blocks.h"
#include "core/machine/built_once.h"

namespace raycone {

// What blocks of lattices are evaluated with.
struct Blocks {
  bool are_sound;      // no triangle is there so often that its error, multiplied, would show
  LatticeBlocks sums;  // of the caps, or of the mesh
};

// What scattered points are evaluated with, where there are many.
struct BlocksOfPoints {
  CapCrossings caps;
  PointBlocks sums;
};

// A mesh in a scale, with all that evaluators prepare of it: boundary and caps, the grid of rays, far field and blocks.
// The last ones are built when they are first needed. Thread-safe, but for terms().
class ScaledMesh {
 public:
  ScaledMesh(TriangleMesh mesh, const PowerOfTwo& scale, const EvaluatorOptions& options);
  ScaledMesh(const ScaledMesh&) = delete;  // rays_ refers to mesh_; direct_, choice_ and far_ to boundary_
  ScaledMesh& operator=(const ScaledMesh&) = delete;

  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }
  // Those of the constructor, without edges: scaling changes neither these nor their order.
  [[nodiscard]] const EvaluatorOptions& options() const { return options_; }
  [[nodiscard]] const Boundary& boundary() const { return boundary_; }
  [[nodiscard]] bool is_closed() const { return boundary_.exterior_edges() == 0; }
  // Whether no coordinate exceeds 1, as bounds of far fields, blocks and changes need. A mesh that spans more than
  // 2^1020 cannot be scaled so.
  [[nodiscard]] bool is_in_scale() const { return is_in_scale_; }
  [[nodiscard]] const Box& box() const;  // of the triangles

  // The mesh as it was given: the scaling lost nothing.
  [[nodiscard]] TriangleMesh unscaled_mesh() const;

  // Whether scaling keeps a query coordinate.
  [[nodiscard]] bool can_take(double x) const { return scale_.keeps(x); }
  [[nodiscard]] bool can_take(const Vec3& q) const { return can_take(q.x) && can_take(q.y) && can_take(q.z); }

  [[nodiscard]] double to_scale(double x) const {
    return scale_.exponent() > 0 ? std::clamp(scale_(x), -kFarthest, kFarthest) : scale_(x);
  }
  [[nodiscard]] Vec3 to_scale(const Vec3& q) const { return {to_scale(q.x), to_scale(q.y), to_scale(q.z)}; }

  // Built when first needed: lattices may need none of them.
  [[nodiscard]] const RayCaster& rays() const;
  [[nodiscard]] const ProjectedGrid& grid() const;
  [[nodiscard]] const ProjectedGrid* grid_if_built() const { return grid_.if_built(); }
  [[nodiscard]] const SlabOrder& slab_order(int axis) const;  // 1 or 2
  // The caps of an open mesh; none where values depend on no crossings.
  [[nodiscard]] const Caps& caps() const;
  // How winding numbers change from place to place, beside the integers where rays begin or cease to cross triangles of
  // the mesh, less those of the caps. Only in scale, and where values depend on crossings.
  [[nodiscard]] const ChangeBound& change_bound() const;
  // Only for an open mesh and a tolerance.
  [[nodiscard]] const Blocks& blocks() const;
  // None where there are too few points for it. Only before loops over points.
  [[nodiscard]] const BlocksOfPoints* blocks_of_points() const;
  // Builds what points need, the grid of rays only if it pays for so many more of them. Only before loops over points.
  void prepare_points(double points) const;
  // Builds the grid of rays. False where memory does not suffice: then passes over the triangles must do.
  [[nodiscard]] bool build_grid() const;
  [[nodiscard]] GridChoice& grid_choice() const { return grid_choice_; }

  // What follows takes queries in the scale.

  [[nodiscard]] QueryCrossing crossing(std::uint32_t triangle, const Vec3& q) const;

  // Whether values depend on how many triangles a ray crosses.
  [[nodiscard]] bool counts_crossings() const { return !direct_ || direct_->counts_crossings(); }
  // Which ways to sum are open, and which of them pay.
  [[nodiscard]] const SummationChoice& choice() const { return choice_; }

  // Whether what is far acts together. Samples that are near to each other in space are then cheaper together.
  [[nodiscard]] bool has_far_field() const;
  // None where the direct sum is as good at a sample. Built when first needed.
  [[nodiscard]] const FarField* far_field() const;

  // No value is off by more, but for its last rounding (WindingNumberEngine::doubt()).
  [[nodiscard]] double doubt() const {
    return direct_ ? std::max({direct_->doubt(), choice_.doubt_of_far_field(), choice_.doubt_of_blocks()}) : 0.0;
  }

  // Likewise of set_direct_values(). 0: the mesh is closed.
  [[nodiscard]] double doubt_of_direct_values() const { return direct_ ? direct_->doubt() : 0.0; }

  enum class Settling { kDone, kLeft };

  // values[i] = w at sample i, whose ray has crossings[i]. A value that may be a half-integer, where rules have their
  // thresholds, is on the right side of it or is it, whatever the tolerance; with kLeft it need not be. At least one
  // sample. `of_closed`, where who calls knows them: crossings less those of caps().
  void set_values(SampleTile& samples, std::span<const std::int64_t> crossings, std::span<double> values,
                  Settling settling = Settling::kDone, std::span<const std::int64_t> of_closed = {}) const;
  // As set_values(), by the direct sum. Precondition: the mesh is open.
  void set_direct_values(SampleTile& samples, std::span<const std::int64_t> crossings, std::span<double> values,
                         Settling settling = Settling::kDone) const;

  // As set_values(), for points of one group of blocks_of_points().
  void set_values(PointBlocks::Sums& sums, SampleTile& samples, std::span<const std::int64_t> crossings,
                  std::span<double> values, Settling settling) const;

  // How far values are off at most, which set_values() or blocks have set: rigorous and close. It may take thirty times
  // as long as the values. `crossings`: of the samples' rays.
  void bound_errors(SampleTile& samples, std::span<const double> values, std::span<const std::int64_t> crossings,
                    std::span<double> bounds) const;

  // Not while an evaluation runs.
  [[nodiscard]] Terms terms() const {
    Terms terms{direct_terms_, 0};
    if (const auto* const far = far_.if_built(); far && *far) terms += {(*far)->near_terms(), (*far)->far_terms()};
    if (const Blocks* const blocks = blocks_.if_built()) {
      terms += {blocks->sums.near_terms(), blocks->sums.far_terms()};
    }
    return terms;
  }

 private:
  // The far field for so many more samples; null: they are summed directly.
  [[nodiscard]] const FarField* far_field_for(std::size_t samples) const;
  [[nodiscard]] std::unique_ptr<const FarField> make_far_field() const;
  // None where another thread is making it.
  [[nodiscard]] const FarField* far_field_without_waiting() const;
  [[nodiscard]] std::unique_ptr<const BlocksOfPoints> make_blocks_of_points() const;
  void set_again_near_half_integers(const SampleTile& samples, std::span<const std::int64_t> crossings,
                                    std::span<double> values, double doubt) const;

  // Queries that scaling up brings beyond this are as good as at it: a mesh of size 1 has vanished.
  static constexpr double kFarthest = 0x1p1000;

  PowerOfTwo scale_;
  PowerOfTwo inverse_;
  EvaluatorOptions options_;
  TriangleMesh mesh_;
  bool is_in_scale_;
  Boundary boundary_;
  std::unique_ptr<const WindingNumberEngine> direct_;  // none where the mesh is closed
  SummationChoice choice_;                             // refers to boundary_
  mutable std::atomic<std::uint64_t> direct_terms_ = 0, samples_ = 0;
  mutable GridChoice grid_choice_;
  mutable std::atomic_flag far_is_taken_;
  BuiltOnce<Box> box_;
  BuiltOnce<RayCaster> rays_;
  BuiltOnce<ProjectedGrid> grid_;
  std::array<BuiltOnce<SlabOrder>, 2> slab_orders_;
  BuiltOnce<Caps> caps_;
  BuiltOnce<ChangeBound> change_bound_;
  BuiltOnce<Blocks> blocks_;
  BuiltOnce<std::unique_ptr<const FarField>> far_;                     // may refer to blocks_ and caps_
  BuiltOnce<std::unique_ptr<const BlocksOfPoints>> blocks_of_points_;  // refers to blocks_ and caps_
};

// A mesh in the scale in which predicates are fast, and as it is for queries with a coordinate that this scale would
// drop bits of (a number below 2.3e-308 mesh sizes). A matter of each query alone, since the two may round differently.
class ScaledMeshes {
 public:
  ScaledMeshes(TriangleMesh mesh, const EvaluatorOptions& options);

  [[nodiscard]] const ScaledMesh& scaled() const { return scaled_; }
  // Built when first needed. Predicates are slower there.
  [[nodiscard]] const ScaledMesh& unscaled() const;
  [[nodiscard]] Terms terms() const {
    Terms terms = scaled_.terms();
    if (const ScaledMesh* const unscaled = unscaled_.if_built()) terms += unscaled->terms();
    return terms;
  }
  [[nodiscard]] const ScaledMesh& of_query(bool scaling_is_exact) const {
    return scaling_is_exact ? scaled_ : unscaled();
  }

 private:
  ScaledMeshes(const PowerOfTwo& scale, TriangleMesh&& mesh, const EvaluatorOptions& options);

  ScaledMesh scaled_;
  BuiltOnce<ScaledMesh> unscaled_;
};

}  // namespace raycone
