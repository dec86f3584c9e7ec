// From a mesh file to the mesh that is evaluated.
#pragma once

#include <string>
#include <vector>

#include "app/options/mesh_options.h"
#include "app/options/run_options.h"
#include "app/run/run_limits.h"
#include "core/data/triangle_mesh.h"
#include "core/orientation/orient.h"
#include "io/mesh/read_mesh.h"

namespace raycone {

// The mesh as it is in the file, its concave polygons cut. Throws InputError, LimitError where the file alone is too
// large for the memory.
[[nodiscard]] MeshFile read_mesh_file(const MeshOptions& options, const RunLimits& limits);

// All that is done to a mesh before anything is made of it: the one place for it. What is worth a warning is added to
// `warnings`.
[[nodiscard]] OrientedMesh mesh_to_evaluate(TriangleMesh as_read, const MeshOptions& options,
                                            std::vector<std::string>& warnings);

// Prints `warnings` about `mesh`; throws the first of them as InputError with --strict.
void print_warnings(const std::vector<std::string>& warnings, const RunOptions& options, const std::string& mesh);

}  // namespace raycone
