// STL, ASCII and binary: triangles as three positions each. Normals and attributes are passed over: the order of the
// corners is what orients a triangle. Format: 3D Systems, "StereoLithography Interface Specification", 1988.
#include <limits>

#include "io/files/ascii.h"
#include "io/files/byte_order.h"
#include "io/files/counted.h"
#include "io/files/text_scanner.h"
#include "io/mesh/mesh_builder.h"
#include "io/mesh/mesh_error.h"
#include "io/mesh/mesh_signature.h"
#include "io/mesh/read_mesh.h"

namespace raycone {
namespace {

// Text without what DOS and tapes have behind it.
NamedBytes without_padding(const NamedBytes& source) {
  const std::size_t text_end = source.bytes.find_last_not_of(std::string_view("\0\x1A \t\r\n\v\f", 8)) + 1;
  const std::size_t end = source.bytes.find_first_of(std::string_view("\0\x1A", 2), text_end);
  return {source.name, source.directory, source.bytes.substr(0, end)};
}

class AsciiStlReader {
 public:
  explicit AsciiStlReader(const NamedBytes& source) : text_(source), builder_(source) { text_.take_mixed_line_ends(); }

  // Solids follow each other; a missing last "endsolid" does no harm.
  ParsedMesh read() {
    groups_.start_group("", 0);
    for (text_.skip_whitespace(); !text_.at_end(); text_.skip_whitespace()) {
      if (text_.skip_word("facet")) {
        read_facet();
      } else if (text_.skip_word("solid")) {
        name_ = read_name([this] { return begins_facet(); });
        groups_.start_group(std::string(name_), builder_.triangle_count());
      } else if (next_ends("endsolid")) {
        skip_end_name();
      } else {
        text_.fail_expecting("'facet' or 'endsolid'");
      }
    }
    if (const auto offset = builder_.non_finite_corner_offset()) text_.fail_at(*offset, kNonFiniteCorner);
    ParsedMesh parsed = builder_.finish();
    parsed.groups = groups_.finish(parsed.mesh.triangles.size());
    return parsed;
  }

 private:
  // A name of any bytes, without blanks around it: up to the end of the line, or to the first word in it where `ends()`
  // says so.
  template <class Ends>
  std::string_view read_name(const Ends& ends) {
    const std::size_t line_end = next_line();
    text_.skip_whitespace();
    const std::string_view rest = text_.rest();
    const std::size_t start = text_.offset();
    std::size_t end = start;
    for (; text_.offset() < line_end; text_.skip_whitespace()) {
      if (ends()) return rest.substr(0, end - start);
      text_.skip_token();
      end = text_.offset();
    }
    text_.seek(line_end);
    return rest.substr(0, end - start);
  }

  // Behind `endsolid`: the solid's own name, whatever that holds, or words up to another solid or a facet. Where there
  // is no other solid but a name with that word, what it starts is empty and left out.
  void skip_end_name() {
    skip_own_name();
    read_name([this] { return is_word(text_.peek_word(), "solid") || begins_facet(); });
  }

  void skip_own_name() {
    const std::size_t start = text_.offset(), line_end = next_line();
    text_.skip_whitespace();
    if (text_.offset() >= line_end || !text_.rest().starts_with(name_)) return text_.seek(start);
    text_.advance(name_.size());
    if (!text_.at_end() && !is_space(text_.peek())) text_.seek(start);
  }

  // Where the next line starts. Looked for once a line: all solids may be in a single one.
  std::size_t next_line() {
    const std::size_t start = text_.offset();
    if (start < line_end_) return line_end_;
    text_.skip_line();
    line_end_ = text_.offset();
    text_.seek(start);
    return line_end_;
  }

  // Names may hold the word "facet", so it takes more than that.
  bool begins_facet() {
    const std::size_t start = text_.offset();
    bool found = next_is("facet") && next_is("normal");
    for (int axis = 0; found && axis < 3; ++axis) {
      text_.skip_whitespace();
      text_.skip_token();
    }
    found = found && next_is("outer") && next_is("loop");
    text_.seek(start);
    return found;
  }

  bool next_is(std::string_view word) {
    text_.skip_whitespace();
    return text_.skip_word(word);
  }

  void read_facet() {
    expect("normal");
    for (int axis = 0; axis < 3; ++axis) skip_normal_component();
    expect("outer");
    expect("loop");
    builder_.begin_polygon();
    text_.skip_whitespace();
    while (text_.skip_word("vertex")) {
      read_vertex();
      text_.skip_whitespace();
    }
    builder_.end_polygon();
    if (!next_ends("endloop")) text_.fail_expecting("'vertex' or 'endloop'");
    if (!next_ends("endfacet")) text_.fail_expecting("'endfacet'");
  }

