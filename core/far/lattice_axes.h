// The samples of a lattice as its axes have them.
#pragma once

#include <array>
#include <vector>

namespace raycone {

// The coordinates of a lattice along each axis, ascending.
using LatticeAxes = std::array<std::vector<double>, 3>;

}  // namespace raycone
