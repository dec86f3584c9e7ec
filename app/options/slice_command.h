// `raycone slice`: a picture of one cross-section.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "app/options/field_options.h"
#include "app/options/lattice_request.h"
#include "app/options/mesh_options.h"
#include "app/options/output_options.h"
#include "app/options/run_options.h"

namespace raycone {

// Of the box, before padding, from its lower to its upper end.
struct Percentage {
  double value = 50.0;
};

struct AxisPlane {
  int axis = 2;
  std::variant<Percentage, double> at;  // or world units
};

struct ObliquePlane {
  std::optional<Vec3> origin;  // a point of the plane; else the middle of the box
  Vec3 normal;                 // towards the viewer, not zero
  std::optional<Vec3> up;      // else z, or y for a plane across z
};

struct SliceRequest {
  std::optional<Box> bounds;  // in place of the mesh's box
  std::variant<WorldPadding, VoxelPadding> padding;
  std::variant<AxisPlane, ObliquePlane> plane;
  std::int64_t size = 1024;  // pixels along the longer side
};

struct SliceCommand {
  MeshOptions mesh;
  RunOptions run;
  OutputFiles output;
  FieldOptions field;  // one field, without diagnostics
  SliceRequest slice;
  bool framed = true;                 // with axes and legend
  std::optional<std::string> values;  // file for the numbers
};

}  // namespace raycone
