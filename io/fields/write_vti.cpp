// VTI, VTK's XML files of regular grids, as ParaView reads them: a text head that says where each array begins, then
// the arrays in binary ("appended raw"), each behind its size in bytes.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/fields/array_elements.h"
#include "io/fields/format_writers.h"
#include "io/fields/index_range.h"
#include "io/files/ascii.h"
#include "io/files/seekable_output.h"

namespace raycone {
namespace {

static_assert(std::endian::native == std::endian::little, "elements are written as they are in memory");

using ArraySize = std::uint64_t;  // what stands before each array

// Elements per conversion: small enough to stay in the cache.
constexpr std::size_t kPiece = std::size_t{1} << 16;

std::string text_of(const Vec3& v) { return shortest_text(v.x) + ' ' + shortest_text(v.y) + ' ' + shortest_text(v.z); }

// Of indices, which are points of VTK's grid.
std::string extent_of(const Lattice& lattice) {
  std::string text;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t first = lattice.index_min[static_cast<std::size_t>(axis)];
    text += (axis > 0 ? " " : "") + std::to_string(first) + ' ' + std::to_string(lattice.index_max(axis));
  }
  return text;
}

// The attribute, which VTK 9 and later read; nothing where the axes are the world's.
std::string direction_of(const PlacedLattice& lattice) {
  if (lattice.along_axes()) return "";
  std::string text;
  for (const double entry : lattice.direction()) text += (text.empty() ? "" : " ") + shortest_text(entry);
  return " Direction=\"" + text + '"';
}

// VTK's name of a type that NumPy calls so.
std::string type_name(std::string_view descriptor) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kNames{
      {{"|b1", "UInt8"}, {"<i4", "Int32"}, {"<i8", "Int64"}, {"<f4", "Float32"}, {"<f8", "Float64"}}};
  return std::string(std::ranges::find(kNames, descriptor, [](const auto& name) { return name.first; })->second);
}

// An array whose bytes begin at `offset` behind the head.
std::string declaration_of(const FieldDescription& field, std::string_view descriptor, std::uint64_t offset) {
  return "        <DataArray type=\"" + type_name(descriptor) + "\" Name=\"" + field.name + '"' +
         (field.components() > 1 ? " NumberOfComponents=\"3\"" : "") + " format=\"appended\" offset=\"" +
         std::to_string(offset) + "\"/>\n";
}

// All that stands before the arrays. `first`: the field that ParaView shows.
std::string head_of(const PlacedLattice& lattice, const FieldDescription& first, const std::string& declarations) {
  const std::string extent = extent_of(lattice.grid);
  return "<?xml version=\"1.0\"?>\n"
         "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
         "  <ImageData WholeExtent=\"" +
         extent + "\" Origin=\"" + text_of(lattice.origin) + "\" Spacing=\"" + text_of(lattice.grid.spacing) + '"' +
         direction_of(lattice) + ">\n    <Piece Extent=\"" + extent + "\">\n      <PointData " +
         (first.components() > 1 ? "Vectors" : "Scalars") + "=\"" + first.name + "\">\n" + declarations +
         "      </PointData>\n    </Piece>\n  </ImageData>\n  <AppendedData encoding=\"raw\">\n   _";
}

class VtiWriter final : public LatticeWriter {
 public:
  VtiWriter(OutputFile& output, const PlacedLattice& lattice, const OutputDescription& description) : output_(output) {
    const auto samples = static_cast<std::uint64_t>(whole(lattice.grid).size());
    std::string declarations;
    std::uint64_t offset = 0;  // behind the head
    for (const FieldDescription& field : description.fields) {
      auto elements = make_array_elements(field, description.precision.value_or(Precision::kSingle), output.name());
      declarations += declaration_of(field, elements->descriptor(), offset);
      const ArraySize bytes = samples * elements->size();
      arrays_.push_back({std::move(elements), offset, bytes});
      offset += sizeof(ArraySize) + bytes;
    }
    const std::string head = head_of(lattice, description.fields.front(), declarations);
    output_.write_at(0, head.data(), head.size());
    for (Array& array : arrays_) {
      array.next += head.size();
      append(array, &array.bytes, sizeof array.bytes);
    }
    end_ = head.size() + offset;
  }

  int slab_axis() const override { return 2; }
  std::int64_t slab_alignment() const override { return 1; }

  void write(const LatticeBlock&, std::span<const FieldValues> fields) override {
    for (std::size_t f = 0; f < fields.size(); ++f) {
      std::visit([&](const auto& numbers) { append_in_pieces(arrays_[f], numbers); }, fields[f]);
    }
  }

  void finish(const FieldTotals&) override {
    constexpr std::string_view kTail = "\n  </AppendedData>\n</VTKFile>\n";
    output_.write_at(end_, kTail.data(), kTail.size());
    output_.commit();
  }

 private:
  struct Array {
    std::unique_ptr<ArrayElements> elements;
    std::uint64_t next;  // where in the file its next bytes go
    ArraySize bytes;
  };

  void append(Array& array, const void* data, std::size_t size) {
    output_.write_at(array.next, data, size);
    array.next += size;
  }

  void append_in_pieces(Array& array, const auto& numbers) {
    for (std::size_t begin = 0; begin < numbers.size(); begin += kPiece) {
      const auto piece = numbers.subspan(begin, std::min(kPiece, numbers.size() - begin));
      const std::span<const char> bytes = array.elements->in_order(piece);
      append(array, bytes.data(), bytes.size());
    }
  }

  SeekableOutput output_;
  std::vector<Array> arrays_;  // of each field
  std::uint64_t end_ = 0;      // of the last array
};

}  // namespace

std::unique_ptr<LatticeWriter> make_vti_lattice_writer(OutputFile& output, const PlacedLattice& lattice,
                                                       const OutputDescription& description) {
  check_32_bit_indices(lattice.grid, "VTK", output.name());
  return std::make_unique<VtiWriter>(output, lattice, description);
}

}  // namespace raycone
