// Gaps of a surface filled, as far as that does no harm.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/lattice.h"
#include "core/surface/contour.h"
#include "core/surface/fill_gap.h"

namespace raycone {

// A gap, and what fills it.
struct FilledGap {
  std::vector<std::uint32_t> faces;  // of the surface, which vanish
  std::vector<std::uint32_t> loop;   // vertices around them, as in the GapLoop
  GapFill filled;
};

// Fills gaps of a closed surface, of which no two have a face in common, without what makes faults: that is left as it
// was. Only what is near a change is looked at (faults_near(), changed_nodes()). Returns whether any is filled; else
// the surface is as it was. The same for any number of threads. Needs DefaultFloatingPoint.
[[nodiscard]] bool fill_without_faults(SurfaceMesh& surface, std::vector<FilledGap> fills, const Lattice& lattice);

}  // namespace raycone
