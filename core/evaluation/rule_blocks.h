// On which side of a rule the samples of a lattice are, without the winding number of each.
#pragma once

#include <atomic>
#include <cstdint>

#include "core/evaluation/side_samples.h"

namespace raycone {

// Sets each side to 1 where the rule holds and to 0 where it does not. Blocks of samples that are certain to be on one
// side of each threshold, but for the crossings between them, are evaluated at one sample, others by rough sums where
// there are any (docs/method.md). `done`, where given, grows by one per sample. Needs DefaultFloatingPoint.
// Precondition: the mesh is open and in scale; if its values depend on no crossings, it has blocks that are sound.
void set_sides(const SideSamples& samples, std::atomic<std::uint64_t>* done);

}  // namespace raycone