  // `word`: "endloop", or the like. It may be two in one line: "end loop".
  bool next_ends(std::string_view word) {
    constexpr std::string_view kEnd = "end";
    if (next_is(word)) return true;
    const std::size_t start = text_.offset();
    if (next_is(kEnd)) {
      const std::size_t line_end = next_line();
      if (next_is(word.substr(kEnd.size())) && text_.offset() <= line_end) return true;
    }
    text_.seek(start);
    return false;
  }

  // Whatever stands there: normals of degenerate triangles are often not numbers.
  void skip_normal_component() {
    text_.skip_whitespace();
    if (text_.at_end()) text_.fail_expecting("a normal");
    text_.skip_token();
  }

  void read_vertex() {
    const std::size_t offset = text_.offset();
    Vec3 vertex;
    for (int axis = 0; axis < 3; ++axis) {
      text_.skip_whitespace();
      vertex[axis] = text_.expected_number("a coordinate");
    }
    builder_.add_vertex(vertex, offset);
    builder_.add_corner(static_cast<std::uint32_t>(builder_.vertex_count() - 1));
  }

  void expect(std::string_view word) {
    if (!next_is(word)) text_.fail_expecting("'" + std::string(word) + "'");
  }

  TextScanner text_;
  MeshBuilder builder_;
  GroupCollector groups_;
  std::string_view name_;     // of the solid
  std::size_t line_end_ = 0;  // of the line that was looked at last: where the next one starts
};

Vec3 load_vertex(const char* bytes) {
  return {load_little_endian<float>(bytes), load_little_endian<float>(bytes + 4), load_little_endian<float>(bytes + 8)};
}

// The number of triangles, which the bytes are enough for.
std::uint32_t checked_triangle_count(const NamedBytes& source) {
  const std::optional<std::uint32_t> count = announced_stl_triangles(source.bytes);
  if (!count) {
    throw InputError(source.name + ":1: expected 'solid' or the " + std::to_string(kStlHeaderSize) +
                     " bytes that open a binary STL, the file has only " + std::to_string(source.bytes.size()));
  }
  const std::string_view head = source.bytes.substr(0, kStlHeaderSize);
  const std::uint64_t room = (source.bytes.size() - kStlHeaderSize) / kStlTriangleSize;
  const auto is_text = [](char c) { return (c >= ' ' && c <= '~') || is_space(c); };
  if (*count > room && std::ranges::all_of(head, is_text)) {
    const std::string_view line = head.substr(0, head.find_first_of("\r\n"));
    throw InputError(source.name + ":1: found '" + excerpt(line) + "', expected 'solid' or a binary STL");
  }
  if (*count > room) {
    fail_at_byte(source.name, kStlHeaderSize - 4,
                 counted(*count, "triangle") + " announced, but only " + std::to_string(room) +
                     (room == 1 ? " follows" : " follow"));
  }
  if (*count > std::numeric_limits<std::uint32_t>::max() / 3) {
    throw LimitError(source.name + ": " + std::to_string(*count) +
                     " triangles, whose vertices 32-bit indices cannot address");
  }
  return *count;
}

ParsedMesh read_binary_stl(const NamedBytes& source) {
  constexpr std::size_t kNormalSize = 12;
  constexpr std::size_t kVertexSize = 12;
  const std::uint32_t count = checked_triangle_count(source);
  ParsedMesh parsed;
  parsed.mesh.vertices.reserve(std::size_t{3} * count);
  parsed.mesh.triangles.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::size_t offset = kStlHeaderSize + kStlTriangleSize * i;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::size_t start = offset + kNormalSize + kVertexSize * corner;
      const Vec3 vertex = load_vertex(source.bytes.data() + start);
      if (!is_finite(vertex)) fail_at_byte(source.name, start, kNonFiniteCorner);
      parsed.mesh.vertices.push_back(vertex);
    }
    parsed.mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  if (count > 0) parsed.groups = {{""}, {{0, 0}}};
  const std::uint64_t surplus = source.bytes.size() - kStlHeaderSize - kStlTriangleSize * count;
  if (surplus > 0) {
    parsed.warnings.push_back({"trailing-data", "bytes after the announced number of triangles (" +
                                                    std::to_string(count) + ") ignored: " + std::to_string(surplus)});
  }
  return parsed;
}

}  // namespace

ParsedMesh read_stl(const NamedBytes& source) {
  // Text in UTF-16 is refused by the text scanner, more clearly than as a binary STL of a wrong size.
  const bool is_text =
      is_ascii_stl(source.bytes) || (is_utf16(source.bytes) && recognise_mesh(source.bytes) != MeshFormat::kStl);
  return is_text ? AsciiStlReader(without_padding(source)).read() : read_binary_stl(source);
}

}  // namespace raycone
