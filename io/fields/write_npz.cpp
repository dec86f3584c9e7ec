// NPZ, NumPy's archives of arrays: a ZIP with an NPY file per array, as numpy.savez writes it.
#include <array>
#include <bit>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "io/fields/array_elements.h"
#include "io/fields/flag_bits.h"
#include "io/fields/format_writers.h"
#include "io/fields/lattice_array.h"
#include "io/files/npy_head.h"
#include "io/files/spool_file.h"
#include "io/files/zip_writer.h"

namespace raycone {
namespace {

static_assert(std::endian::native == std::endian::little, "elements are written as they are in memory");
static_assert(sizeof(Vec3) == 3 * sizeof(double) && std::is_standard_layout_v<Vec3>, "points are rows of an array");

// An array in the making: where it is small, with all its bytes.
struct NpzArray {
  std::string name;
  std::string head;
  std::uint64_t size;      // bytes behind the head
  std::string bytes = {};  // empty where they come later

  [[nodiscard]] ZipMember member() const { return {name + ".npy", head.size() + size}; }
};

template <typename Number, std::size_t kCount>
NpzArray small_array(const std::string& name, const char* descriptor, const std::string& shape,
                     const std::array<Number, kCount>& numbers) {
  return {name, npy_head(descriptor, shape), sizeof numbers,
          std::string(reinterpret_cast<const char*>(numbers.data()), sizeof numbers)};
}

NpzArray small_array(const std::string& name, const Vec3& v) {
  return small_array(name, "<f8", "(3,)", std::array{v.x, v.y, v.z});
}

bool is_packed(const FieldDescription& field, const OutputDescription& description) {
  return description.packs_flags && field.name == "inside";
}

std::string array_name(const FieldDescription& field) {
  return field.kind == FieldKind::kVector ? field.name : field.column;
}

// The flags of a field, a bit each.
NpzArray packed_array(const FieldDescription& field, std::uint64_t samples) {
  const std::uint64_t bytes = (samples + 7) / 8;
  return {field.column, npy_head("|u1", '(' + std::to_string(bytes) + ",)"), bytes};
}

// What all archives end with.
std::vector<NpzArray> arrays_about(const OutputDescription& description) {
  std::vector<NpzArray> arrays{small_array("transform", "<f8", "(4, 4)", description.transform)};
  if (!description.metadata.empty()) {
    const std::string& text = description.metadata;
    arrays.push_back({"raycone", npy_head("|S" + std::to_string(text.size()), "()"), text.size(), text});
  }
  return arrays;
}

std::vector<ZipMember> members_of(const std::vector<NpzArray>& arrays) {
  std::vector<ZipMember> members;
  for (const NpzArray& array : arrays) members.push_back(array.member());
  return members;
}

// Headers, and the arrays that are known already.
void start_archive(ZipWriter& zip, const std::vector<NpzArray>& arrays) {
  for (std::size_t n = 0; n < arrays.size(); ++n) {
    zip.append(n, arrays[n].head.data(), arrays[n].head.size());
    zip.append(n, arrays[n].bytes.data(), arrays[n].bytes.size());
  }
}

void append(std::vector<NpzArray>& arrays, std::vector<NpzArray> more) {
  for (NpzArray& array : more) arrays.push_back(std::move(array));
}

// --- Lattices -------------------------------------------------------------------------------------------------------

// The lattice's arrays, behind those of the fields.
std::vector<NpzArray> arrays_of(const PlacedLattice& lattice, bool packed) {
  std::vector<NpzArray> arrays;
  if (packed) arrays.push_back(small_array("inside_shape", "<i8", "(3,)", lattice.grid.counts));
  arrays.push_back(small_array("origin", lattice.origin));
  arrays.push_back(small_array("spacing", lattice.grid.spacing));
  arrays.push_back(small_array("index_min", "<i8", "(3,)", lattice.grid.index_min));
  arrays.push_back(small_array("direction", "<f8", "(3, 3)", lattice.direction()));
  return arrays;
}

class NpzLatticeWriter final : public LatticeWriter {
 public:
  NpzLatticeWriter(OutputFile& output, const PlacedLattice& lattice, const OutputDescription& description)
      : slab_axis_(array_slab_axis(lattice.grid, output)) {
    const Precision precision = description.precision.value_or(Precision::kSingle);
    const auto samples = static_cast<std::uint64_t>(whole(lattice.grid).size());
    bool packed = false;
    for (const FieldDescription& field : description.fields) {
      Column& column = columns_.emplace_back();
      if (is_packed(field, description)) {
        packed = true;
        column.bits.emplace(lattice.grid);
        arrays_.push_back(packed_array(field, samples));
        continue;
      }
      auto elements = make_array_elements(field, precision, output.name());
      const std::string head = npy_head(elements->descriptor(), shape_of(lattice.grid, field.components()));
      arrays_.push_back({array_name(field), head, samples * elements->size()});
      column.array.emplace(lattice.grid, std::move(elements));
    }
    append(arrays_, arrays_of(lattice, packed));
    append(arrays_, arrays_about(description));
    zip_.emplace(output, members_of(arrays_));
    start_archive(*zip_, arrays_);
  }

