// NPY, NumPy's array files, format version 1.0 (NEP 1): a text header padded to 64 bytes, then the elements.
#include <algorithm>
#include <bit>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "core/threads.h"
#include "io/format_writers.h"
#include "io/interleaved.h"
#include "io/narrowing.h"
#include "io/npy_header.h"
#include "io/spool_file.h"
#include "io/write_npy.h"

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

// The elements of an x-fastest block with z fastest instead, -0 as 0.
template <typename Element, typename Number>
std::vector<Element> transposed(const LatticeBlock& block, std::span<const Number> values) {
  constexpr std::size_t kTile = 16;  // a tile's cache lines on both sides fit in the first-level cache
  const auto nx = static_cast<std::size_t>(block.counts[0]);
  const auto ny = static_cast<std::size_t>(block.counts[1]);
  const auto nz = static_cast<std::size_t>(block.counts[2]);
  std::vector<Element> elements(values.size());
  parallel_for(ny, 1, [&](std::size_t y_begin, std::size_t y_end) {
    for (std::size_t y = y_begin; y < y_end; ++y) {
      for (std::size_t z_tile = 0; z_tile < nz; z_tile += kTile) {
        const std::size_t z_end = std::min(z_tile + kTile, nz);
        for (std::size_t x_tile = 0; x_tile < nx; x_tile += kTile) {
          const std::size_t x_end = std::min(x_tile + kTile, nx);
          for (std::size_t x = x_tile; x < x_end; ++x) {
            for (std::size_t z = z_tile; z < z_end; ++z) {
              const auto element = static_cast<Element>(values[(z * ny + y) * nx + x]);
              elements[(x * ny + y) * nz + z] = static_cast<Element>(element + Element{0});
            }
          }
        }
      }
    }
  });
  return elements;
}

template <typename Element>
class NpyLatticeWriter final : public LatticeWriter {
 public:
  NpyLatticeWriter(OutputFile& output, const Lattice& lattice, const FieldDescription& field)
      : output_(output), narrowing_(field) {
    const std::string shape = '(' + std::to_string(lattice.counts[0]) + ", " + std::to_string(lattice.counts[1]) +
                              ", " + std::to_string(lattice.counts[2]) + ')';
    const std::string header = npy_header(kDescriptor<Element>, shape);
    output_.write(header.data(), header.size());
  }

  int slab_axis() const override { return 0; }
  std::int64_t slab_alignment() const override { return 1; }

  void write(const LatticeBlock& block, std::span<const FieldValues> fields) override {
    const auto* const reals = std::get_if<std::span<const double>>(&fields.front());
    const std::vector<Element> elements =
        std::is_same_v<Element, float> && reals
            ? transposed<Element>(block, std::span<const float>(narrowed(narrowing_, *reals)))
            : std::visit([&](const auto& values) { return transposed<Element>(block, values); }, fields.front());
    output_.write(elements.data(), elements.size() * sizeof(Element));
  }

  void finish(const FieldTotals&) override { output_.commit(); }

 private:
  OutputFile& output_;
  Narrowing narrowing_;
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
