// PLY, ASCII and binary: the vertices, faces and triangle strips of a file; other elements and properties are passed
// over. Format: Greg Turk, "The PLY Polygon File Format", 1994.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>

#include "io/files/ascii.h"
#include "io/files/byte_order.h"
#include "io/files/counted.h"
#include "io/files/text_scanner.h"
#include "io/mesh/mesh_builder.h"
#include "io/mesh/mesh_error.h"
#include "io/mesh/ply.h"
#include "io/mesh/ply_header.h"

namespace raycone {
namespace {

template <std::integral Number>
std::optional<std::int64_t> to_integer(Number value) {
  return value;
}

template <std::floating_point Number>
std::optional<std::int64_t> to_integer(Number value) {
  constexpr Number kLargest = 9007199254740992;  // 2^53: every integer below is a double
  if (!(std::abs(value) <= kLargest) || value != std::trunc(value)) return std::nullopt;
  return static_cast<std::int64_t>(value);
}

// The body as text. A row begins in a line of its own and may go on in the next one. AsciiBody and BinaryBody have the
// same members, so that the reader is written once.
class AsciiBody {
 public:
  explicit AsciiBody(const TextScanner& text) : text_(text), row_end_(text.offset()) { text_.take_mixed_line_ends(); }

  // Bytes that follow, but for blanks.
  [[nodiscard]] std::size_t remaining() {
    text_.skip_whitespace();
    return text_.remaining();
  }
  // How many rows of an element with properties the rest may hold at most.
  [[nodiscard]] std::uint64_t max_rows(const PlyElement& element) {
    constexpr std::size_t kShortestNumber = 2;  // a digit and a blank
    return (remaining() + 1) / (kShortestNumber * element.properties.size());
  }

  // Offset of the number that follows.
  std::size_t next_offset() {
    text_.skip_whitespace();
    return text_.offset();
  }
  // More numbers in the row's line are passed over. Behind a row of several lines they are an error: that is what a
  // header with one property too many looks like.
  void end_row() {
    text_.skip_blanks();
    if (!text_.at_line_end() || text_.peek() == '#') {
      if (!is_in_one_line()) text_.fail_expecting("the end of the line");
      ++long_rows_;
      text_.skip_line();
    }
    row_end_ = text_.offset();
  }
  [[nodiscard]] std::uint64_t long_rows() const { return long_rows_; }

  // The text's value as it stands: a declared type of lower precision does not round it.
  double number(PlyScalar) {
    text_.skip_whitespace();
    return text_.expected_number("a number");
  }
  std::int64_t integer(PlyScalar) {
    text_.skip_whitespace();
    const std::size_t start = text_.offset();
    if (const std::optional<std::int64_t> value = text_.integer()) return *value;
    // "3.0" of a property declared as a float.
    const std::optional<double> number = text_.number();
    const std::optional<std::int64_t> value = number ? to_integer(*number) : std::nullopt;
    if (value) return *value;
    text_.seek(start);
    text_.fail_expecting("an integer");
  }
  // Calls use(integer, its offset) for the next `count` numbers.
  template <class Use>
  void for_each_integer(PlyScalar type, std::uint64_t count, Use use) {
    for (; count > 0; --count) {
      const std::size_t offset = next_offset();
      use(integer(type), offset);
    }
  }
  void skip(PlyScalar, std::uint64_t count) {
    for (; count > 0; --count) {
      text_.skip_whitespace();
      if (text_.at_end()) text_.fail_expecting("a number");
      text_.skip_token();
    }
  }

  [[noreturn]] void fail_at(std::size_t offset, const std::string& what) const { text_.fail_at(offset, what); }

 private:
  // Whether the row that ends here began in the same line.
  [[nodiscard]] bool is_in_one_line() const {
    TextScanner row = text_;
    row.seek(row_end_);
    row.skip_whitespace();
    row.skip_line();
    return text_.offset() < row.offset() || text_.at_end();
  }

  TextScanner text_;
  std::size_t row_end_;  // of the row before
  std::uint64_t long_rows_ = 0;
};

class BinaryBody {
 public:
  BinaryBody(const NamedBytes& source, std::size_t offset, std::endian order)
      : source_(source), offset_(offset), order_(order) {}

  [[nodiscard]] std::size_t remaining() const { return source_.bytes.size() - offset_; }
  [[nodiscard]] std::uint64_t max_rows(const PlyElement& element) const {
    std::size_t shortest = 0;
    for (const PlyProperty& property : element.properties)
      shortest += size_of(property.count_type.value_or(property.type));
    return remaining() / shortest;  // NOLINT(clang-analyzer-core.DivideZero): checked_rows() asks where there are some
  }

  [[nodiscard]] std::size_t next_offset() const { return offset_; }
  void end_row() const {}
  [[nodiscard]] std::uint64_t long_rows() const { return 0; }

