// The JSON of a glTF asset: what concerns geometry is checked by a table, all else is left out. Names are those of its
// schema (Khronos Group, "glTF 2.0 Specification", 2021).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/mesh/bounded_json.h"

namespace raycone {

struct GltfBuffer {
  std::optional<std::string> uri;  // absent: the binary chunk of a GLB
  std::uint64_t byte_length = 0;
  std::string fallback_of;  // the compression extension that this buffer is the uncompressed fallback of, or empty
};

struct GltfSparse {
  std::uint64_t count = 0;
  std::uint64_t indices_offset = 0;
  std::uint64_t values_offset = 0;
};

// Every reference from one array into another is in range.
struct GltfDocument {
  std::vector<GltfBuffer> buffers;
  std::vector<std::uint64_t> strides;  // of the buffer views; 0: elements follow each other without gaps
  std::vector<GltfSparse> sparse;      // of the accessors
  // All else, for tinygltf. The indices of a primitive stand beside its attributes, because tinygltf refuses some.
  std::string json;
};

inline constexpr const char* kGltfIndices = "indices";  // the attribute
inline constexpr const char* kGltfDraco = "KHR_draco_mesh_compression";
inline constexpr const char* kGltfInstancing = "EXT_mesh_gpu_instancing";
inline constexpr const char* kGltfVisibility = "KHR_node_visibility";

// Throws InputError, LimitError.
[[nodiscard]] GltfDocument parse_gltf_document(const JsonText& text);

}  // namespace raycone
