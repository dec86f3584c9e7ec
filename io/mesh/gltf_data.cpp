// Numbers of a glTF asset. No size that the document announces is believed before it was compared with the bytes there.
// tinygltf makes the model of the document; buffers are not its job, because it loads all of them before it is known
// which are needed, takes no longer ones than announced, and does not notice damaged base64.
#include "io/mesh/gltf_data.h"

#include <algorithm>
#include <array>
#include <fstream>  // which tiny_gltf.h takes, but does not include
#include <limits>
#include <utility>

#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>

#include "io/files/ascii.h"
#include "io/files/byte_order.h"
#include "io/files/counted.h"
#include "io/files/file_error.h"
#include "io/mesh/gltf_resources.h"
#include "io/mesh/unwinding_reserve.h"

namespace raycone {
namespace {

std::shared_ptr<const tinygltf::Model> load_model(const std::string& json, const std::string& file) {
  if (json.size() > std::numeric_limits<unsigned>::max()) throw LimitError(file + ": JSON of more than 4 GiB");
  UnwindingReserve reserve;  // tinygltf parses with nlohmann-json
  const auto comes_before_value = [](char c) { return c == ',' || c == '[' || c == '{'; };
  reserve.cover(1 + static_cast<std::size_t>(std::ranges::count_if(json, comes_before_value)));
  auto model = std::make_shared<tinygltf::Model>();
  std::string error, warning;
  const auto size = static_cast<unsigned>(json.size());
  if (!tinygltf::TinyGLTF().LoadASCIIFromString(model.get(), &error, &warning, json.c_str(), size, "")) {
    throw InputError(file + ": " + excerpt(error) + ", expected a glTF document");
  }
  return model;
}

// Extensions that change what triangles look like or tell about them, never where they are.
bool leaves_geometry_alone(const std::string& extension) {
  static constexpr std::array kKinds{"_materials_",  "_texture_",      "_lights_",    "_camera",
                                     "_image_",      "_packing_",      "_animation_", "_xmp",
                                     "_techniques_", "_ngon_encoding", "_metadata",   "_features"};
  return std::any_of(kKinds.begin(), kKinds.end(),
                     [&](const char* kind) { return extension.find(kind) != std::string::npos; });
}

void check_extensions(const tinygltf::Model& model, const std::string& file) {
  const auto& used = model.extensionsUsed;
  const bool instancing = std::any_of(model.nodes.begin(), model.nodes.end(), [](const tinygltf::Node& node) {
    return node.extensions.contains(kGltfInstancing);
  });
  // It has no fallback: without it all instances but one would be missing.
  if (instancing || std::find(used.begin(), used.end(), kGltfInstancing) != used.end()) {
    throw InputError(file + ": uses the extension " + kGltfInstancing + ", which is not supported");
  }
  for (const std::string& extension : model.extensionsRequired) {
    const bool is_read =
        extension == "KHR_mesh_quantization" || extension == kGltfVisibility || extension == kGltfDraco;
    if (!is_read && !leaves_geometry_alone(extension)) {
      throw InputError(file + ": requires the extension " + excerpt(extension) + ", which is not supported");
    }
  }
}

bool is_index_type(int type) {
  return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}
bool is_position_type(int type) {
  return type == TINYGLTF_COMPONENT_TYPE_FLOAT ||
         (type >= TINYGLTF_COMPONENT_TYPE_BYTE && type <= TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT);
}

// Of a type that one of these two accepts.
std::size_t size_of(int type) { return to_size(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(type))); }

double number_at(const char* bytes, int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return load_little_endian<std::int8_t>(bytes);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load_little_endian<std::uint8_t>(bytes);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return load_little_endian<std::int16_t>(bytes);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load_little_endian<std::uint16_t>(bytes);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return load_little_endian<std::uint32_t>(bytes);
    default:
      return static_cast<double>(load_little_endian<float>(bytes));
  }
}

// The real that a number stands for: normalized integers are divided by the largest one, and the lowest of a signed
// type is -1 as well (glTF 2.0, section 3.11).
double real_of(double number, int type, bool normalized) {
  if (!normalized || type == TINYGLTF_COMPONENT_TYPE_FLOAT) return number;
  const bool is_signed = type == TINYGLTF_COMPONENT_TYPE_BYTE || type == TINYGLTF_COMPONENT_TYPE_SHORT;
  const double largest = (1U << (8 * size_of(type) - is_signed)) - 1;
  return std::max(number / largest, -1.0);
}

}  // namespace

std::uint32_t restart_value(const tinygltf::Accessor& indices) {
  return std::numeric_limits<std::uint32_t>::max() >> (32 - 8 * size_of(indices.componentType));
}

GltfData::GltfData(const NamedBytes& source, GltfDocument document, std::optional<std::string_view> binary_chunk,
                   std::vector<FileRead>* companions)
    : source_(source),
      model_(load_model(document.json, source.name)),
      buffers_(std::move(document.buffers)),
      strides_(std::move(document.strides)),
      sparse_(std::move(document.sparse)),
      requires_draco_(std::ranges::count(model_->extensionsRequired, kGltfDraco) > 0),
      binary_chunk_(binary_chunk),
      companions_(companions),
      loaded_(buffers_.size()) {
  check_extensions(*model_, source.name);
}

