// NPY, NumPy's array files, format version 1.0 (NEP 1): a text header padded to 64 bytes, then the elements.
#include <algorithm>
#include <bit>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "core/machine/threads.h"
#include "io/fields/format_writers.h"
#include "io/fields/interleaved.h"
#include "io/fields/narrowing.h"
#include "io/fields/npy_header.h"
#include "io/fields/write_npy.h"
#include "io/files/spool_file.h"

namespace raycone {
namespace {

static_assert(std::endian::native == std::endian::little, "elements are written as they are in memory");

template <typename Element>
constexpr const char* kDescriptor = nullptr;
template <>
constexpr const char* kDescriptor<float> = "<f4";
template <>
constexpr const char* kDescriptor<double> = "<f8";
template <>
constexpr const char* kDescriptor<std::uint8_t> = "|b1";  // flags: NumPy's bool is a byte

template <typename Element, typename Number>
Element stored(const Narrowing& narrowing, Number value) {
  if constexpr (std::is_same_v<Element, float> && std::is_same_v<Number, double>) return narrowing(value);
  return static_cast<Element>(value);
}

// The elements of the samples [x_begin, x_end) along x of an x-fastest block with z fastest instead, -0 as 0.
template <typename Element, typename Number>
void transpose(const Narrowing& narrowing, const LatticeBlock& block, std::span<const Number> values,
               std::size_t x_begin, std::size_t x_end, std::vector<Element>& elements) {
  constexpr std::size_t kTile = 16;  // a tile's cache lines on both sides fit in the first-level cache
  const auto nx = static_cast<std::size_t>(block.counts[0]);
  const auto ny = static_cast<std::size_t>(block.counts[1]);
  const auto nz = static_cast<std::size_t>(block.counts[2]);
  elements.resize((x_end - x_begin) * ny * nz);
  parallel_for(ny, 1, [&](std::size_t y_begin, std::size_t y_end) {
    for (std::size_t y = y_begin; y < y_end; ++y) {
      for (std::size_t z_tile = 0; z_tile < nz; z_tile += kTile) {
        const std::size_t z_end = std::min(z_tile + kTile, nz);
        for (std::size_t x_tile = x_begin; x_tile < x_end; x_tile += kTile) {
          for (std::size_t x = x_tile; x < std::min(x_tile + kTile, x_end); ++x) {
            for (std::size_t z = z_tile; z < z_end; ++z) {
              const auto element = stored<Element>(narrowing, values[(z * ny + y) * nx + x]);
              elements[((x - x_begin) * ny + y) * nz + z] = static_cast<Element>(element + Element{0});
            }
          }
        }
      }
    }
  });
}

// Slabs across the slowest axis, x, can be appended, but cut all rays, and each slab has to look for crossings again.
// Slabs across y are pieces of planes across x: long ones, as z is the fastest axis.
int npy_slab_axis(const Lattice& lattice, bool seekable) {
  constexpr std::int64_t kSmallPlane = std::int64_t{1} << 16;  // slabs across x then hold rows that are long enough
  constexpr std::int64_t kLargePlane = std::int64_t{1} << 22;  // takes more memory than any slab has to
  const auto [nx, ny, nz] = lattice.counts;
  const std::int64_t across_x = ny * nz, across_y = nx * nz;
  return seekable && across_x > kSmallPlane && across_y <= std::max(kLargePlane, across_x) ? 1 : 0;
}

template <typename Element>
class NpyLatticeWriter final : public LatticeWriter {
 public:
  NpyLatticeWriter(OutputFile& output, const Lattice& lattice, const FieldDescription& field)
      : output_(output), lattice_(lattice), narrowing_(field), slab_axis_(npy_slab_axis(lattice, output.seekable())) {
    const std::string shape = '(' + std::to_string(lattice.counts[0]) + ", " + std::to_string(lattice.counts[1]) +
                              ", " + std::to_string(lattice.counts[2]) + ')';
    const std::string header = npy_header(kDescriptor<Element>, shape);
    output_.write(header.data(), header.size());
    header_size_ = header.size();
  }

  int slab_axis() const override { return slab_axis_; }
  std::int64_t slab_alignment() const override { return 1; }

  void write(const LatticeBlock& block, std::span<const FieldValues> fields) override {
    std::visit([&](const auto& values) { write_planes(block, values); }, fields.front());
  }

  void finish(const FieldTotals&) override { output_.commit(); }

