// The factor of one exterior edge at one query, with every exactness rule.
#pragma once

#include <optional>

#include "core/boundary/near_edge.h"
#include "core/exact/predicates.h"
#include "core/exact/quad.h"

namespace raycone {

// A number with the argument of z_ab(q), times -1 if `reversed`, max(|re|, |im|) in [1, 2); nothing where the
// argument is 0. For the samples that the SIMD kernel does not vouch for (core/boundary/cone_kernel.h). `side` is
// edge_side(a, b, q), the same for all queries on a line along x. Needs DefaultFloatingPoint.
[[nodiscard]] std::optional<Factor<double>> edge_factor(const Vec3& a, const Vec3& b, bool reversed, const Vec3& q,
                                                        const EdgeSide& side);

// For an edge with D = 0 that does not project to a point (docs/method.md, "Exact zeros"): the line through the query
// along the ray meets the edge's line. Re and |Im| of a number with the argument of z_ab(q), of any magnitude, each
// rounded once to Real; the sign of Im is that of edge_side(). Nothing where the argument is 0.
template <class Real>  // long double or Quad, for their exponents: nothing over- or underflows
[[nodiscard]] std::optional<Factor<Real>> tied_factor(const Vec3& a, const Vec3& b, const Vec3& q);

// edge_factor() in 113 bits, of any magnitude, with a bound of its argument's error in radians.
[[nodiscard]] std::optional<NearEdgeFactor<Quad>> close_edge_factor(const Vec3& a, const Vec3& b, bool reversed,
                                                                    const Vec3& q);

}  // namespace raycone