  double number(PlyScalar type) {
    const std::size_t start = offset_;
    skip(type, 1);
    return with_type(type, [&](auto number) { return static_cast<double>(load_at<decltype(number)>(start)); });
  }
  std::int64_t integer(PlyScalar type) {
    const std::size_t start = offset_;
    skip(type, 1);
    const auto value = with_type(type, [&](auto number) { return to_integer(load_at<decltype(number)>(start)); });
    if (!value) fail_at(start, "expected an integer, found another number");
    return *value;
  }
  template <class Use>
  void for_each_integer(PlyScalar type, std::uint64_t count, Use use) {
    std::size_t offset = offset_;
    skip(type, count);
    with_type(type, [&](auto number) {
      using Number = decltype(number);
      for (; offset < offset_; offset += sizeof(Number)) {
        const auto value = to_integer(load_at<Number>(offset));
        if (!value) fail_at(offset, "expected an integer, found another number");
        use(*value, offset);
      }
    });
  }
  void skip(PlyScalar type, std::uint64_t count) {
    if (count > remaining() / size_of(type)) fail_at(source_.bytes.size(), "the file ends within an element");
    offset_ += static_cast<std::size_t>(count) * size_of(type);
  }

  [[noreturn]] void fail_at(std::size_t offset, const std::string& what) const {
    fail_at_byte(source_.name, offset, what);
  }

 private:
  template <class Number>
  [[nodiscard]] Number load_at(std::size_t offset) const {
    return load<Number>(source_.bytes.data() + offset, order_);
  }

  const NamedBytes& source_;
  std::size_t offset_;
  std::endian order_;
};

template <class Body>
class PlyReader {
 public:
  PlyReader(const NamedBytes& source, const PlyHeader& header, const Body& body)
      : header_(header), vertices_(header.elements[header.vertex_element]), body_(body), builder_(source) {}

  ParsedMesh read_mesh() {
    for (const PlyElement& element : header_.elements) read_element(element);
    if (const std::size_t surplus = body_.remaining())
      builder_.warn({"trailing-data", "bytes after the last element ignored: " + std::to_string(surplus)});
    if (const auto offset = builder_.non_finite_corner_offset()) body_.fail_at(*offset, kNonFiniteCorner);
    warn("unknown-header-lines", header_.unknown_lines, "header line", "of no known keyword ignored");
    warn("long-rows", body_.long_rows(), "row", "longer than the header announces, what is too much ignored");
    return builder_.finish();
  }

  // The vertices alone, all of them finite. What follows them is not looked at.
  std::vector<Vec3> read_points() {
    for (std::size_t i = 0; i < header_.vertex_element; ++i) skip_element(header_.elements[i]);
    read_vertices();
    if (const auto found = builder_.first_non_finite_vertex()) {
      body_.fail_at(found->offset, "vertex " + std::to_string(found->vertex) +
                                       " has a coordinate that is not finite, expected finite numbers");
    }
    return builder_.finish().mesh.vertices;
  }

 private:
  void read_element(const PlyElement& element) {
    if (&element == &vertices_) {
      read_vertices();
    } else if (element.name == "face") {
      read_faces(element);
    } else if (element.name == "tristrips") {
      read_strips(element);
    } else {
      skip_element(element);
    }
  }

  void warn(const char* name, std::uint64_t count, const std::string& noun, const std::string& what) {
    if (count > 0) builder_.warn({name, counted(count, noun) + " " + what});
  }

  // The number of rows, which the bytes that follow may be enough for. Rows without properties take none.
  std::uint64_t checked_rows(const PlyElement& element) {
    if (element.properties.empty()) return 0;
    if (element.count > body_.max_rows(element)) {
      body_.fail_at(body_.next_offset(), counted(element.count, "element") + " '" + excerpt(element.name) +
                                             "' announced, but only " + remaining_bytes(body_.remaining()));
    }
    return element.count;
  }

  void skip(const PlyProperty& property) { body_.skip(property.type, property.is_list() ? read_length(property) : 1); }

  std::uint64_t read_length(const PlyProperty& list) {
    const std::size_t offset = body_.next_offset();
    const std::int64_t length = body_.integer(*list.count_type);
    if (length < 0) body_.fail_at(offset, "list of length " + std::to_string(length) + ", expected 0 or more");
    return static_cast<std::uint64_t>(length);
  }

  void skip_element(const PlyElement& element) {
    for (std::uint64_t rows = checked_rows(element); rows > 0; --rows) {
      for (const PlyProperty& property : element.properties) skip(property);
      body_.end_row();
    }
  }