 private:
  // A few planes across x at a time.
  template <typename Number>
  void write_planes(const LatticeBlock& block, std::span<const Number> values) {
    constexpr std::size_t kElements = std::size_t{1} << 18, kLeastPlanes = 16;
    const auto nx = static_cast<std::size_t>(block.counts[0]);
    const std::size_t plane = values.size() / nx;
    const std::size_t planes = std::max(kElements / plane, kLeastPlanes);
    for (std::size_t begin = 0; begin < nx; begin += planes) {
      const std::size_t end = std::min(begin + planes, nx);
      transpose<Element>(narrowing_, block, values, begin, end, elements_);
      write_elements(block, begin, end, plane);
    }
  }

  void write_elements(const LatticeBlock& block, std::size_t begin, std::size_t end, std::size_t plane) {
    if (block.counts[1] == lattice_.counts[1]) {
      output_.write(elements_.data(), elements_.size() * sizeof(Element));
      return;
    }
    const auto of_lattice = static_cast<std::size_t>(lattice_.counts[1] * lattice_.counts[2]);
    const auto before = static_cast<std::size_t>((block.first[1] - lattice_.index_min[1]) * lattice_.counts[2]);
    for (std::size_t x = begin; x < end; ++x) {
      output_.seek(header_size_ + (x * of_lattice + before) * sizeof(Element));
      output_.write(&elements_[(x - begin) * plane], plane * sizeof(Element));
    }
  }

  OutputFile& output_;
  Lattice lattice_;
  Narrowing narrowing_;
  int slab_axis_;
  std::size_t header_size_ = 0;
  std::vector<Element> elements_;
};

// Elements follow the header at once where the count is known or can be filled in later; else they wait in a spool.
class NpyPointWriter final : public PointWriter {
 public:
  NpyPointWriter(OutputFile& output, std::optional<std::uint64_t> size, std::size_t fields)
      : output_(output), announced_(size), shape_end_(fields > 1 ? ", " + std::to_string(fields) + ")" : ",)") {
    if (announced_ || output_.seekable()) {
      write_header(announced_.value_or(0));
    } else {
      spool_.emplace(output_.name());
    }
  }

  void write(std::span<const Vec3> points, std::span<const FieldValues> fields) override {
    count_ += points.size();
    const auto* const reals = std::get_if<std::span<const double>>(&fields.front());
    if (fields.size() == 1 && reals) return append(*reals);
    append(interleaved<double>(fields, points.size()));
  }

  void flush() override { output_.flush(); }

  void finish() override {
    if (announced_ && *announced_ != count_) throw std::logic_error("as many values as announced must be written");
    if (spool_) {
      write_header(count_);
      spool_->copy_to(output_);
    } else if (!announced_) {
      const std::string header = header_of(count_);
      output_.overwrite(0, header.data(), header.size());
    }
    output_.commit();
  }

 private:
  void append(std::span<const double> elements) {
    if (spool_) {
      spool_->stream().write(reinterpret_cast<const char*>(elements.data()),
                             static_cast<std::streamsize>(elements.size_bytes()));
    } else {
      output_.write(elements.data(), elements.size_bytes());
    }
  }
  [[nodiscard]] std::string header_of(std::uint64_t count) const {
    return npy_header(kDescriptor<double>, '(' + std::to_string(count) + shape_end_);
  }
  void write_header(std::uint64_t count) {
    const std::string header = header_of(count);
    output_.write(header.data(), header.size());
  }

  OutputFile& output_;
  std::optional<std::uint64_t> announced_;
  std::string shape_end_;  // of the tuple, behind the count
  std::optional<SpoolFile> spool_;
  std::uint64_t count_ = 0;
};

}  // namespace

std::unique_ptr<LatticeWriter> make_npy_lattice_writer(OutputFile& output, const Lattice& lattice,
                                                       const OutputDescription& description) {
  if (description.fields.size() != 1) throw std::logic_error("NPY holds one field of a lattice");
  const FieldDescription& field = description.fields.front();
  if (field.kind == FieldKind::kFlag) return std::make_unique<NpyLatticeWriter<std::uint8_t>>(output, lattice, field);
  if (description.double_precision) return std::make_unique<NpyLatticeWriter<double>>(output, lattice, field);
  return std::make_unique<NpyLatticeWriter<float>>(output, lattice, field);
}

void write_npy_rows(OutputFile& output, std::int64_t rows, std::int64_t columns, std::span<const double> values) {
  const std::string shape = '(' + std::to_string(rows) + ", " + std::to_string(columns) + ')';
  const std::string header = npy_header(kDescriptor<double>, shape);
  output.write(header.data(), header.size());
  output.write(values.data(), values.size_bytes());
  output.commit();
}

std::unique_ptr<PointWriter> make_npy_point_writer(OutputFile& output, std::optional<std::uint64_t> size,
                                                   const OutputDescription& description) {
  return std::make_unique<NpyPointWriter>(output, size, description.fields.size());
}

}  // namespace raycone
