#include "io/mesh/mesh_signature.h"

#include "io/files/byte_order.h"
#include "io/files/text_scanner.h"

namespace raycone {
namespace {

std::string_view without_leading_space(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  return text;
}

bool is_ply(std::string_view text) { return text.starts_with("ply") && text.size() > 3 && is_space(text[3]); }

bool has_exact_stl_size(std::string_view bytes) {
  const std::optional<std::uint32_t> triangles = announced_stl_triangles(bytes);
  return triangles && bytes.size() == kStlHeaderSize + kStlTriangleSize * *triangles;
}

}  // namespace

std::optional<MeshFormat> recognise_mesh(std::string_view bytes) {
  // First of all: a header of binary STL may say anything, but no text has this size by chance, for the count's bytes
  // would be text too, and announce more than 10^8 triangles. PLY and GLB have text there.
  if (has_exact_stl_size(bytes)) return MeshFormat::kStl;
  if (bytes.starts_with("glTF")) return MeshFormat::kGlb;
  if (bytes.starts_with("PK\x03\x04")) return MeshFormat::k3mf;  // a ZIP archive
  const std::string_view text = without_byte_order_mark(bytes);
  if (is_ply(text)) return MeshFormat::kPly;
  const std::string_view start = without_leading_space(text);
  if (!off_keyword(start).empty()) return MeshFormat::kOff;
  if (is_ascii_stl(bytes)) return MeshFormat::kStl;
  if (start.starts_with('{')) return MeshFormat::kGltf;  // JSON
  return std::nullopt;
}

std::string_view off_keyword(std::string_view text) {
  std::size_t length = 0;
  while (length < text.size()) {
    if (text.substr(length).starts_with("OFF")) {
      length += 3;
      // Some files glue the first count to the keyword.
      const bool ends =
          length == text.size() || is_space(text[length]) || is_digit(text[length]) || text[length] == '#';
      return ends ? text.substr(0, length) : std::string_view();
    }
    if (text.substr(length).starts_with("ST"))
      length += 2;
    else if (std::string_view("CN4n").find(text[length]) != std::string_view::npos)
      length += 1;
    else
      break;
  }
  return {};
}

std::optional<std::uint32_t> announced_stl_triangles(std::string_view bytes) {
  if (bytes.size() < kStlHeaderSize) return std::nullopt;
  return load_little_endian<std::uint32_t>(bytes.data() + 80);
}

bool is_ascii_stl(std::string_view bytes) {
  if (has_exact_stl_size(bytes)) return false;
  std::string_view text = without_leading_space(without_byte_order_mark(bytes));
  constexpr std::string_view kKeyword = "solid";
  if (text.size() < kKeyword.size()) return false;
  for (const char expected : kKeyword) {
    if (text.front() != expected && text.front() != expected - 'a' + 'A') return false;
    text.remove_prefix(1);
  }
  if (!text.empty() && !is_space(text.front())) return false;
  // The count of a binary file of less than 800 MB has a zero byte.
  return bytes.substr(0, kStlHeaderSize).find('\0') == std::string_view::npos;
}

}  // namespace raycone
