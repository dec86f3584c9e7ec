// On which side of a rule the samples of boxes are, from rough sums.
#pragma once

#include <span>
#include <vector>

#include "core/data/sample_box.h"
#include "core/evaluation/side_samples.h"

namespace raycone {

// Sets the sides of the samples of the boxes that rough sums tell from each threshold. Adds the others to `undecided`,
// in runs. Other samples of the boxes' hull may be set or added, too. Precondition: samples.mesh() has blocks that are
// sound.
void set_sides_roughly(const SideSamples& samples, std::span<const SampleBox> boxes, std::vector<SampleBox>& undecided);

}  // namespace raycone
