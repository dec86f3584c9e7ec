// What the writers of meshes share.
#pragma once

#include <array>
#include <charconv>
#include <cstddef>
#include <string>
#include <string_view>

#include "io/files/output_file.h"

namespace raycone {

// Hands bytes to the file in large pieces, the last ones by finish(). All throw OutputError.
class MeshOutput {
 public:
  explicit MeshOutput(OutputFile& output) : output_(output) {}

  void text(std::string_view words) {
    bytes_ += words;
    if (bytes_.size() >= kPiece) flush();
  }
  template <class Number>
  void binary(Number number) {
    text({reinterpret_cast<const char*>(&number), sizeof number});
  }
  // Shortest digits that give the number back.
  template <class Number>
  void number(Number value) {
    std::array<char, 32> digits;
    text({digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr});
  }
  // Commits the file.
  void finish() {
    flush();
    output_.commit();
  }

 private:
  void flush() {
    output_.write(bytes_.data(), bytes_.size());
    bytes_.clear();
  }

  static constexpr std::size_t kPiece = std::size_t{1} << 18;
  OutputFile& output_;
  std::string bytes_;
};

// Throws LimitError, which names `output`, for more than 2^31 - 1 vertices: programs read indices as `int`.
void check_vertex_count(const OutputFile& output, std::size_t vertices);

// The head of a binary little-endian PLY file of elements `vertex`, with coordinates as double, and `face`, with a list
// `vertex_indices`; the properties that follow these, and further elements, are given as their lines.
[[nodiscard]] std::string ply_head(std::size_t vertices, const std::string& vertex_properties, std::size_t faces,
                                   const std::string& face_properties, const std::string& elements = "");

}  // namespace raycone
