// Colours that tell labels apart, the same wherever labels are shown.
#pragma once

#include <array>
#include <cstdint>

namespace raycone {

// Red, green and blue of a label, from 1.
[[nodiscard]] std::array<std::uint8_t, 3> label_colour(std::uint64_t label);

}  // namespace raycone
