// The factor of one exterior edge at one query, with every exactness rule.
#pragma once

#include <optional>

#include "core/boundary/chain.h"
#include "core/boundary/near_edge.h"
#include "core/exact/predicates.h"
#include "core/exact/quad.h"

namespace raycone {

// A number with the argument of z_ab(q), max(|re|, |im|) in [1, 2); nothing where the argument is 0. That of a reversed
// edge is its conjugate. For the samples that the SIMD kernel does not vouch for (core/boundary/cone_kernel.h). `side`
// is edge_side(a, b, q), the same for all queries on a line along x. Needs DefaultFloatingPoint.
[[nodiscard]] std::optional<Factor<double>> edge_factor(const Vec3& a, const Vec3& b, const Vec3& q,
                                                        const EdgeSide& side);

// edge_factor() of the edge from `from` to a step, its conjugate where that is reversed: in 113 bits, of any magnitude,
// with a bound of its argument's error in radians.
[[nodiscard]] std::optional<NearEdgeFactor<Quad>> close_edge_factor(const Vec3& from, const ChainStep& step,
                                                                    const Vec3& q);

}  // namespace raycone
