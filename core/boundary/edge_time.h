// How fast this machine is.
#pragma once

#include "core/machine/simd.h"

namespace raycone {

// Seconds that an exterior edge takes at a sample of a lattice in the direct sum on one thread: as measured by the
// first call with a level, which takes a millisecond or so. Machines differ by a factor of ten. Needs
// DefaultFloatingPoint. Thread-safe.
[[nodiscard]] double edge_seconds(SimdLevel level);

}  // namespace raycone
