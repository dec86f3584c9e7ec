// The numbers of a glTF asset: its buffers, loaded when needed, and its accessors, checked before they are read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/data/vec3.h"
#include "io/mesh/gltf_document.h"
#include "io/mesh/read_mesh.h"

namespace raycone {

// Bounds the work and memory that a small file may ask for by naming the same data many times.
class GltfBudget {
 public:
  explicit GltfBudget(std::string file) : file_(std::move(file)) {}

  // Data that were really there allow for more.
  void add_bytes(std::uint64_t bytes) { bytes_ += bytes; }
  // Announces the making of `count` times `factor` vertices, corners or triangles. Throws LimitError.
  void spend(std::uint64_t count, std::uint64_t factor = 1);

 private:
  std::string file_;
  std::uint64_t bytes_ = 0;
  std::uint64_t spent_ = 0;
};

// The buffers of an asset, each loaded when first asked for: broken ones that no triangle needs do no harm.
class GltfBuffers {
 public:
  // What is passed by reference or pointer must outlive this.
  GltfBuffers(const NamedBytes& source, const GltfDocument& document, std::optional<std::string_view> binary_chunk,
              GltfBudget& budget, std::vector<FileRead>* companions);

  // All bytes of a buffer view. Throws InputError.
  std::string_view view(std::size_t index);

 private:
  std::string_view load(std::size_t index);
  [[noreturn]] void fail(std::size_t index, const std::string& what) const;

  const NamedBytes& source_;
  const GltfDocument& document_;
  std::optional<std::string_view> binary_chunk_;
  GltfBudget& budget_;
  std::vector<FileRead>* companions_;
  std::vector<std::optional<std::string_view>> loaded_;
  std::deque<std::string> owned_;  // keeps its elements where they are
};

// Reads whole accessors. What is passed by reference or pointer must outlive this.
class GltfAccessors {
 public:
  GltfAccessors(const NamedBytes& source, const GltfDocument& document, std::optional<std::string_view> binary_chunk,
                GltfBudget& budget, std::vector<FileRead>* companions)
      : file_(source.name),
        document_(document),
        buffers_(source, document, binary_chunk, budget, companions),
        budget_(budget) {}

  // Quantized ones are returned as the reals that they stand for. Throws InputError.
  std::vector<Vec3> positions(std::size_t accessor);
  std::vector<std::uint32_t> indices(std::size_t accessor);

 private:
  struct Elements;

  template <class Element>
  std::vector<Element> read(std::size_t index, std::size_t components, Element (Elements::*get)(std::size_t) const);
  template <class Element>
  void replace_sparse(std::size_t index, std::size_t components, Element (Elements::*get)(std::size_t) const,
                      std::vector<Element>& result);
  // `count` elements from byte `offset` of view number `view` on.
  Elements elements(std::size_t accessor, std::size_t view, std::uint64_t offset, std::uint64_t type,
                    std::size_t components, std::uint64_t count);
  [[noreturn]] void fail(std::size_t accessor, const std::string& what) const;

  const std::string& file_;
  const GltfDocument& document_;
  GltfBuffers buffers_;
  GltfBudget& budget_;
};

// The largest number of the accessor's index type, which asks graphics hardware to restart the primitive.
[[nodiscard]] std::uint32_t restart_value(const GltfAccessor& indices);

}  // namespace raycone