  int slab_axis() const override { return slab_axis_; }
  std::int64_t slab_alignment() const override { return 1; }

  void write(const LatticeBlock& block, std::span<const FieldValues> fields) override {
    for (std::size_t f = 0; f < fields.size(); ++f) {
      if (columns_[f].bits) {
        columns_[f].bits->add(block, std::get<std::span<const std::uint8_t>>(fields[f]));
        continue;
      }
      const std::size_t head = arrays_[f].head.size();
      columns_[f].array->write_slab(block, fields[f], [&](std::uint64_t offset, const char* data, std::size_t size) {
        zip_->write_at(f, head + offset, data, size);
      });
    }
  }

  void finish(const FieldTotals&) override {
    for (std::size_t f = 0; f < columns_.size(); ++f) {
      if (columns_[f].bits) zip_->append(f, columns_[f].bits->bytes().data(), columns_[f].bits->bytes().size());
    }
    zip_->finish();
  }

 private:
  // Of a field: either of the two.
  struct Column {
    std::optional<LatticeArray> array{};
    std::optional<LatticeBits> bits{};
  };

  int slab_axis_;
  std::vector<NpzArray> arrays_;
  std::vector<Column> columns_;
  std::optional<ZipWriter> zip_;
};

// --- Points ---------------------------------------------------------------------------------------------------------

// Points, then each field, then normals and faces. Where the number of points is not known, they wait in spools.
class NpzPointWriter final : public PointWriter {
 public:
  NpzPointWriter(OutputFile& output, std::optional<std::uint64_t> size, OutputDescription description)
      : output_(output), description_(std::move(description)), bits_(description_.fields.size()) {
    const Precision precision = description_.precision.value_or(Precision::kDouble);
    for (const FieldDescription& field : description_.fields) {
      columns_.push_back(make_array_elements(field, precision, output.name()));
    }
    if (size) {
      open_archive(*size);
      return;
    }
    const std::size_t arrays = 1 + columns_.size() + (description_.has_places ? 2 : 0);
    for (std::size_t n = 0; n < arrays; ++n) spools_.push_back(std::make_unique<SpoolFile>(output.name()));
  }

  void write(std::span<const Vec3> points, std::span<const FieldValues> fields) override {
    count_ += points.size();
    append_vectors(0, points);
    for (std::size_t f = 0; f < fields.size(); ++f) {
      if (is_packed(description_.fields[f], description_)) {
        append_bytes(f + 1, bits_[f].append(std::get<std::span<const std::uint8_t>>(fields[f])));
      } else {
        append_bytes(f + 1, columns_[f]->in_order(fields[f]));
      }
    }
  }

