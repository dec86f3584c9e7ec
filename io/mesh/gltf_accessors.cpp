// Numbers of a glTF asset. No size that the document announces is believed before it was compared with the bytes there.
#include "io/mesh/gltf_accessors.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "io/files/byte_order.h"
#include "io/files/file_error.h"
#include "io/mesh/gltf_resources.h"

namespace raycone {
namespace {

constexpr std::uint64_t kByte = 5120;
constexpr std::uint64_t kUnsignedByte = 5121;
constexpr std::uint64_t kShort = 5122;
constexpr std::uint64_t kUnsignedShort = 5123;
constexpr std::uint64_t kUnsignedInt = 5125;
constexpr std::uint64_t kFloat = 5126;

// Of a type that is_position_type() or is_index_type() accepts.
std::size_t component_size(std::uint64_t type) {
  switch (type) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    default:
      return 4;
  }
}

bool is_position_type(std::uint64_t type) {
  return type == kByte || type == kUnsignedByte || type == kShort || type == kUnsignedShort || type == kFloat;
}
bool is_index_type(std::uint64_t type) {
  return type == kUnsignedByte || type == kUnsignedShort || type == kUnsignedInt;
}

}  // namespace

void GltfBudget::spend(std::uint64_t count, std::uint64_t factor) {
  constexpr std::uint64_t kFree = std::uint64_t{1} << 24;
  constexpr std::uint64_t kPerByte = 16;
  const std::uint64_t limit = std::max(kFree, kPerByte * bytes_);
  if (count != 0 && factor > (limit - spent_) / count) {
    throw LimitError(file_ + ": shared and instanced data would grow to more than " + std::to_string(limit) +
                     " vertices and faces");
  }
  spent_ += count * factor;
}

GltfBuffers::GltfBuffers(const NamedBytes& source, const GltfDocument& document,
                         std::optional<std::string_view> binary_chunk, GltfBudget& budget,
                         std::vector<FileRead>* companions)
    : source_(source),
      document_(document),
      binary_chunk_(binary_chunk),
      budget_(budget),
      companions_(companions),
      loaded_(document.buffers.size()) {}

std::string_view GltfBuffers::view(std::size_t index) {
  const GltfBufferView& view = document_.views[index];
  auto& loaded = loaded_[view.buffer];
  if (!loaded) loaded = load(view.buffer);
  if (view.byte_offset > loaded->size() || view.byte_length > loaded->size() - view.byte_offset) {
    throw InputError(source_.name + ": bufferView " + std::to_string(index) + ": " + std::to_string(view.byte_length) +
                     " bytes at byte " + std::to_string(view.byte_offset) + ", but buffer " +
                     std::to_string(view.buffer) + " has only " + std::to_string(loaded->size()));
  }
  return loaded->substr(view.byte_offset, view.byte_length);
}

std::string_view GltfBuffers::load(std::size_t index) {
  const GltfBuffer& buffer = document_.buffers[index];
  std::string_view bytes;
  if (buffer.uri) {
    bytes = owned_.emplace_back(load_gltf_uri(source_, index, *buffer.uri, companions_));
  } else if (!buffer.fallback_of.empty()) {
    fail(index, "has no data but those of the extension " + buffer.fallback_of + ", which is not supported");
  } else if (index == 0 && binary_chunk_) {
    bytes = *binary_chunk_;
  } else {
    fail(index, "has no uri, expected one (only the first buffer of a GLB is its binary chunk)");
  }
  if (bytes.size() < buffer.byte_length) {
    fail(index, "has " + std::to_string(bytes.size()) + " bytes, expected " + std::to_string(buffer.byte_length));
  }
  budget_.add_bytes(bytes.size());
  return bytes.substr(0, buffer.byte_length);
}

void GltfBuffers::fail(std::size_t index, const std::string& what) const {
  throw InputError(source_.name + ": buffer " + std::to_string(index) + " " + what);
}

// Numbers in a buffer view, all of them within it.
struct GltfAccessors::Elements {
  const char* first = nullptr;
  std::size_t stride = 0;  // bytes from one element to the next
  std::uint64_t type = 0;
  bool normalized = false;

  [[nodiscard]] Vec3 point(std::size_t element) const {
    const char* bytes = first + element * stride;
    const std::size_t size = component_size(type);
    return {real(bytes), real(bytes + size), real(bytes + 2 * size)};
  }

  [[nodiscard]] std::uint32_t index(std::size_t element) const {
    const char* bytes = first + element * stride;
    switch (type) {
      case kUnsignedByte:
        return load_little_endian<std::uint8_t>(bytes);
      case kUnsignedShort:
        return load_little_endian<std::uint16_t>(bytes);
      default:
        return load_little_endian<std::uint32_t>(bytes);
    }
  }

