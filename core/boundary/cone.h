// The boundary cone: what the exterior edges contribute to winding numbers.
//
// With p = v - q, P = p_y + i p_z and s = |p| - p_x, the edge a -> b of multiplicity m contributes m arg z,
//   z = s_a s_b + conj(P_a) P_b,  Im z = a_y b_z - a_z b_y = the edge's side (core/exact/predicates.h),
// to 2 pi times the winding number of the cone over the edges whose apex lies at infinity along -x (docs/method.md;
// "Fast and Exact Winding Numbers", eq. 5, with the apex of Martens, Trettner, Bessmeltsev 2026).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/boundary/cone_kernel.h"
#include "core/data/triangle_mesh.h"
#include "core/exact/exact_determinant.h"

namespace raycone {

// A sum of angles in turns as Turns, with 64 or 113 bits, and how far it may be off.
template <class Real>
struct TurnsWithin {
  std::int64_t whole = 0;
  Real rest = 0;
  Real bound = 0;  // of |whole + rest - the exact sum|, turns
};

class Cone {
 public:
  // The cone over the exterior edges of a welded mesh.
  Cone(const TriangleMesh& mesh, SimdLevel level);

  [[nodiscard]] std::uint64_t exterior_edges() const { return edges_; }

  // Sets cone[i] to the cone's winding number at sample i, sign as in w = n - w_cone. Rounding errors of some u per
  // edge; needs DefaultFloatingPoint. Thread-safe. cone.size() == samples.count, at least 1.
  void winding_numbers(SampleTile& samples, std::span<Turns> cone) const;

  // The same in extended precision with a rigorous bound of its error, by running error analysis (docs/method.md,
  // "Error bound"). A hundred times slower, and a check of the above: it shares the signs and the order of edges, not
  // the arithmetic.
  [[nodiscard]] TurnsWithin<long double> enclose(const Vec3& q) const;

  // The sum of |multiplicities|: no value w is off by more than a fraction of a turn times this.
  [[nodiscard]] double total_multiplicity() const { return total_multiplicity_; }

  // `w`, a winding number of the mesh at q that is off by less than 1/8, on the side of `critical` on which the true
  // one is; `critical` itself where that cannot be told. Takes as long as thousands of winding numbers, but no longer
  // than two where the answer is a half-integer because all exterior edges lie in one plane with q.
  [[nodiscard]] double settle(const Vec3& q, double w, double critical) const;

 private:
  // Edges of one |multiplicity|: their product is common.
  struct Group {
    std::int32_t multiplicity = 1;  // positive
    std::vector<ChainStep> steps;
  };

  static TurnsWithin<long double> enclose(const Group& group, const Vec3& q);
  static void add_enclosed(const Group& group, const SampleTile& samples, std::span<Turns> cone);
  [[nodiscard]] TurnsWithin<Quad> enclose_closely(const Vec3& q) const;
  void find_plane();
  [[nodiscard]] bool lies_in_plane_of_edges(const Vec3& q) const;

  ConeKernel multiply_chains_;
  std::uint64_t edges_ = 0;
  double total_multiplicity_ = 0.0;
  std::vector<Group> groups_;                          // but for the edges along the rays: their steps are unjoined
  std::vector<std::array<Vec3, 2>> edges_along_rays_;  // without an argument, but part of the rim
  std::optional<std::array<Vec3, 3>> plane_;           // through all edges, where there is just one
};

}  // namespace raycone
