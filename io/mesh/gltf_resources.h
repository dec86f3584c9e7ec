// Where the bytes of a glTF asset come from: the chunks of a GLB, data URIs and files beside the asset.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/mesh/read_mesh.h"

namespace raycone {

struct GlbChunks {
  std::string_view json;
  std::size_t json_offset = 0;             // of `json` in the file
  std::optional<std::string_view> binary;  // the BIN chunk
  std::size_t surplus = 0;                 // bytes after the length that the GLB announces
};

// Whether the bytes begin like a GLB.
[[nodiscard]] bool is_glb(std::string_view bytes);

// The chunks of a GLB. Throws InputError where it is cut short or is not version 2.
[[nodiscard]] GlbChunks split_glb(const NamedBytes& source);

// The bytes that buffer number `buffer` of the asset refers to by `uri`: decoded, if a data URI, else of a regular file
// in or below source.directory, whose path is appended to *companions. Throws InputError.
[[nodiscard]] std::string load_gltf_uri(const NamedBytes& source, std::size_t buffer, std::string_view uri,
                                        std::vector<FileRead>* companions);

// The path of the file, there or not, that `uri` of buffer number `buffer` refers to; nothing where it is a data URI.
// Throws InputError where it may not be followed.
[[nodiscard]] std::optional<std::string> path_of_gltf_uri(const NamedBytes& source, std::size_t buffer,
                                                          std::string_view uri);

}  // namespace raycone
