// Points that the tool draws, in place of a file of them.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "app/run/lattice_choice.h"
#include "core/data/triangle_mesh.h"
#include "core/sampling/point_sampler.h"
#include "io/points/read_points.h"

namespace raycone {

struct SampleRequest {
  std::vector<SampleGroup> groups;
  std::uint64_t seed = 1;
  std::optional<Box> bounds;  // in place of the mesh's box
  WorldPadding padding;
};

// `name`: the file that `mesh` is from. Throws UsageError where the padding leaves nothing of the box, InputError where
// points near the surface are asked for and there is none, LimitError where points would not be finite.
[[nodiscard]] std::unique_ptr<PointReader> draw_points(const std::string& name, const TriangleMesh& mesh,
                                                       const SampleRequest& request);

}  // namespace raycone
