#include "io/files/npy_head.h"

#include <charconv>
#include <system_error>

#include "io/files/ascii.h"
#include "io/files/byte_order.h"
#include "io/files/file_error.h"

namespace raycone {
namespace {

constexpr std::size_t kMaxHead = std::size_t{1} << 16;

// What follows key `'name':` in the head, a Python dictionary; empty where it is missing.
std::string_view value_of(std::string_view dictionary, std::string_view name) {
  for (const char quote : {'\'', '"'}) {
    const std::string key = quote + std::string(name) + quote;
    for (std::size_t at = dictionary.find(key); at != std::string_view::npos; at = dictionary.find(key, at + 1)) {
      std::size_t position = dictionary.find_first_not_of(" \t", at + key.size());
      if (position == std::string_view::npos || dictionary[position] != ':') continue;  // a field of that name
      position = dictionary.find_first_not_of(" \t", position + 1);
      if (position != std::string_view::npos) return dictionary.substr(position);
    }
  }
  return {};
}

class HeadParser {
 public:
  HeadParser(std::string_view dictionary, const std::string& file) : dictionary_(dictionary), file_(file) {}

  [[nodiscard]] NpyHead parse() const {
    NpyHead head;
    head.type = parse_type();
    head.fortran_order = parse_order();
    parse_shape(head);
    return head;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw InputError(file_ + ": NPY " + what); }

  [[nodiscard]] std::string parse_type() const {
    const std::string_view value = value_of(dictionary_, "descr");
    if (value.empty()) fail("header without a type (descr), expected one");
    if (value.front() == '[') return std::string(value.substr(0, end_of_list(value)));
    const std::size_t end = value.find(value.front(), 1);
    if (end == std::string_view::npos || (value.front() != '\'' && value.front() != '"')) {
      fail("type " + excerpt(value) + ", expected a text or a list");
    }
    return std::string(value.substr(1, end - 1));
  }

  // Behind the bracket that closes the first one.
  static std::size_t end_of_list(std::string_view text) {
    std::size_t depth = 0;
    char quote = '\0';  // within a text: how it ends
    for (std::size_t n = 0; n < text.size(); ++n) {
      const char c = text[n];
      if (quote != '\0') {
        if (c == '\\') ++n;
        if (c == quote) quote = '\0';
      } else if (c == '\'' || c == '"') {
        quote = c;
      } else if (c == '[') {
        ++depth;
      } else if (c == ']' && --depth == 0) {
        return n + 1;
      }
    }
    return text.size();
  }

  [[nodiscard]] bool parse_order() const {
    const std::string_view value = value_of(dictionary_, "fortran_order");
    if (value.starts_with("True")) return true;
    if (!value.starts_with("False")) fail("header without fortran_order, expected True or False");
    return false;
  }

  void parse_shape(NpyHead& head) const {
    const std::string_view value = value_of(dictionary_, "shape");
    const std::size_t end = value.find(')');
    if (!value.starts_with('(') || end == std::string_view::npos)
      fail("header without a shape, expected whole numbers");
    const std::string_view shape = value.substr(0, end + 1);
    const auto is_between = [](char c) { return c == 'L' || c == ',' || c == ' '; };  // Python 2 wrote 10L
    const char* c = shape.data() + 1;
    while (*c == ' ') ++c;
    while (*c != ')') {
      std::uint64_t size = 0;
      const auto [after, error] = std::from_chars(c, shape.data() + shape.size(), size);
      if (error != std::errc()) fail("shape " + excerpt(shape) + ", expected whole numbers");
      head.shape.push_back(size);
      for (c = after; is_between(*c);) ++c;
    }
    head.shape_text = shape;
  }

  std::string_view dictionary_;
  const std::string& file_;
};

}  // namespace

void require_bytes(InputBuffer& input, std::size_t count, const char* what) {
  while (input.pending().size() < count) {
    if (input.fill()) continue;
    fail_at_byte(input.name(), input.offset() + input.pending().size(), std::string("the file ends within ") + what);
  }
}

NpyHead read_npy_head(InputBuffer& input) {
  constexpr std::size_t kPrefix = 12;  // magic, version, length of the header in 2 or 4 bytes; it is never shorter
  require_bytes(input, kPrefix, "the NPY header");
  if (!input.pending().starts_with(kNpyMagic)) throw InputError(input.name() + ": not an NPY file");
  const int version = static_cast<unsigned char>(input.pending()[6]);
  if (version < 1 || version > 3) {
    throw InputError(input.name() + ": NPY version " + std::to_string(version) + ", expected 1 to 3");
  }
  const char* length = input.pending().data() + 8;
  const std::size_t start = version == 1 ? 10 : 12;
  const std::size_t size =
      version == 1 ? load_little_endian<std::uint16_t>(length) : load_little_endian<std::uint32_t>(length);
  if (size > kMaxHead) {
    throw InputError(input.name() + ": NPY header of " + std::to_string(size) + " bytes, expected at most " +
                     std::to_string(kMaxHead));
  }
  require_bytes(input, start + size, "the NPY header");
  NpyHead head = HeadParser(input.pending().substr(start, size), input.name()).parse();
  head.data_offset = start + size;
  input.consume(start + size);
  return head;
}

std::string npy_head(const std::string& descriptor, const std::string& shape) {
  constexpr std::size_t kAlignment = 64;
  constexpr std::size_t kPreamble = 10;  // magic, version, length
  std::string text = "{'descr': '" + descriptor + "', 'fortran_order': False, 'shape': " + shape + ", }";
  const std::size_t total = (kPreamble + text.size() + 1 + kAlignment - 1) / kAlignment * kAlignment;
  text.append(total - kPreamble - text.size() - 1, ' ');
  text += '\n';
  const auto low = static_cast<char>(text.size() & 0xFF);
  const auto high = static_cast<char>(text.size() >> 8);
  return std::string(kNpyMagic) + '\x01' + '\0' + low + high + text;
}

}  // namespace raycone
