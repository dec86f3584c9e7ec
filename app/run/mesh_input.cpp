#include "app/run/mesh_input.h"

#include <cstdint>
#include <filesystem>
#include <system_error>
#include <utility>

#include "app/process/limits.h"
#include "app/process/messages.h"
#include "core/mesh/polygons.h"
#include "core/mesh/weld.h"
#include "io/files/file_error.h"

namespace raycone {

MeshFile read_mesh_file(const MeshOptions& options, const RunLimits& limits) {
  std::error_code error;  // what has no size, such as a pipe, is not checked
  const std::uintmax_t size = std::filesystem::file_size(options.path, error);
  if (!error && options.path != "-") check_memory(options.path, static_cast<double>(size), limits.memory());
  MeshFile file = read_mesh(options.path, options.reading);
  const std::vector<PolygonFan> polygons = std::move(file.parsed.polygons);
  if (const std::uint64_t bad = cut_concave_polygons(file.parsed.mesh, polygons)) {
    const std::string what = bad == 1 ? " polygon that crosses itself" : " polygons that cross themselves";
    file.parsed.warnings.push_back("bad-polygons: " + std::to_string(bad) + what +
                                   ", seen along the area vector, fanned from the first corner");
  }
  return file;
}

OrientedMesh mesh_to_evaluate(TriangleMesh as_read, const MeshOptions& options, std::vector<std::string>& warnings) {
  OrientedMesh oriented = orient(weld(std::move(as_read), options.weld), options.orient);
  if (const std::uint64_t cut = oriented.counts.cut_edges) {
    const std::string edges = cut == 1 ? " edge was" : " edges were";
    warnings.push_back("unorientable: " + std::to_string(cut) + edges +
                       " cut, because no orientation makes all faces agree");
  }
  return oriented;
}

void print_warnings(const std::vector<std::string>& warnings, const RunOptions& options, const std::string& mesh) {
  for (const std::string& warning : warnings) {
    if (options.strict) throw InputError(mesh + ": " + warning + " (an error because of --strict)");
    if (!options.quiet) print_message("warning: " + mesh + ": " + warning);
  }
}

}  // namespace raycone
