// Reader of glTF 2.0 and GLB: the triangles of the default scene in world coordinates. Specification: Khronos Group,
// "glTF 2.0 Specification" (2021); what is accepted beyond it and what is refused: docs/formats.md.
//
// Hostile input: every accessor is checked against its view, buffer and bytes before it is read; nothing recurses; what
// sharing and instancing may multiply is bounded by a GltfBudget.
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <span>
#include <utility>

#include "io/files/file_error.h"
#include "io/mesh/gltf_accessors.h"
#include "io/mesh/gltf_document.h"
#include "io/mesh/gltf_resources.h"
#include "io/mesh/mesh_builder.h"
#include "io/mesh/read_mesh.h"

namespace raycone {
namespace {

constexpr std::uint64_t kTriangles = 4;
constexpr std::uint64_t kTriangleStrip = 5;

constexpr std::uint64_t kMaxVertices = std::numeric_limits<std::uint32_t>::max();

std::string counted(std::uint64_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

// Makes room for `count` more elements, growing geometrically all the same.
template <class Element>
void make_room(std::vector<Element>& elements, std::size_t count) {
  if (count > elements.capacity() - elements.size()) {
    elements.reserve(std::max(elements.size() + count, 2 * elements.capacity()));
  }
}

// --- Extensions -----------------------------------------------------------------------------------------------------

// Extensions that change what triangles look like or tell about them, never where they are.
bool leaves_geometry_alone(const std::string& extension) {
  static constexpr std::array kKinds{"_materials_", "_texture_",   "_lights_", "_camera",      "_image_",
                                     "_packing_",   "_animation_", "_xmp",     "_techniques_", "_ngon_encoding"};
  return std::any_of(kKinds.begin(), kKinds.end(),
                     [&](const char* kind) { return extension.find(kind) != std::string::npos; });
}

void check_extensions(const GltfDocument& document, const std::string& file) {
  static const std::string kInstancing = "EXT_mesh_gpu_instancing";
  const auto& used = document.extensions_used;
  // It has no fallback: without it all instances but one would be missing.
  if (document.gpu_instancing || std::find(used.begin(), used.end(), kInstancing) != used.end()) {
    throw InputError(file + ": uses the extension " + kInstancing + ", which is not supported");
  }
  for (const std::string& extension : document.extensions_required) {
    const bool is_read = extension == "KHR_mesh_quantization" || extension == "KHR_node_visibility";
    if (!is_read && !leaves_geometry_alone(extension)) {
      throw InputError(file + ": requires the extension " + extension + ", which is not supported");
    }
  }
}

// --- Meshes ---------------------------------------------------------------------------------------------------------

std::string printed(const Vec3& v) {
  return "(" + std::to_string(v.x) + ", " + std::to_string(v.y) + ", " + std::to_string(v.z) + ")";
}

// What is left out of the result, for warnings.
struct Omissions {
  std::uint64_t incomplete_faces = 0;
  std::uint64_t points_or_lines = 0;
  std::uint64_t without_positions = 0;
  std::uint64_t skinned = 0;
  std::uint64_t morphed = 0;
  std::uint64_t without_nodes = 0;
};

// Assembles one mesh of the document in its own coordinates.
class MeshAssembler {
 public:
  MeshAssembler(const std::string& file, const GltfDocument& document, GltfAccessors& accessors, GltfBudget& budget,
                Omissions& omissions)
      : file_(file), document_(document), accessors_(accessors), budget_(budget), omissions_(omissions) {}

  TriangleMesh assemble(std::size_t mesh) {
    result_ = {};
    first_vertex_.clear();
    const auto& primitives = document_.meshes[mesh].primitives;
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      place_ = file_ + ": mesh " + std::to_string(mesh) + ", primitive " + std::to_string(i) + ": ";
      add(primitives[i]);
    }
    return std::move(result_);
  }

 private:
  struct Range {
    std::size_t first = 0;
    std::size_t count = 0;
  };

  void add(const GltfPrimitive& primitive) {
    if (primitive.mode < kTriangles) {
      ++omissions_.points_or_lines;
    } else if (!primitive.positions) {
      ++omissions_.without_positions;
    } else {
      refuse_draco_only(primitive);
      const Range vertices = add_vertices(*primitive.positions);
      if (primitive.indices) {
        const std::vector<std::uint32_t> indices = accessors_.indices(*primitive.indices);
        check_indices(indices, restart_value(document_.accessors[*primitive.indices]), vertices.count);
        add_faces(primitive.mode, indices.size(), vertices, [&](std::size_t corner) { return indices[corner]; });
      } else {
        add_faces(primitive.mode, vertices.count, vertices,
                  [](std::size_t corner) { return static_cast<std::uint32_t>(corner); });
      }
    }
  }

  // Where Draco is not required, the accessors must hold the same geometry uncompressed.
  void refuse_draco_only(const GltfPrimitive& primitive) const {
    const auto has_data = [&](std::size_t accessor) { return document_.accessors[accessor].view.has_value(); };
    const bool complete = has_data(*primitive.positions) && (!primitive.indices || has_data(*primitive.indices));
    if (primitive.draco && !complete) {
      throw InputError(place_ +
                       "has no data but those of the extension KHR_draco_mesh_compression, which is not supported");
    }
  }

  // Primitives often share one accessor: its vertices are added once.
  Range add_vertices(std::size_t accessor) {
    const auto known = first_vertex_.find(accessor);
    if (known != first_vertex_.end()) return known->second;
    std::vector<Vec3> positions = accessors_.positions(accessor);
    const Range range{result_.vertices.size(), positions.size()};
    if (positions.size() > kMaxVertices - range.first) {
      throw LimitError(place_ + "more than " + std::to_string(kMaxVertices) + " vertices");
    }
    if (range.first == 0) {
      result_.vertices = std::move(positions);
    } else {
      result_.vertices.insert(result_.vertices.end(), positions.begin(), positions.end());
    }
    first_vertex_.emplace(accessor, range);
    return range;
  }

  void check_indices(const std::vector<std::uint32_t>& indices, std::uint32_t restart, std::size_t count) const {
    for (const std::uint32_t index : indices) {
      if (index == restart) {
        throw InputError(place_ + "index " + std::to_string(index) + " is the restart value, expected a vertex");
      }
      if (index >= count) {
        throw InputError(place_ + "index " + std::to_string(index) + ", but only " + std::to_string(count) +
                         " vertices");
      }
    }
  }

  // corner(i): the vertex of the primitive's i-th corner.
  template <class Corner>
  void add_faces(std::uint64_t mode, std::size_t corners, const Range& vertices, Corner corner) {
    const std::size_t faces = mode == kTriangles ? corners / 3 : corners < 3 ? 0 : corners - 2;
    const std::size_t used = mode == kTriangles ? 3 * faces : faces == 0 ? 0 : corners;
    omissions_.incomplete_faces += used < corners;
    budget_.spend(faces);
    make_room(result_.triangles, faces);
    for (std::size_t i = 0; i < faces; ++i) {
      if (mode == kTriangles) {
        add_face(vertices, corner(3 * i), corner(3 * i + 1), corner(3 * i + 2));
      } else if (mode == kTriangleStrip) {
        // Every other triangle of a strip is listed backwards.
        add_face(vertices, corner(i), corner(i + 1 + i % 2), corner(i + 2 - i % 2));
      } else {
        add_face(vertices, corner(0), corner(i + 1), corner(i + 2));
      }
    }
  }

  void add_face(const Range& vertices, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    for (const std::uint32_t index : {a, b, c}) {
      const Vec3& vertex = result_.vertices[vertices.first + index];
      if (!is_finite(vertex)) {
        throw InputError(place_ + "vertex " + std::to_string(index) + " is " + printed(vertex) +
                         ", expected finite coordinates");
      }
    }
    const auto first = static_cast<std::uint32_t>(vertices.first);
    result_.triangles.push_back({first + a, first + b, first + c});
  }

  const std::string& file_;
  const GltfDocument& document_;
  GltfAccessors& accessors_;
  GltfBudget& budget_;
  Omissions& omissions_;
  std::string place_;  // of the primitive at hand, for messages
  TriangleMesh result_;
  std::map<std::size_t, Range> first_vertex_;  // of the accessors in result_
};

// --- Nodes ----------------------------------------------------------------------------------------------------------

GltfTransform composed(const GltfTransform& outer, const GltfTransform& inner) {
  GltfTransform result;
  for (std::size_t row = 0; row < 3; ++row) {
    const auto& o = outer.rows[row];
    for (std::size_t column = 0; column < 4; ++column) {
      result.rows[row][column] =
          o[0] * inner.rows[0][column] + o[1] * inner.rows[1][column] + o[2] * inner.rows[2][column];
    }
    result.rows[row][3] += o[3];
  }
  result.mirrored = outer.mirrored != inner.mirrored;
  return result;
}

Vec3 transformed(const GltfTransform& transform, const Vec3& v) {
  const auto coordinate = [&](const std::array<double, 4>& row) {
    return row[0] * v.x + row[1] * v.y + row[2] * v.z + row[3];
  };
  return {coordinate(transform.rows[0]), coordinate(transform.rows[1]), coordinate(transform.rows[2])};
}

// How many nodes each node is a child of. The specification allows one, but files that share children exist and mean
// what they seem to: each parent shows its own copy.
std::vector<std::size_t> parent_counts(const GltfDocument& document) {
  std::vector<std::size_t> counts(document.nodes.size(), 0);
  for (const GltfNode& node : document.nodes) {
    for (const std::size_t child : node.children) ++counts[child];
  }
  return counts;
}

// Removes nodes without parents until none is left (A. B. Kahn, "Topological Sorting of Large Networks", 1962).
void check_acyclic(const GltfDocument& document, std::vector<std::size_t> parents, const std::string& file) {
  std::vector<std::size_t> free;
  for (std::size_t node = 0; node < parents.size(); ++node) {
    if (parents[node] == 0) free.push_back(node);
  }
  for (std::size_t i = 0; i < free.size(); ++i) {
    for (const std::size_t child : document.nodes[free[i]].children) {
      if (--parents[child] == 0) free.push_back(child);
    }
  }
  if (free.size() < parents.size()) throw InputError(file + ": some nodes are their own ancestors, expected a tree");
}

// The roots of the scene shown: the default one, else the first, else all roots.
std::vector<std::size_t> shown_roots(const GltfDocument& document, const std::vector<std::size_t>& parents,
                                     const std::string& file) {
  std::vector<std::size_t> roots;
  if (document.scenes.empty()) {
    for (std::size_t node = 0; node < parents.size(); ++node) {
      if (parents[node] == 0) roots.push_back(node);
    }
    return roots;
  }
  const std::size_t scene = document.scene.value_or(0);
  roots = document.scenes[scene];
  for (const std::size_t node : roots) {
    if (parents[node] != 0) {
      throw InputError(file + ": scene " + std::to_string(scene) + " names node " + std::to_string(node) +
                       ", which is a child of another, expected a root node");
    }
  }
  return roots;
}

// A mesh and where it stands in the world.
struct Instance {
  std::size_t mesh = 0;
  GltfTransform placement;
};

// Calls visit(node, placement) for the scene's visible nodes, parents before children.
template <class Visit>
void visit_scene(const GltfDocument& document, const std::string& file, Visit visit) {
  const std::vector<std::size_t> parents = parent_counts(document);
  check_acyclic(document, parents, file);
  const std::vector<std::size_t> roots = shown_roots(document, parents, file);
  struct Level {
    std::span<const std::size_t> nodes;  // siblings still to be visited
    GltfTransform outer;
  };
  std::vector<Level> levels{{roots, {}}};
  // Shared children of shared children may multiply without bound.
  const std::size_t max_visits = (std::size_t{1} << 20) + 4 * document.nodes.size();
  for (std::size_t visits = 0; !levels.empty();) {
    Level& level = levels.back();
    if (level.nodes.empty()) {
      levels.pop_back();
      continue;
    }
    if (++visits > max_visits) throw LimitError(file + ": nodes with several parents make too many copies");
    const GltfNode& node = document.nodes[level.nodes.front()];
    level.nodes = level.nodes.subspan(1);
    if (!node.visible) continue;
    const GltfTransform placement =
        node.transform ? composed(level.outer, document.transforms[*node.transform]) : level.outer;
    visit(node, placement);
    if (!node.children.empty()) levels.push_back({node.children, placement});
  }
}

// All instances of the scene shown, those of one mesh together.
std::vector<Instance> instances_of(const GltfDocument& document, const std::string& file, Omissions& omissions) {
  std::vector<Instance> instances;
  // "A glTF asset that does not contain any scenes should be treated as a library": without nodes, all of it is meant.
  if (document.nodes.empty() && document.scenes.empty()) {
    for (std::size_t mesh = 0; mesh < document.meshes.size(); ++mesh) instances.push_back({mesh, {}});
    omissions.without_nodes = instances.size();
    return instances;
  }
  visit_scene(document, file, [&](const GltfNode& node, const GltfTransform& placement) {
    if (!node.mesh) return;
    omissions.skinned += node.skinned;
    omissions.morphed += node.morphed || document.meshes[*node.mesh].morphed;
    // The joints alone place a skinned mesh, never its node (section 3.7.3.3); at rest they leave it as it is.
    instances.push_back({*node.mesh, node.skinned ? GltfTransform{} : placement});
  });
  std::stable_sort(instances.begin(), instances.end(),
                   [](const Instance& a, const Instance& b) { return a.mesh < b.mesh; });
  return instances;
}

// --- World ----------------------------------------------------------------------------------------------------------

// Adds `mesh`, placed as `instance` says, to `world`.
void append(const TriangleMesh& mesh, const Instance& instance, const std::string& file, TriangleMesh& world) {
  const std::size_t first = world.vertices.size();
  if (mesh.vertices.size() > kMaxVertices - first) {
    throw LimitError(file + ": more than " + std::to_string(kMaxVertices) + " vertices");
  }
  make_room(world.vertices, mesh.vertices.size());
  make_room(world.triangles, mesh.triangles.size());
  for (const Vec3& vertex : mesh.vertices) world.vertices.push_back(transformed(instance.placement, vertex));
  for (Triangle triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle) {
      corner += static_cast<std::uint32_t>(first);
      if (!is_finite(world.vertices[corner])) {
        throw InputError(file + ": mesh " + std::to_string(instance.mesh) + ": vertex " +
                         std::to_string(corner - first) + " is not finite once its node's transform is applied");
      }
    }
    if (instance.placement.mirrored) std::swap(triangle[1], triangle[2]);
    world.triangles.push_back(triangle);
  }
}

std::vector<std::string> warnings_of(const Omissions& omissions) {
  std::vector<std::string> warnings;
  const auto warn = [&](std::uint64_t count, const char* noun, const char* what) {
    if (count > 0) warnings.push_back(counted(count, noun) + " " + what);
  };
  warn(omissions.incomplete_faces, "face", "with fewer than three corners skipped");
  warn(omissions.points_or_lines, "primitive", "of points or lines ignored");
  warn(omissions.without_positions, "primitive", "without positions ignored");
  warn(omissions.skinned, "skinned mesh instance", "taken in the bind pose, without its joints");
  warn(omissions.morphed, "morphed mesh instance", "taken without its morph targets");
  warn(omissions.without_nodes, "mesh instance", "taken untransformed, because the file has no nodes");
  return warnings;
}

}  // namespace

