// Bytes of a glTF asset. A URI's path is followed only into the asset's own directory: a mesh from a stranger must not
// name other files of the user, for the tool to read and a batch to list in its reports. Symbolic links there are
// followed wherever they lead (docs/formats.md).
#include "io/mesh/gltf_resources.h"

#include <filesystem>

#include "io/files/ascii.h"
#include "io/files/base64.h"
#include "io/files/byte_order.h"
#include "io/files/counted.h"
#include "io/files/file_error.h"
#include "io/files/percent_encoding.h"
#include "io/files/read_file.h"
#include "io/mesh/mesh_error.h"

namespace raycone {
namespace {

constexpr std::size_t kGlbHeaderSize = 12;   // magic, version, length
constexpr std::size_t kChunkHeaderSize = 8;  // length, type
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
constexpr std::uint32_t kBinaryChunk = 0x004E4942;

// One chunk of a GLB; `offset` moves behind it.
struct Chunk {
  std::uint32_t type = 0;
  std::size_t data_offset = 0;
  std::string_view data;
};

Chunk next_chunk(const NamedBytes& source, std::string_view glb, std::size_t& offset) {
  if (glb.size() - offset < kChunkHeaderSize) fail_at_byte(source.name, offset, "GLB ends within a chunk header");
  const std::uint32_t length = load_little_endian<std::uint32_t>(glb.data() + offset);
  const std::uint32_t type = load_little_endian<std::uint32_t>(glb.data() + offset + 4);
  const std::size_t data = offset + kChunkHeaderSize;
  if (length > glb.size() - data) {
    fail_at_byte(source.name, offset,
                 "chunk of " + counted(length, "byte") + ", but only " + std::to_string(glb.size() - data) + " remain");
  }
  offset = data + length;
  return {type, data, glb.substr(data, length)};
}

// Both words of a data URI are case-insensitive (RFC 3986, section 3.1; RFC 2397, whose literals are).
bool is_data_uri(std::string_view uri) { return is_word(uri.substr(0, 5), "data:"); }

// Browsers pass over blanks before the word.
bool announces_base64(std::string_view head) {
  constexpr std::string_view kWord = "base64";
  if (!ends_with_word(head, kWord)) return false;
  head.remove_suffix(kWord.size());
  while (head.ends_with(' ')) head.remove_suffix(1);
  return head.ends_with(';');
}

bool has_scheme(std::string_view uri) {
  const std::size_t colon = uri.find(':');
  return colon != std::string_view::npos && colon > 0 && uri.find('/') > colon;
}

// Whether the path climbs out of the directory at which it starts.
bool leaves_directory(const std::filesystem::path& path) {
  const std::filesystem::path normal = path.lexically_normal();
  return !normal.empty() && *normal.begin() == "..";
}

[[noreturn]] void refuse(const NamedBytes& source, std::size_t buffer, std::string_view uri, const std::string& why) {
  throw InputError(source.name + ": buffer " + std::to_string(buffer) + ": \"" + excerpt(uri) + "\" " + why);
}

std::string decode_data_uri(const NamedBytes& source, std::size_t buffer, std::string_view uri) {
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos) refuse(source, buffer, uri, "has no comma, expected a data URI");
  const std::string_view data = uri.substr(comma + 1);
  if (!announces_base64(uri.substr(0, comma))) return percent_decoded(data);
  auto decoded = data.find('%') == std::string_view::npos ? from_base64(data) : from_base64(percent_decoded(data));
  if (!decoded) refuse(source, buffer, uri.substr(0, comma), "is not followed by valid base64");
  return *std::move(decoded);
}

std::string path_beside(const NamedBytes& source, std::size_t buffer, std::string_view uri) {
  const std::filesystem::path relative = percent_decoded(uri);
  if (relative.native().find('\0') != std::string::npos) refuse(source, buffer, uri, "is not a file name");
  if (has_scheme(uri) || relative.is_absolute() || leaves_directory(relative)) {
    refuse(source, buffer, uri, "is outside the file's directory, expected a relative path within it");
  }
  if (source.directory.empty()) refuse(source, buffer, uri, "is another file, which standard input cannot refer to");
  const std::string path = (std::filesystem::path(source.directory) / relative).lexically_normal().string();
  return path == "-" ? "./-" : path;  // a file, not standard input
}

std::string read_beside(const NamedBytes& source, std::size_t buffer, std::string_view uri,
                        std::vector<FileRead>* companions) {
  const std::string path = path_beside(source, buffer, uri);
  // A device or FIFO of a hostile archive would never end.
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    refuse(source, buffer, uri, "is missing, expected a file beside this one");
  }
  std::string bytes = read_file(path);
  if (companions) companions->push_back({path, sha256(bytes)});
  return bytes;
}

}  // namespace

bool is_glb(std::string_view bytes) { return bytes.starts_with("glTF"); }

GlbChunks split_glb(const NamedBytes& source) {
  const std::string_view bytes = source.bytes;
  if (bytes.size() < kGlbHeaderSize) fail_at_byte(source.name, bytes.size(), "GLB ends within its header");
  const std::uint32_t version = load_little_endian<std::uint32_t>(bytes.data() + 4);
  if (version != 2) fail_at_byte(source.name, 4, "GLB version " + std::to_string(version) + ", expected 2");
  const std::uint32_t length = load_little_endian<std::uint32_t>(bytes.data() + 8);
  if (length > bytes.size() || length < kGlbHeaderSize) {
    fail_at_byte(source.name, 8,
                 "GLB announces " + counted(length, "byte") + ", but has " + std::to_string(bytes.size()));
  }
  const std::string_view glb = bytes.substr(0, length);
  std::size_t offset = kGlbHeaderSize;
  const Chunk json = next_chunk(source, glb, offset);
  if (json.type != kJsonChunk) fail_at_byte(source.name, kGlbHeaderSize + 4, "first chunk of the GLB is not JSON");
  GlbChunks chunks{json.data, json.data_offset, std::nullopt, bytes.size() - length};
  // Chunks of unknown types are to be ignored.
  while (offset < glb.size() && !chunks.binary) {
    const Chunk chunk = next_chunk(source, glb, offset);
    if (chunk.type == kBinaryChunk) chunks.binary = chunk.data;
  }
  return chunks;
}

std::string load_gltf_uri(const NamedBytes& source, std::size_t buffer, std::string_view uri,
                          std::vector<FileRead>* companions) {
  if (is_data_uri(uri)) return decode_data_uri(source, buffer, uri);
  return read_beside(source, buffer, uri, companions);
}

std::optional<std::string> path_of_gltf_uri(const NamedBytes& source, std::size_t buffer, std::string_view uri) {
  if (is_data_uri(uri)) return std::nullopt;
  return path_beside(source, buffer, uri);
}

}  // namespace raycone