 private:
  [[nodiscard]] double real(const char* bytes) const {
    switch (type) {
      case kByte:
        return real_of(load_little_endian<std::int8_t>(bytes));
      case kUnsignedByte:
        return real_of(load_little_endian<std::uint8_t>(bytes));
      case kShort:
        return real_of(load_little_endian<std::int16_t>(bytes));
      case kUnsignedShort:
        return real_of(load_little_endian<std::uint16_t>(bytes));
      default:
        return static_cast<double>(load_little_endian<float>(bytes));
    }
  }

  // A normalized integer stands for its ratio to the largest one, the lowest of a signed type for -1 as well (glTF 2.0,
  // section 3.11).
  template <class Integer>
  [[nodiscard]] double real_of(Integer value) const {
    if (!normalized) return static_cast<double>(value);
    return std::max(static_cast<double>(value) / std::numeric_limits<Integer>::max(), -1.0);
  }
};

std::vector<Vec3> GltfAccessors::positions(std::size_t accessor) {
  const GltfAccessor& description = document_.accessors[accessor];
  if (description.type != "VEC3" || !is_position_type(description.component_type)) {
    fail(accessor, "holds no positions, expected VEC3 of floats, bytes or shorts");
  }
  return read<Vec3>(accessor, 3, &Elements::point);
}

std::vector<std::uint32_t> GltfAccessors::indices(std::size_t accessor) {
  const GltfAccessor& description = document_.accessors[accessor];
  if (description.type != "SCALAR" || !is_index_type(description.component_type)) {
    fail(accessor, "holds no indices, expected SCALAR of unsigned integers");
  }
  return read<std::uint32_t>(accessor, 1, &Elements::index);
}

template <class Element>
std::vector<Element> GltfAccessors::read(std::size_t index, std::size_t components,
                                         Element (Elements::*get)(std::size_t) const) {
  const GltfAccessor& accessor = document_.accessors[index];
  Elements dense;
  if (accessor.view) {
    dense = elements(index, *accessor.view, accessor.byte_offset, accessor.component_type, components, accessor.count);
  }
  budget_.spend(accessor.count);
  std::vector<Element> result(accessor.count);
  if (accessor.view) {
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = (dense.*get)(i);
  }
  if (accessor.sparse) replace_sparse(index, components, get, result);
  return result;
}

template <class Element>
void GltfAccessors::replace_sparse(std::size_t index, std::size_t components,
                                   Element (Elements::*get)(std::size_t) const, std::vector<Element>& result) {
  const GltfAccessor& accessor = document_.accessors[index];
  const GltfSparse& sparse = *accessor.sparse;
  if (!is_index_type(sparse.indices_type)) fail(index, "has sparse indices that are not unsigned integers");
  const Elements targets =
      elements(index, sparse.indices_view, sparse.indices_offset, sparse.indices_type, 1, sparse.count);
  const Elements values =
      elements(index, sparse.values_view, sparse.values_offset, accessor.component_type, components, sparse.count);
  budget_.spend(sparse.count);
  for (std::size_t i = 0; i < sparse.count; ++i) {
    const std::uint32_t target = targets.index(i);
    if (target >= result.size()) {
      fail(index,
           "has sparse index " + std::to_string(target) + ", but only " + std::to_string(result.size()) + " elements");
    }
    result[target] = (values.*get)(i);
  }
}

GltfAccessors::Elements GltfAccessors::elements(std::size_t accessor, std::size_t view, std::uint64_t offset,
                                                std::uint64_t type, std::size_t components, std::uint64_t count) {
  const std::string_view bytes = buffers_.view(view);
  const std::size_t size = components * component_size(type);
  const std::uint64_t declared = document_.views[view].byte_stride;
  const std::uint64_t stride = declared == 0 ? size : declared;
  if (stride < size) {
    fail(accessor, "has elements of " + std::to_string(size) + " bytes, more than the byteStride " +
                       std::to_string(stride) + " of bufferView " + std::to_string(view));
  }
  const std::uint64_t available = offset < bytes.size() ? bytes.size() - offset : 0;
  const bool fits = count == 0 || (available >= size && count - 1 <= (available - size) / stride);
  if (!fits) {
    fail(accessor, "has " + std::to_string(count) + " elements of " + std::to_string(size) + " bytes at byte " +
                       std::to_string(offset) + ", more than the " + std::to_string(bytes.size()) +
                       " bytes of bufferView " + std::to_string(view) + " hold");
  }
  const char* first = count == 0 ? nullptr : bytes.data() + offset;
  return {first, static_cast<std::size_t>(stride), type, document_.accessors[accessor].normalized};
}

void GltfAccessors::fail(std::size_t accessor, const std::string& what) const {
  throw InputError(file_ + ": accessor " + std::to_string(accessor) + " " + what);
}

std::uint32_t restart_value(const GltfAccessor& indices) {
  const std::size_t bits = 8 * component_size(indices.component_type);
  return std::numeric_limits<std::uint32_t>::max() >> (32 - bits);
}

}  // namespace raycone
