// Checks of points drawn from one mesh, and of rules on one value, against definitions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/data/triangle_mesh.h"
#include "tests/property/check.h"

namespace raycone::test {

// There is a surface to draw from if and only if a triangle has an area, exactly; each point drawn with SIGMA 0 lies
// within rounding of a triangle that has one, in its box; points in the box lie in it. Nothing where all holds.
[[nodiscard]] std::optional<Failure> check_samples(const TriangleMesh& mesh, std::uint64_t seed, std::uint64_t count);

// Every rule holds for w, for thresholds next to w, and for its neighbours, as its definition says in 113 bits.
[[nodiscard]] std::optional<std::string> check_rules(double w);

}  // namespace raycone::test
