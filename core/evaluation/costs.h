// What ways to sum the boundary term are estimated to take, as measured with AVX-512: per sample, or once. The unit is
// always the time of an exterior edge at a sample of a lattice, or at a scattered point, in the direct sum.
#pragma once

namespace raycone {

// A triangle of a soup, in the direct sum. At scattered points it is 1.3 rather, where edges take twice as long.
inline constexpr double kTriangleCost = 1.9;

// What FarField::cost_on_lattice() counts as an edge.
inline constexpr double kFarFieldCost = 0.88;

// LatticeBlocks and PointBlocks.
struct BlocksCost {
  double in_blocks;      // what their cost() counts as a triangle
  double beside_blocks;  // at a sample, beside what they sum
  double fit, tree;      // once: making the operator, and for each unit of the direct sum at a sample, the tree
};
inline constexpr BlocksCost kBlocksOnLattice{2.4, 24.0, 2.1e6, 3.5e3};
inline constexpr BlocksCost kBlocksAtPoints{1.6, 0.0, 1.5e6, 1e3};

}  // namespace raycone
