// OFF, the Object File Format of Geomview: ASCII, three coordinates, colours, normals and texture coordinates passed
// over. Format: geomview.org, "OFF Files" (object file formats, OOGL reference).
#include "io/files/counted.h"
#include "io/files/text_scanner.h"
#include "io/mesh/mesh_builder.h"
#include "io/mesh/mesh_error.h"
#include "io/mesh/mesh_signature.h"
#include "io/mesh/read_mesh.h"

namespace raycone {
namespace {

class OffReader {
 public:
  explicit OffReader(const NamedBytes& source) : text_(source), builder_(source) { text_.take_mixed_line_ends(); }

  ParsedMesh read() {
    read_keyword();
    const std::size_t counts = text_.offset();
    const std::uint64_t vertices = read_count("vertex");
    const std::uint64_t faces = read_count("face");
    // The number of edges, often wrong and sometimes absent, tells nothing.
    text_.skip_line();
    check_announced(counts, "vertex", vertices, kShortestVertex);
    check_announced(counts, "face", faces, kShortestFace);
    builder_.reserve_vertices(vertices);
    for (std::uint64_t i = 0; i < vertices; ++i) read_vertex(i, vertices);
    for (std::uint64_t i = 0; i < faces; ++i) read_face(i, faces);
    if (text_.skip_empty_lines()) builder_.warn({"trailing-data", "lines after the last face ignored"});
    if (const auto offset = builder_.non_finite_corner_offset()) text_.fail_at(*offset, kNonFiniteCorner);
    return builder_.finish();
  }

 private:
  static constexpr std::size_t kShortestVertex = 6;  // "0 0 0" and a line end
  static constexpr std::size_t kShortestFace = 2;    // "0" and a line end

  // The keyword is optional, says the format.
  void read_keyword() {
    if (!text_.skip_empty_lines()) text_.fail_expecting("'OFF'");
    const std::string_view keyword = off_keyword(text_.rest());
    if (keyword.empty()) {
      if (!is_digit(text_.peek())) text_.fail_expecting("'OFF'");
      return;
    }
    if (keyword.find_first_of("4n") != std::string_view::npos) {
      text_.fail(std::string(keyword) +
                 " is not supported: its points do not have three coordinates, expected OFF, COFF or NOFF");
    }
    text_.advance(keyword.size());
    text_.skip_blanks();
    if (text_.peek_word() == "BINARY") text_.fail("binary OFF is not supported, expected ASCII OFF");
    if (!text_.skip_empty_lines()) text_.fail_expecting("the number of vertices");
  }

  // A count of the line at the position.
  std::uint64_t read_count(const char* what) {
    text_.skip_blanks();
    const std::optional<std::int64_t> count = text_.at_line_end() ? std::nullopt : text_.integer();
    if (!count) text_.fail_expecting("the number of " + plural_of(what));
    if (*count < 0) text_.fail("expected 0 or more " + plural_of(what) + ", found " + std::to_string(*count));
    return static_cast<std::uint64_t>(*count);
  }

  // Before anything is allocated for them.
  void check_announced(std::size_t offset, const char* what, std::uint64_t count, std::size_t shortest) const {
    if (count <= (text_.remaining() + 1) / shortest) return;
    text_.fail_at(offset, counted(count, what) + " announced, but only " + remaining_bytes(text_.remaining()));
  }

  void next_row(const char* what, std::uint64_t index, std::uint64_t count) {
    if (text_.skip_empty_lines()) return;
    text_.fail("the file ends after " + std::to_string(index) + " of " + counted(count, what));
  }

  void read_vertex(std::uint64_t index, std::uint64_t count) {
    next_row("vertex", index, count);
    const std::size_t offset = text_.offset();
    Vec3 vertex;
    for (int axis = 0; axis < 3; ++axis) {
      text_.skip_blanks();
      vertex[axis] = text_.expected_number("a coordinate");
    }
    builder_.add_vertex(vertex, offset);
    text_.skip_line();
  }

  void read_face(std::uint64_t index, std::uint64_t count) {
    next_row("face", index, count);
    const std::uint64_t corners = read_count("corner");
    builder_.begin_polygon();
    for (std::uint64_t i = 0; i < corners; ++i) builder_.add_corner(read_corner());
    builder_.end_polygon();
    text_.skip_line();
  }

  std::uint32_t read_corner() {
    text_.skip_blanks();
    const std::size_t offset = text_.offset();
    const std::optional<std::int64_t> index = text_.integer();
    if (!index) text_.fail_expecting("a vertex index");
    if (*index < 0 || static_cast<std::uint64_t>(*index) >= builder_.vertex_count())
      text_.fail_at(offset, index_out_of_range(*index, builder_.vertex_count()));
    return static_cast<std::uint32_t>(*index);
  }

  TextScanner text_;
  MeshBuilder builder_;
};

}  // namespace

ParsedMesh read_off(const NamedBytes& source) { return OffReader(source).read(); }

}  // namespace raycone
