// The numbers of a glTF asset: its document as tinygltf's model, its buffers, loaded when needed, and its accessors,
// checked before they are read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/data/vec3.h"
#include "io/mesh/gltf_document.h"
#include "io/mesh/gltf_draco.h"
#include "io/mesh/read_mesh.h"

namespace tinygltf {
class Model;
struct Accessor;
struct Primitive;
}  // namespace tinygltf

namespace raycone {

// An index or a count of tinygltf's: GltfDocument has checked that none is negative.
[[nodiscard]] inline std::size_t to_size(int number) { return static_cast<std::size_t>(number); }

class GltfData {
 public:
  // What is passed by reference or pointer must outlive this. Throws InputError, LimitError.
  GltfData(const NamedBytes& source, GltfDocument document, std::optional<std::string_view> binary_chunk,
           std::vector<FileRead>* companions);

  [[nodiscard]] const tinygltf::Model& model() const { return *model_; }

  // Those of an accessor; quantized positions are returned as the reals that they stand for. Throw InputError.
  [[nodiscard]] std::vector<Vec3> positions(std::size_t accessor);
  [[nodiscard]] std::vector<std::uint32_t> indices(std::size_t accessor);
  // What KHR_draco_mesh_compression holds of a primitive that has it, else nothing; quantized positions as above.
  // Throws InputError "PLACE...", LimitError.
  [[nodiscard]] std::optional<DracoMesh> decompressed(const tinygltf::Primitive& primitive, const std::string& place);

  // Announces the making of `count` times `factor` vertices, corners or triangles: bounds the work and memory that a
  // small file may ask for by naming the same data many times. Throws LimitError.
  void spend(std::uint64_t count, std::uint64_t factor = 1);

 private:
  struct Elements;

  // All bytes of a buffer view, whose buffer is loaded when first asked for: broken ones that no triangle needs do no
  // harm.
  [[nodiscard]] std::string_view view(std::size_t index);
  [[nodiscard]] std::string_view load(std::size_t buffer);
  // What a buffer's URI stands for. Of buffers that name one file, only the first reads it and adds to bytes_.
  [[nodiscard]] std::string_view load_uri(std::size_t buffer, const std::string& uri);
  void spend_draco(std::uint64_t bytes);
  void check_positions(std::size_t accessor) const;
  void check_indices(std::size_t accessor) const;
  [[nodiscard]] bool is_compressed(const tinygltf::Primitive& primitive, const std::string& place) const;
  template <class Element>
  std::vector<Element> read(std::size_t accessor, std::size_t components, Element (Elements::*get)(std::size_t) const);
  // `count` elements from byte `offset` of view number `view` on.
  Elements elements(std::size_t accessor, int view, std::uint64_t offset, int type, std::size_t components,
                    std::uint64_t count);
  [[noreturn]] void fail(const char* part, std::size_t index, const std::string& what) const;

  const NamedBytes& source_;
  std::shared_ptr<const tinygltf::Model> model_;
  std::vector<GltfBuffer> buffers_;
  std::vector<std::uint64_t> strides_;  // of the buffer views
  std::vector<GltfSparse> sparse_;      // of the accessors
  bool requires_draco_;                 // by extensionsRequired, which may be long
  std::optional<std::string_view> binary_chunk_;
  std::vector<FileRead>* companions_;
  std::vector<std::optional<std::string_view>> loaded_;  // buffers
  std::deque<std::string> owned_;                        // keeps its elements where they are
  std::map<std::string, std::string_view> files_;        // those loaded, by their paths
  std::uint64_t bytes_ = 0;                              // of the buffers loaded
  std::uint64_t spent_ = 0;
  std::uint64_t draco_bytes_ = 0;  // decoded so far, those of several primitives each time
};

// The largest number of the accessor's index type, which asks graphics hardware to restart the primitive.
[[nodiscard]] std::uint32_t restart_value(const tinygltf::Accessor& indices);

}  // namespace raycone