void GltfData::spend(std::uint64_t count, std::uint64_t factor) {
  constexpr std::uint64_t kFree = std::uint64_t{1} << 24;
  constexpr std::uint64_t kPerByte = 16;
  const std::uint64_t limit = std::max(kFree, kPerByte * bytes_);
  if (count != 0 && factor > (limit - spent_) / count) {
    throw LimitError(source_.name + ": shared and instanced data would grow to more than " + std::to_string(limit) +
                     " vertices and faces");
  }
  spent_ += count * factor;
}

// Many primitives may name the same bytes, which may take long to decode though they hold few faces.
void GltfData::spend_draco(std::uint64_t bytes) {
  constexpr std::uint64_t kFree = std::uint64_t{1} << 24;
  constexpr std::uint64_t kTimes = 8;
  draco_bytes_ += bytes;
  if (draco_bytes_ > std::max(kFree, kTimes * bytes_)) {
    throw LimitError(source_.name + ": primitives share Draco data, which would be decoded more than 8 times");
  }
}

std::string_view GltfData::load(std::size_t index) {
  const GltfBuffer& buffer = buffers_[index];
  std::string_view bytes;
  if (buffer.uri) {
    bytes = load_uri(index, *buffer.uri);
  } else if (!buffer.fallback_of.empty()) {
    fail("buffer", index, "has no data but those of the extension " + buffer.fallback_of + ", which is not supported");
  } else if (index == 0 && binary_chunk_) {
    bytes = *binary_chunk_;
    bytes_ += bytes.size();
  } else {
    fail("buffer", index, "has no uri, expected one (only the first buffer of a GLB is its binary chunk)");
  }
  if (bytes.size() < buffer.byte_length) {
    fail("buffer", index, "has " + counted(bytes.size(), "byte") + ", expected " + std::to_string(buffer.byte_length));
  }
  return bytes.substr(0, buffer.byte_length);
}

std::string_view GltfData::load_uri(std::size_t buffer, const std::string& uri) {
  const std::optional<std::string> path = path_of_gltf_uri(source_, buffer, uri);
  const auto known = path ? files_.find(*path) : files_.end();
  if (known != files_.end()) return known->second;
  const std::string_view bytes = owned_.emplace_back(load_gltf_uri(source_, buffer, uri, companions_));
  if (path) files_.emplace(*path, bytes);
  bytes_ += bytes.size();
  return bytes;
}

std::string_view GltfData::view(std::size_t index) {
  const tinygltf::BufferView& view = model_->bufferViews[index];
  const auto buffer = static_cast<std::size_t>(view.buffer);
  auto& loaded = loaded_[buffer];
  if (!loaded) loaded = load(buffer);
  if (view.byteOffset > loaded->size() || view.byteLength > loaded->size() - view.byteOffset) {
    throw InputError(source_.name + ": bufferView " + std::to_string(index) + ": " + counted(view.byteLength, "byte") +
                     " at byte " + std::to_string(view.byteOffset) + ", but buffer " + std::to_string(buffer) +
                     " has only " + std::to_string(loaded->size()));
  }
  return loaded->substr(view.byteOffset, view.byteLength);
}

void GltfData::fail(const char* part, std::size_t index, const std::string& what) const {
  throw InputError(source_.name + ": " + part + " " + std::to_string(index) + " " + what);
}

// Numbers in a buffer view, all of them within it.
struct GltfData::Elements {
  const char* first = nullptr;
  std::size_t stride = 0;  // bytes from one element to the next
  std::size_t size = 0;    // bytes of a component
  int type = 0;
  bool normalized = false;

  [[nodiscard]] Vec3 point(std::size_t element) const {
    const auto real = [&](std::size_t i) {
      return real_of(number_at(first + element * stride + i * size, type), type, normalized);
    };
    return {real(0), real(1), real(2)};
  }
  [[nodiscard]] std::uint32_t index(std::size_t element) const {
    return static_cast<std::uint32_t>(number_at(first + element * stride, type));
  }
};

void GltfData::check_positions(std::size_t index) const {
  const tinygltf::Accessor& accessor = model_->accessors[index];
  if (accessor.type != TINYGLTF_TYPE_VEC3 || !is_position_type(accessor.componentType)) {
    fail("accessor", index, "holds no positions, expected VEC3 of floats, bytes or shorts");
  }
}

void GltfData::check_indices(std::size_t index) const {
  const tinygltf::Accessor& accessor = model_->accessors[index];
  if (accessor.type != TINYGLTF_TYPE_SCALAR || !is_index_type(accessor.componentType)) {
    fail("accessor", index, "holds no indices, expected SCALAR of unsigned integers");
  }
}

std::vector<Vec3> GltfData::positions(std::size_t accessor) {
  check_positions(accessor);
  return read<Vec3>(accessor, 3, &Elements::point);
}

std::vector<std::uint32_t> GltfData::indices(std::size_t accessor) {
  check_indices(accessor);
  return read<std::uint32_t>(accessor, 1, &Elements::index);
}

