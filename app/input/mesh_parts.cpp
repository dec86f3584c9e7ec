#include "app/input/mesh_parts.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "core/mesh/components.h"
#include "io/files/file_error.h"
#include "io/files/unpack.h"

namespace raycone {
namespace {

// Bytes of meshes that are kept to spare reading them again.
constexpr std::size_t kKept = std::size_t{64} << 20;

std::size_t bytes_of(const TriangleMesh& mesh) {
  return mesh.vertices.size() * sizeof(Vec3) + mesh.triangles.size() * sizeof(Triangle);
}

// "left/femur.stl.gz" as "femur".
std::string stem_of(const std::string& path) {
  const std::string stem = std::filesystem::path(without_packing_extension(path)).stem().string();
  return path == "-" || stem.empty() ? path : stem;
}

// Can a file be read twice?
bool is_regular(const std::string& path) {
  std::error_code error;
  return path != "-" && std::filesystem::is_regular_file(path, error);
}

void append(const TriangleMesh& mesh, TriangleMesh& all, const std::string& path) {
  const std::size_t first = all.vertices.size();
  if (mesh.vertices.size() > 0xFFFFFFFF - first || mesh.triangles.size() > kMaxTriangles - all.triangles.size()) {
    throw LimitError(path + ": more than 4294967295 vertices or 2147483647 triangles in all meshes together");
  }
  all.vertices.insert(all.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
  for (Triangle triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle) corner += static_cast<std::uint32_t>(first);
    all.triangles.push_back(triangle);
  }
}

// Of each of `triangles` its group.
std::vector<std::uint32_t> group_of_each(const FaceGroups& groups, std::size_t triangles) {
  std::vector<std::uint32_t> group(triangles);
  for (std::size_t n = 0; n < groups.runs.size(); ++n) {
    const std::size_t end = n + 1 < groups.runs.size() ? groups.runs[n + 1].first : triangles;
    for (std::size_t f = groups.runs[n].first; f < end; ++f) group[f] = groups.runs[n].group;
  }
  return group;
}

}  // namespace

MeshParts::MeshParts(const MeshOptions& options, const RunLimits& limits, WholeMesh whole)
    : options_(options), limits_(limits) {
  files_.resize(1 + options.further.size());
  files_.front().read.path = options.path;
  for (std::size_t n = 0; n < options.further.size(); ++n) files_[n + 1].read.path = options.further[n];
  if (whole != WholeMesh::kUnused || options.normalize || files_.size() == 1) {
    keep_all();
  } else {
    keep_some();
  }
}

// The mesh of a file, scaled and turned; what else is known of it goes to files_.
TriangleMesh MeshParts::read(std::size_t file) {
  File& known = files_[file];
  MeshOptions options = options_;
  options.path = known.read.path;
  options.normalize.reset();
  TransformedMesh transformed = read_mesh_file(options, limits_);
  MeshFile& read = transformed.file;
  const bool same = known.read.sha256 == read.sha256 && known.companions == read.companions;
  if (!known.read.sha256.empty() && !same) {
    throw InputError(known.read.path + ": has changed since it was read first");
  }
  known.read.sha256 = read.sha256;
  known.unit = read.parsed.unit;
  known.companions = std::move(read.companions);
  known.vertices = read.parsed.mesh.vertices.size();
  known.faces = read.parsed.mesh.triangles.size();
  known.warnings = std::move(read.parsed.warnings);
  transform_ = transformed.transform;
  if (options_.parts.by == PartsBy::kGroup && names_.empty()) {
    if (read.parsed.groups.runs.empty()) {
      throw InputError(known.read.path +
                       ": its format has no groups, expected OBJ, STL, glTF or 3MF, or --parts component");
    }
    groups_ = std::move(read.parsed.groups);
  }
  return std::move(read.parsed.mesh);
}

void MeshParts::keep_all() {
  TriangleMesh all = read(0);
  std::vector<std::uint32_t> part_of(all.triangles.size(), 0);
  for (std::size_t file = 1; file < files_.size(); ++file) {
    append(read(file), all, files_[file].read.path);
    part_of.resize(all.triangles.size(), static_cast<std::uint32_t>(file));
  }
  transform_ = normalize_mesh(all, options_);
  name_parts(all, part_of);
  split_.emplace(std::move(all), part_of, static_cast<std::uint32_t>(names_.size()));
  if (options_.weld.mode != WeldMode::kDistance) {
    box_ = bounding_box(whole());
  } else if (files_.size() == 1) {
    box_ = welded_box(whole());
  } else {
    for (std::uint32_t file = 0; file < files_.size(); ++file) extend_box(welded_box(split_->part(file)));
  }
}

// Names the parts of `all` and tells of each triangle its part. `part_of`: of each its file. Components are found among
// welded triangles.
void MeshParts::name_parts(TriangleMesh& all, std::vector<std::uint32_t>& part_of) {
  if (options_.parts.by == PartsBy::kFile) {
    for (const File& file : files_) names_.push_back(stem_of(file.read.path));
  } else if (options_.parts.by == PartsBy::kGroup) {
    part_of = group_of_each(groups_, all.triangles.size());
    name_groups(part_of);
  } else {
    all = welded_mesh(std::move(all), options_, files_.front().warnings);
    const Components components = components_of(all);
    for (std::size_t f = 0; f < part_of.size(); ++f) part_of[f] = components.of_vertex[all.triangles[f][0]];
    for (std::uint32_t n = 0; n < components.count; ++n) names_.push_back("component " + std::to_string(n + 1));
  }
}

// Components are welded before they are told apart.
Box MeshParts::welded_box(TriangleMesh mesh) const {
  const bool moves_vertices = options_.weld.mode == WeldMode::kDistance && options_.parts.by != PartsBy::kComponent;
  std::vector<Warning> told_of_parts;
  if (moves_vertices) mesh = welded_mesh(std::move(mesh), options_, told_of_parts);
  return bounding_box(mesh);
}

// Groups whose polygons have become no triangles are no parts.
void MeshParts::name_groups(std::vector<std::uint32_t>& part_of) {
  std::vector<std::uint32_t> number(groups_.names.size());
  for (const std::uint32_t group : part_of) number[group] = 1;
  for (std::size_t group = 0; group < number.size(); ++group) {
    if (number[group] == 0) continue;
    number[group] = static_cast<std::uint32_t>(names_.size());
    std::string& name = groups_.names[group];
    names_.push_back(name.empty() ? "part " + std::to_string(names_.size() + 1) : std::move(name));
  }
  for (std::uint32_t& part : part_of) part = number[part];
}

void MeshParts::keep_some() {
  std::size_t room = kKept;
  for (std::size_t file = 0; file < files_.size(); ++file) {
    TriangleMesh mesh = read(file);
    names_.push_back(stem_of(files_[file].read.path));
    std::optional<TriangleMesh>& kept = kept_.emplace_back();
    // Welding leaves a third of what many files hold.
    if (is_regular(files_[file].read.path) && bytes_of(mesh) / 3 > room) {
      extend_box(welded_box(std::move(mesh)));
      continue;
    }
    kept = welded_mesh(std::move(mesh), options_, files_[file].warnings);
    extend_box(bounding_box(*kept));
    kept->vertices.shrink_to_fit();
    room -= std::min(bytes_of(*kept), room);
  }
}

TriangleMesh MeshParts::part(std::size_t part, std::vector<Warning>& warnings) {
  if (split_ && options_.parts.by == PartsBy::kComponent) return split_->part(static_cast<std::uint32_t>(part));
  if (split_) return welded_mesh(split_->part(static_cast<std::uint32_t>(part)), options_, warnings);
  if (!kept_[part]) return welded_mesh(read(part), options_, warnings);
  TriangleMesh kept = std::move(*kept_[part]);
  kept_[part].reset();
  return kept;
}

}  // namespace raycone