  void write_places(std::span<const Vec3> normals, std::span<const std::int64_t> faces) override {
    append_vectors(columns_.size() + 1, normals);
    append_bytes(columns_.size() + 2, faces);
  }

  void flush() override {}  // an archive is complete or nothing

  void finish() override {
    for (std::size_t f = 0; f < columns_.size(); ++f) append_bytes(f + 1, bits_[f].rest());
    if (!zip_) {
      open_archive(count_);
      for (std::size_t n = 0; n < spools_.size(); ++n) {
        spools_[n]->read_back([&](const char* data, std::size_t size) { zip_->append(n, data, size); });
      }
    }
    zip_->finish();
  }

 private:
  void open_archive(std::uint64_t size) {
    std::vector<NpzArray> arrays{array_of_vectors("points", size)}, shapes;
    for (std::size_t f = 0; f < columns_.size(); ++f) {
      const FieldDescription& field = description_.fields[f];
      if (is_packed(field, description_)) {
        arrays.push_back(packed_array(field, size));
        shapes.push_back(small_array("inside_shape", "<i8", "(1,)", std::array{static_cast<std::int64_t>(size)}));
      } else {
        arrays.push_back(array_of(field, *columns_[f], size));
      }
    }
    if (description_.has_places) {
      arrays.push_back(array_of_vectors("normals", size));
      arrays.push_back({"faces", npy_head("<i8", '(' + std::to_string(size) + ",)"), sizeof(std::int64_t) * size});
    }
    append(arrays, std::move(shapes));
    append(arrays, arrays_about(description_));
    zip_.emplace(output_, members_of(arrays));
    start_archive(*zip_, arrays);
  }

  static NpzArray array_of(const FieldDescription& field, const ArrayElements& elements, std::uint64_t size) {
    const std::string shape = '(' + std::to_string(size) + (field.components() > 1 ? ", 3)" : ",)");
    return {array_name(field), npy_head(elements.descriptor(), shape), elements.size() * size};
  }

  [[nodiscard]] NpzArray array_of_vectors(const std::string& name, std::uint64_t size) const {
    const std::size_t coordinate = description_.single_points ? sizeof(float) : sizeof(double);
    const std::string shape = '(' + std::to_string(size) + ", 3)";
    return {name, npy_head(description_.single_points ? "<f4" : "<f8", shape), 3 * coordinate * size};
  }

  void append_vectors(std::size_t array, std::span<const Vec3> vectors) {
    if (!description_.single_points) return append_bytes(array, vectors);
    std::vector<float> coordinates;
    coordinates.reserve(3 * vectors.size());
    for (const Vec3& vector : vectors) {
      for (int axis = 0; axis < 3; ++axis) coordinates.push_back(static_cast<float>(vector[axis]));
    }
    append_bytes(array, std::span<const float>(coordinates));
  }

  template <typename Element>
  void append_bytes(std::size_t array, std::span<const Element> elements) {
    if (zip_) return zip_->append(array, elements.data(), elements.size_bytes());
    spools_[array]->stream().write(reinterpret_cast<const char*>(elements.data()),
                                   static_cast<std::streamsize>(elements.size_bytes()));
  }

  OutputFile& output_;
  OutputDescription description_;
  std::vector<std::unique_ptr<ArrayElements>> columns_;  // of each field
  std::vector<FlagBits> bits_;                           // likewise; used where the field is packed
  std::vector<std::unique_ptr<SpoolFile>> spools_;
  std::optional<ZipWriter> zip_;
  std::uint64_t count_ = 0;
};

}  // namespace

std::unique_ptr<LatticeWriter> make_npz_lattice_writer(OutputFile& output, const PlacedLattice& lattice,
                                                       const OutputDescription& description) {
  return std::make_unique<NpzLatticeWriter>(output, lattice, description);
}

std::unique_ptr<PointWriter> make_npz_point_writer(OutputFile& output, std::optional<std::uint64_t> size,
                                                   const OutputDescription& description) {
  return std::make_unique<NpzPointWriter>(output, size, description);
}

}  // namespace raycone
