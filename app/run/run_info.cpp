#include "app/run/run_info.h"

#include <cstdint>
#include <utility>
#include <vector>

#include "app/report/info.h"
#include "app/report/json.h"
#include "app/run/lattice_choice.h"
#include "app/run/mesh_input.h"
#include "app/run/written_files.h"
#include "core/mesh/mesh_statistics.h"
#include "io/files/file_error.h"

namespace raycone {
namespace {

// The default, and what many go on to.
CostedLattices costed_lattices(const Box& bounds) {
  CostedLattices costed;
  std::vector<std::string> warnings;  // of flat sides: none with one count for all axes
  try {
    for (const std::int64_t resolution : {std::int64_t{64}, std::int64_t{256}}) {
      LatticeRequest request;
      request.sampling = LongestSide{resolution};
      costed.lattices.push_back(choose_lattice(bounds, request, warnings));
    }
  } catch (const LimitError& error) {
    costed.no_more = error.what();
  }
  return costed;
}

}  // namespace

std::string run_info(const InfoCommand& command, const RunLimits& limits) {
  const std::vector<WrittenFile> written{{"-", "output"}};
  refuse_to_replace_input(written, {command.mesh.path});
  MeshFile file = read_mesh_file(command.mesh, limits);
  for (const FileRead& companion : file.companions) refuse_to_replace_input(written, {companion.path});
  MeshInfo info;
  info.mesh = command.mesh.path;
  info.faces = file.parsed.mesh.triangles.size();
  info.vertices = file.parsed.mesh.vertices.size();
  info.skipped_faces = file.parsed.skipped_faces;
  const TriangleMesh mesh = mesh_to_evaluate(std::move(file.parsed.mesh), command.mesh, file.parsed.warnings).mesh;
  print_warnings(file.parsed.warnings, command.run, command.mesh.path);
  info.welded_vertices = mesh.vertices.size();
  info.bounds = bounding_box(mesh);
  info.statistics = mesh_statistics(mesh);
  return command.json ? to_json(info) : info_text(info, costed_lattices(info.bounds), limits.threads());
}

}  // namespace raycone
