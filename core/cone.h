// The boundary cone: what the exterior edges contribute to winding numbers.
//
// With p = v - q, P = p_y + i p_z and s = |p| - p_x, the edge a -> b of multiplicity m contributes m arg z,
//   z = s_a s_b + conj(P_a) P_b,  Im z = a_y b_z - a_z b_y = the edge's side (core/predicates.h),
// to 2 pi times the winding number of the cone over the edges whose apex lies at infinity along -x (docs/method.md;
// "Fast and Exact Winding Numbers", eq. 5, with the apex of Martens, Trettner, Bessmeltsev 2026).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/cone_kernel.h"
#include "core/triangle_mesh.h"

namespace raycone {

// A sum of angles in turns as Turns, with 64 bits, and how far it may be off.
struct TurnsWithin {
  std::int64_t whole = 0;
  long double rest = 0.0L;
  long double bound = 0.0L;  // of |whole + rest - the exact sum|, turns
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
  [[nodiscard]] TurnsWithin enclose(const Vec3& q) const;

 private:
  // Edges of one |multiplicity|: their product is common.
  struct Group {
    std::int32_t multiplicity = 1;  // positive
    std::vector<ChainStep> steps;
  };

  ConeKernel multiply_chains_;
  std::uint64_t edges_ = 0;
  std::vector<Group> groups_;
};

}  // namespace raycone
