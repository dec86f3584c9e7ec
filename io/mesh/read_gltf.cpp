// Reader of glTF 2.0 and GLB: the triangles of the default scene in world coordinates. Specification: Khronos Group,
// "glTF 2.0 Specification" (2021); what is accepted beyond it and what is refused: docs/formats.md.
//
// Hostile input: every accessor is checked against its view, buffer and bytes before it is read; nothing recurses; what
// sharing and instancing may multiply is bounded (GltfData::spend()).
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <span>
#include <utility>

#include "io/files/counted.h"
#include "io/files/file_error.h"
#include "io/files/text_scanner.h"
#include "io/mesh/affine_map.h"
#include "io/mesh/append_placed.h"
#include "io/mesh/gltf_data.h"
#include "io/mesh/gltf_document.h"
#include "io/mesh/gltf_omissions.h"
#include "io/mesh/gltf_resources.h"
#include "io/mesh/mesh_builder.h"
#include "io/mesh/mesh_error.h"
#include "io/mesh/read_mesh.h"

namespace raycone {
namespace {

// Makes room for `count` more elements, growing geometrically all the same.
template <class Element>
void make_room(std::vector<Element>& elements, std::size_t count) {
  if (count > elements.capacity() - elements.size()) {
    elements.reserve(std::max(elements.size() + count, 2 * elements.capacity()));
  }
}

// --- Meshes ---------------------------------------------------------------------------------------------------------

std::string printed(const Vec3& v) {
  return "(" + std::to_string(v.x) + ", " + std::to_string(v.y) + ", " + std::to_string(v.z) + ")";
}

// Assembles one mesh of the document in its own coordinates.
class MeshAssembler {
 public:
  MeshAssembler(const std::string& file, GltfData& data, GltfOmissions& omissions)
      : file_(file), data_(data), model_(data.model()), omissions_(omissions) {}

  TriangleMesh assemble(std::size_t mesh) {
    result_ = {};
    first_vertex_.clear();
    const auto& primitives = model_.meshes[mesh].primitives;
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

  void add(const tinygltf::Primitive& primitive) {
    const auto positions = primitive.attributes.find("POSITION");
    const auto indices = primitive.attributes.find(kGltfIndices);
    const bool indexed = indices != primitive.attributes.end();
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
      ++omissions_.points_or_lines;
    } else if (positions == primitive.attributes.end()) {
      ++omissions_.without_positions;
    } else if (auto draco = data_.decompressed(primitive, place_)) {
      add_indexed(primitive.mode, append_vertices(std::move(draco->vertices)), draco->corners, kMaxVertices);
    } else if (indexed) {
      const Range vertices = add_vertices(to_size(positions->second));
      const std::size_t accessor = to_size(indices->second);
      add_indexed(primitive.mode, vertices, data_.indices(accessor), restart_value(model_.accessors[accessor]));
    } else {
      const Range vertices = add_vertices(to_size(positions->second));
      add_faces(primitive.mode, vertices.count, vertices,
                [](std::size_t corner) { return static_cast<std::uint32_t>(corner); });
    }
  }

  // Primitives often share one accessor: its vertices are added once.
  Range add_vertices(std::size_t accessor) {
    const auto known = first_vertex_.find(accessor);
    if (known != first_vertex_.end()) return known->second;
    return first_vertex_[accessor] = append_vertices(data_.positions(accessor));
  }

  Range append_vertices(std::vector<Vec3> positions) {
    const Range range{result_.vertices.size(), positions.size()};
    if (positions.size() > kMaxVertices - range.first) fail_too_many_vertices(file_);
    if (range.first == 0) {
      result_.vertices = std::move(positions);
    } else {
      result_.vertices.insert(result_.vertices.end(), positions.begin(), positions.end());
    }
    return range;
  }

  void add_indexed(int mode, const Range& vertices, const std::vector<std::uint32_t>& corners, std::uint32_t restart) {
    for (const std::uint32_t index : corners) {
      if (index == restart) {
        throw InputError(place_ + "index " + std::to_string(index) + " is the restart value, expected a vertex");
      }
      if (index >= vertices.count) {
        throw InputError(place_ + "index " + std::to_string(index) + ", but only " + counted(vertices.count, "vertex"));
      }
    }
    add_faces(mode, corners.size(), vertices, [&](std::size_t corner) { return corners[corner]; });
  }

