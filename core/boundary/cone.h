// The boundary cone: what the exterior edges contribute to winding numbers.
//
// With p = v - q, P = p_y + i p_z and s = |p| - p_x, the edge a -> b of multiplicity m contributes m arg z,
//   z = s_a s_b + conj(P_a) P_b,  Im z = a_y b_z - a_z b_y = the edge's side (core/exact/predicates.h),
// to 2 pi times the winding number of the cone over the edges whose apex lies at infinity along -x (docs/method.md;
// "Fast and Exact Winding Numbers", eq. 5, with the apex of Martens, Trettner, Bessmeltsev 2026).
#pragma once

#include "core/boundary/cone_kernel.h"
#include "core/boundary/winding_number_engine.h"

namespace raycone {

// w = n - the cone's winding number. Rounding errors of some u per edge.
class Cone final : public CompleteEngine {
 public:
  // `boundary` must outlive this.
  Cone(const Boundary& boundary, SimdLevel level);

  [[nodiscard]] bool counts_crossings() const override { return true; }
  void winding_numbers(SampleTile& samples, std::span<const std::int64_t> crossings,
                       std::span<double> w) const override;

 private:
  ConeKernel multiply_chains_;
};

}  // namespace raycone
