// Points that are evaluated together.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/boundary/sample_tile.h"
#include "core/crossings/crossings.h"
#include "core/data/diagnostics.h"
#include "core/evaluation/point_crossings.h"
#include "core/evaluation/scaled_mesh.h"

namespace raycone {

// With the places of their values. Needs DefaultFloatingPoint; not thread-safe.
class PointTile {
 public:
  // Sets what has the index of a point in `values`, and in the diagnostics where given. `crossings`: those of all rays,
  // where they are known. The mesh has what points need otherwise (ScaledMesh::prepare_points()).
  PointTile(std::span<double> values, const Diagnostics* diagnostics, ScaledMesh::Settling settling,
            const PointCrossings* crossings = nullptr)
      : values_(values), diagnostics_(diagnostics), settling_(settling), crossings_(crossings) {}

  [[nodiscard]] bool full() const { return count_ == kTile; }

  // `ray`: its number among the crossings, if they are known. Precondition: not full.
  void add(std::size_t index, const Vec3& scaled_point, std::size_t ray) {
    indices_[count_] = index;
    rays_[count_] = ray;
    queries_[count_++] = scaled_point;
  }

  // Evaluates the points, if any, and forgets them. `sums`: where they are of one group of the mesh's blocks of points.
  Tally evaluate(const ScaledMesh& mesh, PointBlocks::Sums* sums = nullptr);

 private:
  void find_crossings(const ScaledMesh& mesh);
  void ask_embree(const ScaledMesh& mesh);
  void look_up();
  void decide(const ScaledMesh& mesh, const RayCandidate& candidate);
  void set_values(const ScaledMesh& mesh, PointBlocks::Sums* sums);
  void set_diagnostics(const ScaledMesh& mesh);

  std::span<double> values_;
  const Diagnostics* diagnostics_;
  ScaledMesh::Settling settling_;
  const PointCrossings* crossings_;
  std::size_t count_ = 0;
  std::array<std::size_t, kTile> indices_, rays_;
  std::array<Vec3, kTile> queries_;
  std::array<std::int64_t, kTile> n_;  // the sums of the signs of the rays' crossings
  std::array<Tally, kTile> tallies_;   // of each point
  std::array<double, kTile> w_;
  SampleTile samples_;
  std::vector<std::uint32_t> candidates_;
  std::vector<RayCandidate> doubtful_;
};

}  // namespace raycone