  // corner(i): the vertex of the primitive's i-th corner.
  template <class Corner>
  void add_faces(int mode, std::size_t corners, const Range& vertices, Corner corner) {
    const std::size_t faces = mode == TINYGLTF_MODE_TRIANGLES ? corners / 3 : corners < 3 ? 0 : corners - 2;
    const std::size_t used = mode == TINYGLTF_MODE_TRIANGLES ? 3 * faces : faces == 0 ? 0 : corners;
    omissions_.incomplete_faces += used < corners;
    data_.spend(faces);
    make_room(result_.triangles, faces);
    for (std::size_t i = 0; i < faces; ++i) {
      if (mode == TINYGLTF_MODE_TRIANGLES) {
        add_face(vertices, corner(3 * i), corner(3 * i + 1), corner(3 * i + 2));
      } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
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
  GltfData& data_;
  const tinygltf::Model& model_;
  GltfOmissions& omissions_;
  std::string place_;  // of the primitive at hand, for messages
  TriangleMesh result_;
  std::map<std::size_t, Range> first_vertex_;  // of the accessors in result_
};

// --- Nodes ----------------------------------------------------------------------------------------------------------

// Throws InputError where it is none.
AffineMap transform_of(const tinygltf::Node& node, const std::string& place) {
  const std::vector<double>& m = node.matrix;
  if (!m.empty()) {
    // Rounding of exporters is tolerated in the last row; a projection is not an affine map.
    constexpr double kTolerance = 1e-5;
    if (std::max({std::abs(m[3]), std::abs(m[7]), std::abs(m[11]), std::abs(m[15] - 1.0)}) > kTolerance) {
      throw InputError(place + "matrix is not affine, expected 0 0 0 1 in its last row");
    }
    return affine_map_of_matrix(m);
  }
  const auto vector_or = [](const std::vector<double>& v, const Vec3& otherwise) {
    return v.empty() ? otherwise : Vec3{v[0], v[1], v[2]};
  };
  const std::vector<double> rotation = node.rotation.empty() ? std::vector<double>{0, 0, 0, 1} : node.rotation;
  const double norm = std::inner_product(rotation.begin(), rotation.end(), rotation.begin(), 0.0);
  if (!std::isfinite(2 / norm) || !std::isfinite(norm)) throw InputError(place + "rotation is not a unit quaternion");
  return affine_map_of_parts(vector_or(node.translation, {}), rotation, vector_or(node.scale, {1, 1, 1}));
}

bool has_transform(const tinygltf::Node& node) {
  return !node.matrix.empty() || !node.translation.empty() || !node.rotation.empty() || !node.scale.empty();
}

bool is_visible(const tinygltf::Node& node) {
  const auto visibility = node.extensions.find(kGltfVisibility);
  return visibility == node.extensions.end() || !visibility->second.Has("visible") ||
         visibility->second.Get("visible").Get<bool>();
}

void check_unique(std::vector<int> nodes, const std::string& place) {
  std::ranges::sort(nodes);
  const auto twice = std::ranges::adjacent_find(nodes);
  if (twice != nodes.end()) throw InputError(place + std::to_string(*twice) + " twice, expected once");
}

// Checks all nodes, and returns how many nodes each is a child of. The specification allows one, but files that share
// children exist and mean what they seem to: each parent shows its own copy.
std::vector<std::size_t> parent_counts(const tinygltf::Model& model, const std::string& file) {
  std::vector<std::size_t> counts(model.nodes.size(), 0);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const tinygltf::Node& node = model.nodes[i];
    if (has_transform(node)) static_cast<void>(transform_of(node, file + ": node " + std::to_string(i) + ": "));
    check_unique(node.children, file + ": node " + std::to_string(i) + " has the child ");
    for (const int child : node.children) ++counts[to_size(child)];
  }
  return counts;
}

// Removes nodes without parents until none is left (A. B. Kahn, "Topological Sorting of Large Networks", 1962).
void check_acyclic(const tinygltf::Model& model, std::vector<std::size_t> parents, const std::string& file) {
  std::vector<std::size_t> free;
  for (std::size_t node = 0; node < parents.size(); ++node) {
    if (parents[node] == 0) free.push_back(node);
  }
  for (std::size_t i = 0; i < free.size(); ++i) {
    for (const int child : model.nodes[free[i]].children) {
      if (--parents[to_size(child)] == 0) free.push_back(to_size(child));
    }
  }
  if (free.size() < parents.size()) throw InputError(file + ": some nodes are their own ancestors, expected a tree");
}

// Those of the scene, and those that move or hide what is below them. Only what is below none of these may be a root of
// the scene: some exporters leave a node above it, which is in no scene and does nothing.
std::vector<int> nodes_that_act(const tinygltf::Model& model, std::vector<int> nodes) {
  for (const tinygltf::Node& node : model.nodes) {
    const auto number = static_cast<int>(&node - model.nodes.data());
    if (transform_of(node, "") != AffineMap{} || !is_visible(node)) nodes.push_back(number);
  }
  return nodes;
}

// Which nodes are children of these, their children and so on. Precondition: check_acyclic().
std::vector<bool> nodes_below(const tinygltf::Model& model, std::vector<int> nodes) {
  std::vector<bool> below(model.nodes.size(), false);
  while (!nodes.empty()) {
    const std::vector<int>& children = model.nodes[to_size(nodes.back())].children;
    nodes.pop_back();
    for (const int child : children) {
      if (below[to_size(child)]) continue;
      below[to_size(child)] = true;
      nodes.push_back(child);
    }
  }
  return below;
}

// The roots of the scene shown: the default one, else the first, else all roots.
std::vector<int> shown_roots(const tinygltf::Model& model, const std::vector<std::size_t>& parents,
                             const std::string& file) {
  if (model.scenes.empty()) {
    std::vector<int> roots;
    for (std::size_t node = 0; node < parents.size(); ++node) {
      if (parents[node] == 0) roots.push_back(static_cast<int>(node));
    }
    return roots;
  }
  const int scene = std::max(model.defaultScene, 0);
  const std::vector<int>& named = model.scenes[to_size(scene)].nodes;
  check_unique(named, file + ": scene " + std::to_string(scene) + " names node ");
  if (std::ranges::all_of(named, [&](int node) { return parents[to_size(node)] == 0; })) return named;
  const std::vector<bool> below = nodes_below(model, nodes_that_act(model, named));
  for (const int node : named) {
    if (below[to_size(node)]) {
      throw InputError(file + ": scene " + std::to_string(scene) + " names node " + std::to_string(node) +
                       ", which is a child of another, expected a root node");
    }
  }
  return named;
}

// Calls visit(number, placement) for the scene's visible nodes, parents before children.
template <class Visit>
void visit_scene(const tinygltf::Model& model, const std::string& file, Visit visit) {
  const std::vector<std::size_t> parents = parent_counts(model, file);
  check_acyclic(model, parents, file);
  const std::vector<int> roots = shown_roots(model, parents, file);
  struct Level {
    std::span<const int> nodes;  // siblings still to be visited
    AffineMap outer;
  };
  std::vector<Level> levels{{roots, {}}};
  // Shared children of shared children may multiply without bound.
  const std::size_t max_visits = (std::size_t{1} << 20) + 4 * model.nodes.size();
  for (std::size_t visits = 0; !levels.empty();) {
    Level& level = levels.back();
    if (level.nodes.empty()) {
      levels.pop_back();
      continue;
    }
    if (++visits > max_visits) throw LimitError(file + ": nodes with several parents make too many copies");
    const std::size_t number = to_size(level.nodes.front());
    const tinygltf::Node& node = model.nodes[number];
    level.nodes = level.nodes.subspan(1);
    if (!is_visible(node)) continue;
    const AffineMap placement = has_transform(node) ? composed(level.outer, transform_of(node, "")) : level.outer;
    visit(number, placement);
    if (!node.children.empty()) levels.push_back({node.children, placement});
  }
}

// A mesh and where it stands in the world.
struct Instance {
  std::size_t mesh = 0;
  AffineMap placement;
};

// Which of these nodes or meshes give a morph target weight. Told once for all, however often the scene shows them.
template <class Part>
std::vector<bool> have_weights(const std::vector<Part>& parts) {
  std::vector<bool> have;
  for (const Part& part : parts) {
    have.push_back(std::ranges::any_of(part.weights, [](double weight) { return weight != 0.0; }));
  }
  return have;
}

// All instances of the scene shown, those of one mesh together.
std::vector<Instance> instances_of(const tinygltf::Model& model, const std::string& file, GltfOmissions& omissions) {
  std::vector<Instance> instances;
  // "A glTF asset that does not contain any scenes should be treated as a library": without nodes, all of it is meant.
  if (model.nodes.empty() && model.scenes.empty()) {
    for (std::size_t mesh = 0; mesh < model.meshes.size(); ++mesh) instances.push_back({mesh, {}});
    omissions.without_nodes = instances.size();
    return instances;
  }
  const std::vector<bool> morphing_nodes = have_weights(model.nodes), morphing_meshes = have_weights(model.meshes);
  visit_scene(model, file, [&](std::size_t number, const AffineMap& placement) {
    const tinygltf::Node& node = model.nodes[number];
    if (node.mesh < 0) return;
    const bool skinned = node.skin >= 0;
    omissions.skinned += skinned;
    omissions.morphed += morphing_nodes[number] || morphing_meshes[to_size(node.mesh)];
    // The joints alone place a skinned mesh, never its node (section 3.7.3.3); at rest they leave it as it is.
    instances.push_back({to_size(node.mesh), skinned ? AffineMap{} : placement});
  });
  std::ranges::stable_sort(instances, {}, &Instance::mesh);
  return instances;
}

// --- The file --------------------------------------------------------------------------------------------------------

GlbChunks chunks_of(const NamedBytes& source) {
  return is_glb(source.bytes) ? split_glb(source) : GlbChunks{source.bytes, 0, std::nullopt, 0};
}

GltfDocument document_of(const NamedBytes& source, const GlbChunks& chunks) {
  if (is_utf16(chunks.json)) throw InputError(source.name + ": the text is UTF-16, expected UTF-8");
  const auto offset = is_glb(source.bytes) ? std::optional<std::size_t>(chunks.json_offset) : std::nullopt;
  return parse_gltf_document({source.name, chunks.json, offset, "a glTF document"});
}

}  // namespace

std::vector<std::string> files_of_gltf(const NamedBytes& source) {
  const std::vector<GltfBuffer> buffers = document_of(source, chunks_of(source)).buffers;
  std::vector<std::string> paths;
  std::set<std::string> known;
  for (std::size_t n = 0; n < buffers.size(); ++n) {
    try {
      if (!buffers[n].uri) continue;
      const std::optional<std::string> path = path_of_gltf_uri(source, n, *buffers[n].uri);
      if (path && known.insert(*path).second) paths.push_back(*path);
    } catch (const InputError&) {  // what may not be followed is not read, whatever is there
    }
  }
  return paths;
}

ParsedMesh read_gltf(const NamedBytes& source, std::vector<FileRead>* companions) {
  const GlbChunks chunks = chunks_of(source);
  GltfData data(source, document_of(source, chunks), chunks.binary, companions);
  GltfOmissions omissions;
  MeshAssembler assembler(source.name, data, omissions);

  ParsedMesh parsed;
  GroupCollector groups;
  const std::vector<Instance> instances = instances_of(data.model(), source.name, omissions);
  for (auto group = instances.begin(); group != instances.end();) {
    const auto end = std::find_if(group, instances.end(), [&](const Instance& i) { return i.mesh != group->mesh; });
    const TriangleMesh mesh = assembler.assemble(group->mesh);
    groups.start_group(data.model().meshes[group->mesh].name, parsed.mesh.triangles.size());
    data.spend(mesh.vertices.size() + mesh.triangles.size(), static_cast<std::uint64_t>(end - group));
    const std::string name = source.name + ": mesh " + std::to_string(group->mesh);
    for (; group != end; ++group) append_placed(mesh, group->placement, name, parsed.mesh);
  }
  parsed.groups = groups.finish(parsed.mesh.triangles.size());
  parsed.skipped_faces = omissions.incomplete_faces;
  parsed.warnings = warnings_of(omissions);
  if (chunks.surplus > 0) {
    parsed.warnings.push_back(
        {"trailing-data", "bytes after the announced length ignored: " + std::to_string(chunks.surplus)});
  }
  return parsed;
}

}  // namespace raycone
