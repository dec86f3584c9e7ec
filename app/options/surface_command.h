// `raycone surface`: a closed mesh of the set where a rule holds.
#pragma once

#include <variant>

#include "app/options/lattice_request.h"
#include "app/options/mesh_options.h"
#include "app/options/output_options.h"
#include "app/options/run_options.h"
#include "core/data/rule.h"
#include "io/mesh/write_surface.h"

namespace raycone {

struct SurfaceCommand {
  MeshOptions mesh;
  RunOptions run;
  OutputFiles output;
  SurfaceFormat format = SurfaceFormat::kPly;
  std::variant<LatticeRequest, GridReference> lattice;
  Rule rule;
  double thickness = 0.0;  // by which the set grows, world units
  bool merge_planes = true;
  double simplify = 0.0;  // how far the surface may move, world units
};

}  // namespace raycone