ParsedMesh read_gltf(const NamedBytes& source, std::vector<FileRead>* companions) {
  GlbChunks chunks{source.bytes, 0, std::nullopt};
  const bool glb = is_glb(source.bytes);
  if (glb) chunks = split_glb(source);
  const GltfDocument document = parse_gltf_document(
      {source.name, chunks.json, glb ? std::optional<std::size_t>(chunks.json_offset) : std::nullopt});
  check_extensions(document, source.name);

  GltfBudget budget(source.name);
  GltfAccessors accessors(source, document, chunks.binary, budget, companions);
  Omissions omissions;
  MeshAssembler assembler(source.name, document, accessors, budget, omissions);

  ParsedMesh parsed;
  const std::vector<Instance> instances = instances_of(document, source.name, omissions);
  for (auto group = instances.begin(); group != instances.end();) {
    const auto end = std::find_if(group, instances.end(), [&](const Instance& i) { return i.mesh != group->mesh; });
    const TriangleMesh mesh = assembler.assemble(group->mesh);
    budget.spend(mesh.vertices.size() + mesh.triangles.size(), static_cast<std::uint64_t>(end - group));
    for (; group != end; ++group) append(mesh, *group, source.name, parsed.mesh);
  }
  parsed.skipped_faces = omissions.incomplete_faces;
  parsed.warnings = warnings_of(omissions);
  return parsed;
}

}  // namespace raycone
