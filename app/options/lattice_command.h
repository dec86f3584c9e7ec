// `raycone lattice`: values on a regular lattice.
#pragma once

#include <variant>

#include "app/options/field_options.h"
#include "app/options/lattice_request.h"
#include "app/options/mesh_options.h"
#include "app/options/output_options.h"
#include "app/options/run_options.h"

namespace raycone {

struct LatticeCommand {
  MeshOptions mesh;
  RunOptions run;
  FieldOptions field;
  OutputFiles output;
  FieldEncoding encoding;
  std::variant<LatticeRequest, GridReference> lattice;
};

}  // namespace raycone
