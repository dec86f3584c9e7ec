#include "core/evaluation/summation_choice.h"

#include <cstdint>

#include "core/evaluation/costs.h"
#include "core/far/far_field.h"
#include "core/far/lattice_blocks.h"
#include "core/far/shared_edges.h"

namespace raycone {

double SummationChoice::direct_cost() const {
  return direct_.counts_crossings ? static_cast<double>(direct_.boundary.exterior_edges())
                                  : kTriangleCost * static_cast<double>(direct_.triangles);
}

// A loop of n edges has n - 2 caps.
double SummationChoice::most_sources() const {
  return direct_.counts_crossings ? direct_.boundary.total_multiplicity() : static_cast<double>(direct_.triangles);
}

// --- Far field ------------------------------------------------------------------------------------------------------

bool SummationChoice::may_have_far_field() const {
  constexpr std::uint64_t kTooFew = 100;  // exterior edges: no far field is cheaper
  if (!is_open() || !direct_.is_in_scale || !(tolerance() >= kLeastTolerance)) return false;
  // Many a sample lies in the plane of flat caps, which are ties then.
  if (direct_.counts_crossings && direct_.boundary.is_flat()) return false;
  return summation_ == Summation::kFarField ||
         (summation_ == Summation::kCheapest && direct_.boundary.exterior_edges() >= kTooFew);
}

double SummationChoice::tolerance_of_far_field() const {
  constexpr double kShare = 0.75;  // near triangles round, too
  return kShare * tolerance();
}

bool SummationChoice::far_field_may_pay() const {
  if (summation_ == Summation::kFarField) return true;
  return direct_.counts_crossings
             ? raycone::far_field_may_pay(accuracy_.samples, static_cast<double>(direct_.boundary.exterior_edges()),
                                          1.0)
             : raycone::far_field_may_pay(accuracy_.samples, static_cast<double>(direct_.triangles), kTriangleCost);
}

bool SummationChoice::far_field_pays(double cost) const {
  constexpr double kSafety = 0.8;  // estimates are no better
  return summation_ == Summation::kFarField || cost < kSafety * direct_cost();
}

double SummationChoice::doubt_of_far_field() const {
  const bool wanted = summation_ == Summation::kCheapest || summation_ == Summation::kFarField;
  if (!wanted || !direct_.is_in_scale || !(tolerance() >= kLeastTolerance)) return 0.0;
  return FarField::doubt(tolerance_of_far_field(), most_sources());
}

// --- Blocks ---------------------------------------------------------------------------------------------------------

bool SummationChoice::has_blocks() const {
  return is_open() && direct_.is_in_scale && accuracy_.tolerance >= kLeastToleranceOfBlocks &&
         most_sources() <= static_cast<double>(SharedEdges::kMostTriangles) &&
         LatticeBlocks::doubt(tolerance(), most_sources()) <= Boundary::kMostDoubt;
}

bool SummationChoice::has_rough_sums() const {
  constexpr double kFewSamples = 0x1p16;
  return has_blocks() && (direct_.counts_crossings || accuracy_.samples > kFewSamples);
}

double SummationChoice::doubt_of_blocks() const {
  return has_blocks() ? LatticeBlocks::doubt(tolerance(), most_sources()) : 0.0;
}

bool SummationChoice::blocks_of_points_may_pay() const {
  constexpr double kLeastPoints = 2e5;  // an estimate takes as long as some thousand points, ...
  constexpr double kLeastCost = 4e7;    // ... of some hundred edges
  const double points = accuracy_.points;
  if (!(points > 0.0) || !has_blocks()) return false;
  if (summation_ == Summation::kBlocks) return true;
  return summation_ == Summation::kCheapest && points >= kLeastPoints && direct_cost() * points >= kLeastCost;
}

bool SummationChoice::blocks_of_points_pay(double cost, double other) const {
  constexpr double kSafety = 0.75;  // estimates are no better
  const double at_point = kBlocksAtPoints.in_blocks * cost + kBlocksAtPoints.beside_blocks;
  const double all = at_point * accuracy_.points + kBlocksAtPoints.fit + kBlocksAtPoints.tree * direct_cost();
  return summation_ == Summation::kBlocks || all < kSafety * other * accuracy_.points;
}

}  // namespace raycone
