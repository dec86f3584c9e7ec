// Rows of samples for tests.
#pragma once

#include "core/crossings/lattice_rows.h"

namespace raycone::test {

// Those of a lattice, in world units.
[[nodiscard]] inline LatticeRows rows_of(const Lattice& lattice) {
  return rows_in_scale(lattice, whole(lattice), [](double x) { return x; });
}

}  // namespace raycone::test
