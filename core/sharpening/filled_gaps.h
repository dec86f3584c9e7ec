// Gaps of a surface, filled.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/cells/surface_mesh.h"
#include "core/data/lattice.h"
#include "core/sharpening/fill_gap.h"

namespace raycone {

// A gap, and what fills it.
struct FilledGap {
  std::vector<std::uint32_t> faces;  // of the surface, which vanish
  std::vector<std::uint32_t> loop;   // vertices around them, as in the GapLoop
  GapFill filled;
};

// Fills gaps of a closed surface, no two of which have a face in common. Returns nothing where that makes no faults.
// Else the surface is as it was, and returned are the places in `fills` of those at faults; of all, where none is known
// to be. Only what is near a change is looked at (faults_near(), changed_nodes()). The same for any number of threads.
// Needs DefaultFloatingPoint.
[[nodiscard]] std::vector<std::size_t> fill_all(SurfaceMesh& surface, const std::vector<FilledGap>& fills,
                                                const Lattice& lattice);

}  // namespace raycone
