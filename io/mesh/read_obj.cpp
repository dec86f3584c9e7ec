// Wavefront OBJ: the polygons of a file; what concerns their looks, and curves, lines and points, is passed over.
// Format: Wavefront "Object Files (.obj)", Advanced Visualizer manual, appendix B1.
#include <string>
#include <utility>
#include <vector>

#include "io/files/counted.h"
#include "io/files/text_scanner.h"
#include "io/mesh/mesh_builder.h"
#include "io/mesh/mesh_error.h"
#include "io/mesh/read_mesh.h"

namespace raycone {
namespace {

class ObjReader {
 public:
  explicit ObjReader(const NamedBytes& source) : text_(source), builder_(source) { text_.take_mixed_line_ends(); }

  ParsedMesh read() {
    groups_.continue_group({kDefaultGroup}, 0);
    while (!text_.at_end()) {
      text_.skip_byte_order_mark();
      text_.skip_blanks();
      read_statement();
    }
    check_forward_references();
    if (const auto offset = builder_.non_finite_corner_offset()) text_.fail_at(*offset, kNonFiniteCorner);
    ParsedMesh parsed = builder_.finish();
    parsed.groups = groups_.finish(parsed.mesh.triangles.size());
    return parsed;
  }

 private:
  static constexpr const char* kDefaultGroup = "default";

  // A positive index that was beyond the vertices read so far.
  struct ForwardReference {
    std::int64_t index;
    std::size_t offset;
  };

  void read_statement() {
    const std::string_view keyword = text_.peek_word();
    if (keyword == "v") {
      read_vertex();
    } else if (keyword == "f" || keyword == "fo") {  // the latter is the name that faces had before version 3
      read_face(keyword.size());
    } else if (keyword == "g") {
      group_ = read_name();
      continue_group();
    } else if (keyword == "o") {
      object_ = read_name();
      group_ = {};
      continue_group();
    }
    text_.skip_continued_line('#');
  }

  // What follows the keyword, with single blanks.
  GroupName read_name() {
    text_.advance(1);
    GroupName name;
    for (text_.skip_blanks(); !text_.at_line_end(); text_.skip_blanks()) {
      const std::string_view rest = text_.rest();
      const std::size_t start = text_.offset();
      text_.skip_token();
      // A backslash glued to a word may join the next line to it.
      if (text_.offset() - start > 1 && rest[text_.offset() - start - 1] == '\\') {
        text_.seek(text_.offset() - 1);
        if (!text_.at_token_end()) text_.advance(1);
      }
      if (!name.text.empty()) append_to_name(name, " ");
      append_to_name(name, rest.substr(0, text_.offset() - start));
    }
    return name;
  }

  // A group belongs to its object, and many exporters give both the same name.
  void continue_group() {
    GroupName name = object_.text.empty() ? group_ : object_;
    if (!object_.text.empty() && !group_.text.empty() && object_ != group_) {
      append_to_name(name, "/");
      append_to_name(name, group_);
    }
    if (name.text.empty()) name.text = kDefaultGroup;
    groups_.continue_group(std::move(name), builder_.triangle_count());
  }

  // Weights and colours may follow.
  void read_vertex() {
    const std::size_t offset = text_.offset();
    text_.advance(1);
    Vec3 vertex;
    for (int axis = 0; axis < 3; ++axis) {
      text_.skip_blanks();
      vertex[axis] = text_.expected_number("a coordinate");
    }
    builder_.add_vertex(vertex, offset);
  }

  void read_face(std::size_t keyword) {
    text_.advance(keyword);
    builder_.begin_polygon();
    for (text_.skip_blanks(); !text_.at_line_end(); text_.skip_blanks()) builder_.add_corner(read_corner());
    builder_.end_polygon();
  }

  // "v", "v/vt", "v//vn" or "v/vt/vn": the index of the vertex, from 0.
  std::uint32_t read_corner() {
    const std::size_t offset = text_.offset();
    const std::optional<std::int64_t> index = text_.integer_prefix();
    skip_attributes();
    if (!index || !text_.at_token_end()) {
      text_.seek(offset);
      text_.fail_expecting("a vertex index");
    }
    return resolve(*index, offset);
  }

  // Moves past "/vt/vn".
  void skip_attributes() {
    if (text_.peek() != '/') return;
    while (text_.peek() == '/' || text_.peek() == '-' || is_digit(text_.peek())) text_.advance(1);
  }

  std::uint32_t resolve(std::int64_t index, std::size_t offset) {
    const auto count = static_cast<std::int64_t>(builder_.vertex_count());
    if (index == 0) text_.fail_at(offset, "face index 0, but OBJ counts vertices from 1");
    if (index < -count) {
      text_.fail_at(offset, "face index " + std::to_string(index) + ", but only " +
                                counted(static_cast<std::uint64_t>(count), "vertex") +
                                (count == 1 ? " precedes it" : " precede it"));
    }
    if (index < 0) return static_cast<std::uint32_t>(count + index);
    if (index > count) add_forward_reference(index, offset);
    return static_cast<std::uint32_t>(index - 1);
  }

  // Of forward references only those larger than all before matter: the first one out of range is among them.
  void add_forward_reference(std::int64_t index, std::size_t offset) {
    if (forward_references_.empty() || index > forward_references_.back().index)
      forward_references_.push_back({index, offset});
  }

  void check_forward_references() const {
    const auto count = static_cast<std::int64_t>(builder_.vertex_count());
    for (const ForwardReference& reference : forward_references_) {
      if (reference.index <= count) continue;
      text_.fail_at(reference.offset, "face index " + std::to_string(reference.index) + ", but the file has only " +
                                          counted(static_cast<std::uint64_t>(count), "vertex"));
    }
  }

  TextScanner text_;
  MeshBuilder builder_;
  GroupCollector groups_;
  GroupName object_, group_;  // of the faces that follow; empty: none
  std::vector<ForwardReference> forward_references_;
};

}  // namespace

ParsedMesh read_obj(const NamedBytes& source) { return ObjReader(source).read(); }

}  // namespace raycone