template <class Element>
std::vector<Element> GltfData::read(std::size_t index, std::size_t components,
                                    Element (Elements::*get)(std::size_t) const) {
  const tinygltf::Accessor& accessor = model_->accessors[index];
  Elements dense;
  if (accessor.bufferView >= 0) {
    dense =
        elements(index, accessor.bufferView, accessor.byteOffset, accessor.componentType, components, accessor.count);
  }
  spend(accessor.count);
  std::vector<Element> result(accessor.count);
  if (dense.first) {
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = (dense.*get)(i);
  }
  if (!accessor.sparse.isSparse) return result;
  const auto& [count, indices_offset, values_offset] = sparse_[index];
  const auto& indices = accessor.sparse.indices;
  if (!is_index_type(indices.componentType)) {
    fail("accessor", index, "has sparse indices that are not unsigned integers");
  }
  const Elements targets = elements(index, indices.bufferView, indices_offset, indices.componentType, 1, count);
  const Elements values =
      elements(index, accessor.sparse.values.bufferView, values_offset, accessor.componentType, components, count);
  spend(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t target = targets.index(i);
    if (i > 0 && target <= targets.index(i - 1)) {
      fail("accessor", index,
           "has sparse index " + std::to_string(target) + " behind " + std::to_string(targets.index(i - 1)) +
               ", expected ascending ones");
    }
    if (target >= result.size()) {
      fail("accessor", index,
           "has sparse index " + std::to_string(target) + ", but only " + counted(result.size(), "element"));
    }
    result[target] = (values.*get)(i);
  }
  return result;
}

GltfData::Elements GltfData::elements(std::size_t accessor, int view_index, std::uint64_t offset, int type,
                                      std::size_t components, std::uint64_t count) {
  const std::string_view bytes = view(to_size(view_index));
  const std::size_t size = components * size_of(type);
  const std::uint64_t declared = strides_[to_size(view_index)];
  const std::uint64_t stride = declared == 0 ? size : declared;
  if (stride < size) {
    fail("accessor", accessor,
         "has elements of " + counted(size, "byte") + ", more than the byteStride " + std::to_string(stride) +
             " of bufferView " + std::to_string(view_index));
  }
  const std::uint64_t available = offset < bytes.size() ? bytes.size() - offset : 0;
  const bool fits = count == 0 || (available >= size && count - 1 <= (available - size) / stride);
  if (!fits) {
    fail("accessor", accessor,
         "has " + counted(count, "element") + " of " + counted(size, "byte") + " at byte " + std::to_string(offset) +
             ", more than the " + counted(bytes.size(), "byte") + " of bufferView " + std::to_string(view_index) +
             " hold");
  }
  return {count == 0 ? nullptr : bytes.data() + offset, static_cast<std::size_t>(stride), size_of(type), type,
          model_->accessors[accessor].normalized};
}

// Not where the accessors, too, hold the geometry, as they do where the extension is not required: those are exact.
bool GltfData::is_compressed(const tinygltf::Primitive& primitive, const std::string& place) const {
  const auto extension = primitive.extensions.find(kGltfDraco);
  if (extension == primitive.extensions.end()) return false;
  const bool has_data = std::all_of(primitive.attributes.begin(), primitive.attributes.end(), [&](const auto& item) {
    return model_->accessors[to_size(item.second)].bufferView >= 0;
  });
  if (!requires_draco_ && has_data) return false;
  const tinygltf::Value& draco = extension->second;
  if (!draco.Has("bufferView") || !draco.Get("attributes").Has("POSITION")) {
    throw InputError(place + "has no data but those of the extension " + kGltfDraco +
                     ", which lacks a bufferView or the attribute POSITION");
  }
  if (primitive.mode == TINYGLTF_MODE_TRIANGLES) return true;
  throw InputError(place + "mode " + std::to_string(primitive.mode) + " with " + kGltfDraco + ", expected 4");
}

std::optional<DracoMesh> GltfData::decompressed(const tinygltf::Primitive& primitive, const std::string& place) {
  if (!is_compressed(primitive, place)) return std::nullopt;
  const std::size_t positions = to_size(primitive.attributes.at("POSITION"));
  check_positions(positions);
  const tinygltf::Accessor& accessor = model_->accessors[positions];
  const tinygltf::Value& draco = primitive.extensions.at(kGltfDraco);
  const std::string_view bytes = view(to_size(draco.Get("bufferView").GetNumberAsInt()));
  const int attribute = draco.Get("attributes").Get("POSITION").GetNumberAsInt();
  spend_draco(bytes.size());
  DracoMesh mesh = decode_draco(bytes, attribute, accessor.componentType, place);
  const auto indices = primitive.attributes.find(kGltfIndices);
  if (indices != primitive.attributes.end()) check_indices(to_size(indices->second));
  // What accessors count is not compared: exporters, and samples of Khronos, have left there what was before
  // compression.
  spend(mesh.vertices.size());
  for (Vec3& v : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) v[axis] = real_of(v[axis], accessor.componentType, accessor.normalized);
  }
  return mesh;
}

}  // namespace raycone
