// From a mesh file to the mesh that is evaluated.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "app/input/run_limits.h"
#include "app/options/mesh_options.h"
#include "app/options/run_options.h"
#include "core/data/triangle_mesh.h"
#include "core/data/warning.h"
#include "core/mesh/exterior_edges.h"
#include "core/orientation/mesh_defects.h"
#include "core/orientation/orient.h"
#include "io/files/file_error.h"
#include "io/mesh/read_mesh.h"

namespace raycone {

using Matrix4 = std::array<double, 16>;  // row by row; for column vectors

struct TransformedMesh {
  MeshFile file;
  Matrix4 transform{};  // from the file's coordinates to the mesh's
};

// Moves and scales `mesh` where `options` say so (--normalize); --scale and turns are done already. Returns the matrix
// of all that is done to the file's coordinates. Throws InputError, LimitError.
[[nodiscard]] Matrix4 normalize_mesh(TriangleMesh& mesh, const MeshOptions& options);

// Reads a mesh, cuts its concave polygons, and scales, turns and normalizes it as `options` say. Throws InputError, and
// LimitError where the file alone is too large for the memory.
[[nodiscard]] TransformedMesh read_mesh_file(const MeshOptions& options, const RunLimits& limits);

// A mesh that is ready to be evaluated, and what is known of it then.
struct MeshToEvaluate {
  TriangleMesh mesh;
  OrientationCounts orientation;
  std::vector<ExteriorEdge> edges;
  MeshDefects defects;
  std::vector<std::uint32_t> places;  // of its faces among those read; empty: the same places
};

// Does all that is done to a mesh before it is evaluated, in two steps. What the user should know about that and about
// the result is appended to `warnings`, in a fixed order.
[[nodiscard]] MeshToEvaluate mesh_to_evaluate(TriangleMesh as_read, const MeshOptions& options,
                                              std::vector<Warning>& warnings);

// These two steps alone, without the warnings but for `weld-collapsed`, which the first one gives.
[[nodiscard]] TriangleMesh welded_mesh(TriangleMesh as_read, const MeshOptions& options,
                                       std::vector<Warning>& warnings);
[[nodiscard]] MeshToEvaluate oriented_mesh(TriangleMesh welded, const MeshOptions& options);

// A warning that --strict makes an error.
class StrictWarning : public InputError {
 public:
  StrictWarning(const std::string& message, const Warning& warning) : InputError(message), name_(warning.name) {}

  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  std::string name_;
};

// Prints `warnings` about `mesh`. With --strict throws the first of them as StrictWarning.
void print_warnings(const std::vector<Warning>& warnings, const RunOptions& options, const std::string& mesh);

}  // namespace raycone
