// The part of a glTF document that concerns geometry, as plain data. Specification: Khronos Group, "glTF 2.0
// Specification" (2021); names are those of its JSON schema.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace raycone {

struct GltfBuffer {
  std::optional<std::string> uri;  // absent: the binary chunk of a GLB
  std::uint64_t byte_length = 0;
  std::string fallback_of;  // the compression extension that this buffer is the uncompressed fallback of, or empty
};

struct GltfBufferView {
  std::size_t buffer = 0;
  std::uint64_t byte_offset = 0;
  std::uint64_t byte_length = 0;
  std::uint64_t byte_stride = 0;  // 0: elements follow each other without gaps
};

struct GltfSparse {
  std::uint64_t count = 0;
  std::size_t indices_view = 0;
  std::uint64_t indices_offset = 0;
  std::uint64_t indices_type = 0;
  std::size_t values_view = 0;
  std::uint64_t values_offset = 0;
};

struct GltfAccessor {
  std::optional<std::size_t> view;  // absent: all zeros but for the sparse elements
  std::uint64_t byte_offset = 0;
  std::uint64_t component_type = 0;  // 5120 ... 5126, not checked here
  bool normalized = false;
  std::uint64_t count = 0;
  std::string type;  // "SCALAR", "VEC3", ..., not checked here
  std::optional<GltfSparse> sparse;
};

struct GltfPrimitive {
  std::optional<std::size_t> positions;  // accessor
  std::optional<std::size_t> indices;    // accessor
  std::uint64_t mode = 4;                // 4 triangles, 5 strip, 6 fan, less: points and lines
  bool draco = false;                    // has KHR_draco_mesh_compression
};

struct GltfMesh {
  std::vector<GltfPrimitive> primitives;
  bool morphed = false;  // some default morph weight is not zero
};

// The upper three rows of an affine 4 x 4 matrix that acts on column vectors.
struct GltfTransform {
  std::array<std::array<double, 4>, 3> rows{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
  bool mirrored = false;  // negative determinant
};

struct GltfNode {
  std::optional<std::size_t> transform;  // to its parent; absent: the identity
  std::vector<std::size_t> children;
  std::optional<std::size_t> mesh;
  bool skinned = false;
  bool morphed = false;  // some morph weight of its own is not zero
  bool visible = true;   // KHR_node_visibility: false hides its children, too
};

// Every reference from one of these arrays into another is in range.
struct GltfDocument {
  std::vector<std::string> extensions_used;
  std::vector<std::string> extensions_required;
  std::vector<GltfBuffer> buffers;
  std::vector<GltfBufferView> views;
  std::vector<GltfAccessor> accessors;
  std::vector<GltfMesh> meshes;
  std::vector<GltfTransform> transforms;
  std::vector<GltfNode> nodes;
  std::vector<std::vector<std::size_t>> scenes;  // root nodes
  std::optional<std::size_t> scene;
  bool gpu_instancing = false;  // some node has EXT_mesh_gpu_instancing
};

// Where the text of a document stands, for messages.
struct GltfText {
  const std::string& file;  // as given on the command line
  std::string_view json;
  std::optional<std::size_t> glb_offset;  // of the text in a GLB; absent: the text is the file
};

// Throws InputError.
[[nodiscard]] GltfDocument parse_gltf_document(const GltfText& text);

}  // namespace raycone
