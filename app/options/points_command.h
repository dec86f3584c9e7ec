// `raycone points`: values at given points, or at points that are drawn.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/options/field_options.h"
#include "app/options/lattice_request.h"
#include "app/options/mesh_options.h"
#include "app/options/output_options.h"
#include "app/options/run_options.h"
#include "core/sampling/point_sampler.h"
#include "io/points/read_points.h"

namespace raycone {

struct SampleRequest {
  std::vector<SampleGroup> groups;
  std::uint64_t seed = 1;
  std::optional<Box> bounds;  // in place of the mesh's box
  WorldPadding padding;
};

struct PointsCommand {
  MeshOptions mesh;
  RunOptions run;
  FieldOptions field;
  OutputFiles output;
  FieldEncoding encoding;
  std::string points;  // "-": standard input; empty where they are drawn
  ReadPointsOptions reading;
  std::optional<SampleRequest> sample;
};

}  // namespace raycone
