// Format: Greg Turk, "The PLY Polygon File Format", 1994; type names with bit widths as most programs write them today.
#include "io/mesh/ply_header.h"

#include <algorithm>
#include <array>
#include <utility>

#include "io/files/ascii.h"

namespace raycone {
namespace {

constexpr std::array<std::pair<std::string_view, PlyScalar>, 16> kScalarNames = {{{"char", PlyScalar::kInt8},
                                                                                  {"int8", PlyScalar::kInt8},
                                                                                  {"uchar", PlyScalar::kUint8},
                                                                                  {"uint8", PlyScalar::kUint8},
                                                                                  {"short", PlyScalar::kInt16},
                                                                                  {"int16", PlyScalar::kInt16},
                                                                                  {"ushort", PlyScalar::kUint16},
                                                                                  {"uint16", PlyScalar::kUint16},
                                                                                  {"int", PlyScalar::kInt32},
                                                                                  {"int32", PlyScalar::kInt32},
                                                                                  {"uint", PlyScalar::kUint32},
                                                                                  {"uint32", PlyScalar::kUint32},
                                                                                  {"float", PlyScalar::kFloat32},
                                                                                  {"float32", PlyScalar::kFloat32},
                                                                                  {"double", PlyScalar::kFloat64},
                                                                                  {"float64", PlyScalar::kFloat64}}};

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

class HeaderReader {
 public:
  explicit HeaderReader(TextScanner& text) : text_(text) {}

  PlyHeader read() {
    if (next_word() != "ply") text_.fail_at(0, "expected 'ply' in the first line");
    text_.skip_line();
    while (read_line()) text_.skip_line();
    if (!has_format_) text_.fail("the header has no line 'format'");
    find_vertices();
    text_.skip_line();
    return std::move(header_);
  }

 private:
  // False at the header's last line.
  bool read_line() {
    if (!text_.skip_empty_lines()) text_.fail_expecting("'end_header'");
    const std::size_t offset = text_.offset();
    const std::string_view keyword = next_word();
    if (keyword == "format") {
      read_format();
    } else if (keyword == "element") {
      read_element();
    } else if (keyword == "property") {
      read_property();
    } else if (keyword != "comment" && keyword != "obj_info" && keyword != "end_header") {
      text_.seek(offset);
      if (!is_letter(text_.peek())) text_.fail_expecting("'element', 'property' or 'end_header'");
      ++header_.unknown_lines;
    }
    return keyword != "end_header";
  }

  void read_format() {
    text_.skip_blanks();
    const std::string_view encoding = text_.peek_word();
    if (encoding == "ascii") {
      header_.encoding = PlyEncoding::kAscii;
    } else if (encoding == "binary_little_endian") {
      header_.encoding = PlyEncoding::kLittleEndian;
    } else if (encoding == "binary_big_endian") {
      header_.encoding = PlyEncoding::kBigEndian;
    } else {
      text_.fail_expecting("'ascii', 'binary_little_endian' or 'binary_big_endian'");
    }
    text_.advance(encoding.size());
    has_format_ = true;
  }

  void read_element() {
    const std::string name(next_word());
    text_.skip_blanks();
    const std::optional<std::int64_t> count = text_.integer();
    if (!count) text_.fail_expecting("the number of elements '" + excerpt(name) + "'");
    if (*count < 0) text_.fail("expected 0 or more elements '" + excerpt(name) + "', found " + std::to_string(*count));
    header_.elements.push_back({name, static_cast<std::uint64_t>(*count), {}});
  }

  void read_property() {
    if (header_.elements.empty()) text_.fail("property before the first element");
    std::optional<PlyScalar> count_type;
    text_.skip_blanks();
    if (text_.skip_word("list")) count_type = read_scalar_type();
    const PlyScalar type = read_scalar_type();
    text_.skip_blanks();
    if (text_.at_line_end()) text_.fail_expecting("the property's name");
    header_.elements.back().properties.push_back({std::string(next_word()), type, count_type});
  }

  void find_vertices() {
    const auto is_vertex = [](const PlyElement& element) { return element.name == "vertex"; };
    const auto found = std::find_if(header_.elements.begin(), header_.elements.end(), is_vertex);
    if (found == header_.elements.end()) text_.fail("the header has no element 'vertex'");
    if (std::any_of(found + 1, header_.elements.end(), is_vertex)) text_.fail("the header has two elements 'vertex'");
    for (const std::string_view name : kPlyCoordinates) {
      const PlyProperty* property = found->find(name);
      if (!property || property->is_list())
        text_.fail("element 'vertex' has no number '" + std::string(name) + "', expected 'x', 'y' and 'z'");
    }
    header_.vertex_element = static_cast<std::size_t>(found - header_.elements.begin());
  }

  PlyScalar read_scalar_type() {
    text_.skip_blanks();
    const std::string_view word = text_.peek_word();
    const auto* const known = std::ranges::find(kScalarNames, word, [](const auto& named) { return named.first; });
    if (known == kScalarNames.end()) text_.fail_expecting("a type such as 'float' or 'int32'");
    text_.advance(word.size());
    return known->second;
  }

  std::string_view next_word() {
    text_.skip_blanks();
    const std::string_view word = text_.peek_word();
    text_.advance(word.size());
    return word;
  }

  TextScanner& text_;
  PlyHeader header_;
  bool has_format_ = false;
};

}  // namespace

const PlyProperty* PlyElement::find(std::string_view property) const {
  const auto has_name = [&](const PlyProperty& candidate) { return candidate.name == property; };
  const auto found = std::find_if(properties.begin(), properties.end(), has_name);
  return found == properties.end() ? nullptr : &*found;
}

PlyHeader read_ply_header(TextScanner& text) { return HeaderReader(text).read(); }

}  // namespace raycone
