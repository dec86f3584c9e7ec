#include "app/input/mesh_input.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <system_error>
#include <utility>

#include "app/input/mesh_warnings.h"
#include "app/process/memory_limit.h"
#include "app/process/messages.h"
#include "core/mesh/normalize.h"
#include "core/mesh/polygons.h"
#include "core/mesh/weld.h"
#include "io/files/file_error.h"

namespace raycone {
namespace {

std::uint64_t cut_polygons(TriangleMesh& mesh, const std::vector<PolygonFan>& polygons, FaceGroups& groups) {
  std::vector<std::uint64_t> firsts;
  for (const GroupRun& run : groups.runs) firsts.push_back(run.first);
  const std::uint64_t bad = cut_concave_polygons(mesh, polygons, firsts);
  for (std::size_t n = 0; n < firsts.size(); ++n) groups.runs[n].first = firsts[n];
  return bad;
}

// Moves and scales the mesh, where that is asked for.
Normalization normalized(TriangleMesh& mesh, const MeshOptions& options) {
  if (!options.normalize) return {};
  const Normalization normalization = normalization_of(mesh, *options.normalize);
  const Box box = bounding_box(mesh);
  if (box.lower == box.upper) {
    throw InputError(options.path + ": all corners are at one point, expected an extent for --normalize");
  }
  apply(normalization, mesh.vertices);
  const Box result = bounding_box(mesh);
  bool finite = true;
  for (int axis = 0; axis < 3; ++axis) finite &= std::isfinite(result.lower[axis]) && std::isfinite(result.upper[axis]);
  if (!finite || !std::isfinite(normalization.factor) || !(normalization.factor > 0.0) ||
      result.lower == result.upper) {
    throw LimitError(options.path + ": its size is beyond what double precision can normalize; see --scale");
  }
  return normalization;
}

// Scaling, then turning, then normalization.
Matrix4 transform_of(const ReadMeshOptions& reading, const Normalization& normalization) {
  const double s = reading.scale, f = normalization.factor;
  const Vec3& m = normalization.middle;
  const double scale = f * s;
  // 0 - x, so that there is no -0
  if (reading.y_up_to_z_up) {
    return {scale, 0, 0, 0 - f * m.x, 0, 0, -scale, 0 - f * m.y, 0, scale, 0, 0 - f * m.z, 0, 0, 0, 1};
  }
  return {scale, 0, 0, 0 - f * m.x, 0, scale, 0, 0 - f * m.y, 0, 0, scale, 0 - f * m.z, 0, 0, 0, 1};
}

}  // namespace

TransformedMesh read_mesh_file(const MeshOptions& options, const RunLimits& limits) {
  std::error_code error;  // what has no size, such as a pipe, is not checked
  const std::uintmax_t size = std::filesystem::file_size(options.path, error);
  if (!error && options.path != "-") check_memory(options.path, static_cast<double>(size), limits.memory());
  MeshFile file = read_mesh(options.path, options.reading);
  const std::vector<PolygonFan> polygons = std::move(file.parsed.polygons);
  if (const std::uint64_t bad = cut_polygons(file.parsed.mesh, polygons, file.parsed.groups)) {
    const std::string what = bad == 1 ? " polygon that crosses itself" : " polygons that cross themselves";
    file.parsed.warnings.push_back(
        {"bad-polygons", std::to_string(bad) + what + ", seen along the area vector, fanned from the first corner"});
  }
  const Matrix4 transform = normalize_mesh(file.parsed.mesh, options);
  return {std::move(file), transform};
}

Matrix4 normalize_mesh(TriangleMesh& mesh, const MeshOptions& options) {
  const Normalization normalization = normalized(mesh, options);
  return transform_of(options.reading, normalization);
}

TriangleMesh welded_mesh(TriangleMesh as_read, const MeshOptions& options, std::vector<Warning>& warnings) {
  const bool may_collapse = options.weld.mode == WeldMode::kDistance;
  const std::uint64_t before = may_collapse ? triangles_with_corners(as_read) : 0;
  TriangleMesh mesh = weld(std::move(as_read), options.weld);
  const std::uint64_t after = may_collapse ? triangles_with_corners(mesh) : 0;
  if (after < before) warnings.push_back(weld_collapsed(before - after, options.weld.distance));
  return mesh;
}

MeshToEvaluate oriented_mesh(TriangleMesh welded, const MeshOptions& options) {
  const EqualVertices equal = options.weld.mode == WeldMode::kNone ? EqualVertices::kMayBe : EqualVertices::kNone;
  OrientedMesh oriented = orient(std::move(welded), options.orient, equal);
  MeshToEvaluate result{std::move(oriented.mesh), oriented.counts, {}, {}, std::move(oriented.places)};
  VertexLinks links(result.mesh.vertices.size());
  result.edges = exterior_edges(result.mesh, &links);
  result.defects = mesh_defects(result.mesh, result.edges, links);
  // What faces inward then beside open edges may be a cavity of an open body.
  if (options.orient == Orient::kAuto && !result.edges.empty()) result.defects.reversed_components = 0;
  return result;
}

MeshToEvaluate mesh_to_evaluate(TriangleMesh as_read, const MeshOptions& options, std::vector<Warning>& warnings) {
  MeshToEvaluate result = oriented_mesh(welded_mesh(std::move(as_read), options, warnings), options);
  std::ranges::move(warnings_about(result.orientation), std::back_inserter(warnings));
  std::ranges::move(warnings_about(result.defects, options.orient), std::back_inserter(warnings));
  return result;
}

void print_warnings(const std::vector<Warning>& warnings, const RunOptions& options, const std::string& mesh) {
  for (const Warning& warning : warnings) {
    const std::string line = mesh + ": " + line_of(warning);
    if (options.strict) throw StrictWarning(line + " (an error because of --strict)", warning);
    if (!options.quiet) print_message("warning: " + line);
  }
}

}  // namespace raycone