  void read_vertices() {
    std::vector<int> axes(vertices_.properties.size(), kNoAxis);  // of each property
    for (std::size_t axis = 0; axis < kPlyCoordinates.size(); ++axis) {
      const PlyProperty* const coordinate = vertices_.find(kPlyCoordinates[axis]);
      axes[static_cast<std::size_t>(coordinate - vertices_.properties.data())] = static_cast<int>(axis);
    }
    const std::uint64_t rows = checked_rows(vertices_);
    builder_.reserve_vertices(rows);
    for (std::uint64_t row = 0; row < rows; ++row) {
      const std::size_t offset = body_.next_offset();
      Vec3 vertex;
      for (std::size_t i = 0; i < axes.size(); ++i) {
        const PlyProperty& property = vertices_.properties[i];
        if (axes[i] == kNoAxis)
          skip(property);
        else
          vertex[axes[i]] = body_.number(property.type);
      }
      body_.end_row();
      builder_.add_vertex(vertex, offset);
    }
  }

  static constexpr int kNoAxis = -1;  // no coordinate

  void read_faces(const PlyElement& element) {
    constexpr std::size_t kShortestTriangle = 4;  // binary: a length and three indices of one byte each
    builder_.reserve_triangles(std::min<std::uint64_t>(element.count, body_.remaining() / kShortestTriangle));
    read_index_lists(element, [this](const PlyProperty& list) { read_polygon(list); });
  }

  void read_strips(const PlyElement& element) {
    read_index_lists(element, [this](const PlyProperty& list) { read_strip_list(list); });
  }

  // By either name; null where there is none.
  [[nodiscard]] static const PlyProperty* index_list(const PlyElement& element) {
    for (const char* const name : {"vertex_indices", "vertex_index"}) {
      const PlyProperty* const property = element.find(name);
      if (property && property->is_list()) return property;
    }
    return nullptr;
  }

  // Calls read(list) at the list of vertex indices of each row.
  template <class Read>
  void read_index_lists(const PlyElement& element, Read read) {
    const std::uint64_t rows = checked_rows(element);
    const PlyProperty* const indices = index_list(element);
    if (rows > 0 && !indices)
      body_.fail_at(body_.next_offset(),
                    "element '" + element.name + "' has no list 'vertex_indices' or 'vertex_index'");
    for (std::uint64_t row = 0; row < rows; ++row) {
      for (const PlyProperty& property : element.properties) {
        if (&property == indices)
          read(property);
        else
          skip(property);
      }
      body_.end_row();
    }
  }

  void read_polygon(const PlyProperty& list) {
    builder_.begin_polygon();
    body_.for_each_integer(list.type, read_length(list), [this](std::int64_t index, std::size_t offset) {
      builder_.add_corner(checked_index(index, offset));
    });
    builder_.end_polygon();
  }

  // Strips one behind the other, separated by -1. Every second triangle of a strip is turned round.
  void read_strip_list(const PlyProperty& list) {
    constexpr std::int64_t kRestart = -1;
    std::uint64_t length = 0;
    std::array<std::uint32_t, 2> last{};
    body_.for_each_integer(list.type, read_length(list), [&](std::int64_t index, std::size_t offset) {
      if (index == kRestart) {
        end_strip(length);
        length = 0;
        return;
      }
      const std::uint32_t corner = checked_index(index, offset);
      if (length >= 2) {
        const bool turned = length % 2 == 1;
        builder_.add_triangle(last[turned ? 1 : 0], last[turned ? 0 : 1], corner);
      }
      last = {last[1], corner};
      ++length;
    });
    end_strip(length);
  }

  void end_strip(std::uint64_t length) {
    if (length == 1 || length == 2) builder_.skip_face();
  }

  std::uint32_t checked_index(std::int64_t index, std::size_t offset) const {
    if (index < 0 || static_cast<std::uint64_t>(index) >= vertices_.count)
      body_.fail_at(offset, index_out_of_range(index, vertices_.count));
    return static_cast<std::uint32_t>(index);
  }

  const PlyHeader& header_;
  const PlyElement& vertices_;
  Body body_;
  MeshBuilder builder_;
};

// Calls read(reader) with the reader for the file's encoding.
template <class Read>
auto with_reader(const NamedBytes& source, Read read) {
  TextScanner text(source);
  const PlyHeader header = read_ply_header(text);
  if (header.encoding == PlyEncoding::kAscii) return read(PlyReader(source, header, AsciiBody(text)));
  const auto order = header.encoding == PlyEncoding::kLittleEndian ? std::endian::little : std::endian::big;
  return read(PlyReader(source, header, BinaryBody(source, text.offset(), order)));
}

}  // namespace

ParsedMesh read_ply(const NamedBytes& source) {
  return with_reader(source, [](auto reader) { return reader.read_mesh(); });
}

std::vector<Vec3> read_ply_vertices(const NamedBytes& source) {
  return with_reader(source, [](auto reader) { return reader.read_points(); });
}

}  // namespace raycone
