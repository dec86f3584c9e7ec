// NPZ, NumPy's archives of arrays: a ZIP with an NPY file per array, as numpy.savez writes it.
#include <bit>
#include <cstddef>
#include <string>
#include <type_traits>
#include <vector>

#include "io/fields/format_writers.h"
#include "io/fields/npy_header.h"
#include "io/files/zip_writer.h"

namespace raycone {
namespace {

static_assert(std::endian::native == std::endian::little, "elements are written as they are in memory");
static_assert(sizeof(Vec3) == 3 * sizeof(double) && std::is_standard_layout_v<Vec3>, "points are rows of an array");

struct Array {
  std::string name;
  std::string header;
  std::size_t row_size;  // bytes per point
};

Array array_of(const FieldDescription& field, std::uint64_t size) {
  const std::string shape = '(' + std::to_string(size) + ",)";
  switch (field.kind) {
    case FieldKind::kFlag:
      return {field.column, npy_header("|b1", shape), 1};
    case FieldKind::kCount:
      return {field.column, npy_header("<i8", shape), 8};
    case FieldKind::kReal:
    case FieldKind::kDensity:
    case FieldKind::kDistance:
    case FieldKind::kBound:
      break;
  }
  return {field.column, npy_header("<f8", shape), 8};
}

// The points, then the fields.
std::vector<Array> arrays_of(const OutputDescription& description, std::uint64_t size) {
  std::vector<Array> arrays{{"points", npy_header("<f8", '(' + std::to_string(size) + ", 3)"), sizeof(Vec3)}};
  for (const FieldDescription& field : description.fields) arrays.push_back(array_of(field, size));
  return arrays;
}

std::vector<ZipMember> members_of(const std::vector<Array>& arrays, std::uint64_t size) {
  std::vector<ZipMember> members;
  for (const Array& array : arrays) {
    members.push_back({array.name + ".npy", array.header.size() + array.row_size * size});
  }
  return members;
}

class NpzPointWriter final : public PointWriter {
 public:
  NpzPointWriter(OutputFile& output, const std::vector<Array>& arrays, std::uint64_t size)
      : zip_(output, members_of(arrays, size)) {
    for (std::size_t n = 0; n < arrays.size(); ++n) zip_.append(n, arrays[n].header.data(), arrays[n].header.size());
  }

  void write(std::span<const Vec3> points, std::span<const FieldValues> fields) override {
    zip_.append(0, points.data(), points.size_bytes());
    for (std::size_t f = 0; f < fields.size(); ++f) {
      std::visit([&](const auto& numbers) { zip_.append(f + 1, numbers.data(), numbers.size_bytes()); }, fields[f]);
    }
  }
  void flush() override {}  // an archive is complete or nothing
  void finish() override { zip_.finish(); }

 private:
  ZipWriter zip_;
};

}  // namespace

std::unique_ptr<PointWriter> make_npz_point_writer(OutputFile& output, std::uint64_t size,
                                                   const OutputDescription& description) {
  return std::make_unique<NpzPointWriter>(output, arrays_of(description, size), size);
}

}  // namespace raycone
