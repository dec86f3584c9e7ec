// Surfaces whose coordinates are far from 1.
#pragma once

#include <functional>
#include <optional>

#include "core/data/lattice.h"
#include "core/surface/surface.h"

namespace raycone {

// Whether products of four lengths and more could over- or underflow. False where vertices are floats.
[[nodiscard]] bool is_out_of_scale(const Lattice& lattice, const SurfaceOptions& options);

// Whether products of eight lengths, more than there are anywhere, could overflow.
[[nodiscard]] bool is_far_too_large(const Lattice& lattice);

// Scales the input by a power of two, so that coordinates are near 1, calls `make`, and scales back what that returns.
// The evaluators are new ones, made with the accuracies of those given. None where `make` returns none, or where
// scaling costs a number bits.
[[nodiscard]] std::optional<FinishedSurface> made_in_scale(
    const SurfaceInput& input, const std::function<std::optional<FinishedSurface>(const SurfaceInput&)>& make);

}  // namespace raycone
