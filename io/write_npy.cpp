// NPY, NumPy's array files, format version 1.0 (NEP 1): a text header padded to 64 bytes, then the elements.
#include <algorithm>
#include <bit>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/threads.h"
#include "io/format_writers.h"
#include "io/spool_file.h"

namespace raycone {
namespace {

static_assert(std::endian::native == std::endian::little, "elements are written as they are in memory");

template <typename Element>
constexpr const char* kDescriptor = nullptr;
template <>
constexpr const char* kDescriptor<float> = "<f4";
template <>
constexpr const char* kDescriptor<double> = "<f8";

// `shape` as Python writes a tuple. For one axis the header has the same length whatever the count.
std::string npy_header(const std::string& descriptor, const std::string& shape) {
  constexpr std::size_t kAlignment = 64;
  constexpr std::size_t kPreamble = 10;  // magic, version, length
  std::string text = "{'descr': '" + descriptor + "', 'fortran_order': False, 'shape': " + shape + ", }";
  const std::size_t total = (kPreamble + text.size() + 1 + kAlignment - 1) / kAlignment * kAlignment;
  text.append(total - kPreamble - text.size() - 1, ' ');
  text += '\n';
  const auto low = static_cast<char>(text.size() & 0xFF);
  const auto high = static_cast<char>(text.size() >> 8);
  return std::string("\x93NUMPY\x01") + '\0' + low + high + text;
}

// The elements of an x-fastest block with z fastest instead, -0 as 0.
template <typename Element>
std::vector<Element> transposed(const LatticeBlock& block, std::span<const double> values) {
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
              elements[(x * ny + y) * nz + z] = static_cast<Element>(values[(z * ny + y) * nx + x]) + Element{0};
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
  NpyLatticeWriter(OutputFile& output, const Lattice& lattice) : output_(output) {
    const std::string shape = '(' + std::to_string(lattice.counts[0]) + ", " + std::to_string(lattice.counts[1]) +
                              ", " + std::to_string(lattice.counts[2]) + ')';
    const std::string header = npy_header(kDescriptor<Element>, shape);
    output_.write(header.data(), header.size());
  }

  int slab_axis() const override { return 0; }
  std::int64_t slab_alignment() const override { return 1; }

  void write(const LatticeBlock& block, std::span<const double> values, const Diagnostics*) override {
    const std::vector<Element> elements = transposed<Element>(block, values);
    output_.write(elements.data(), elements.size() * sizeof(Element));
  }

  void finish(const FieldTotals&) override { output_.commit(); }

 private:
  OutputFile& output_;
};

// Rows of five: the value and its diagnostics.
std::vector<double> interleaved(std::span<const double> values, const Diagnostics& diagnostics) {
  std::vector<double> elements;
  elements.reserve(5 * values.size());
  for (std::size_t n = 0; n < values.size(); ++n) {
    elements.insert(elements.end(), {values[n], static_cast<double>(diagnostics.crossings[n]),
                                     static_cast<double>(diagnostics.degenerate[n]),
                                     static_cast<double>(diagnostics.on_surface[n]), diagnostics.error_bound[n]});
  }
  return elements;
}

// Elements follow the header at once where the count is known or can be filled in later; else they wait in a spool.
class NpyPointWriter final : public PointWriter {
 public:
  NpyPointWriter(OutputFile& output, std::optional<std::uint64_t> size, bool diagnostics)
      : output_(output), announced_(size), shape_end_(diagnostics ? ", 5)" : ",)") {
    if (announced_ || output_.seekable()) {
      write_header(announced_.value_or(0));
    } else {
      spool_.emplace(output_.name());
    }
  }

  void write(std::span<const Vec3>, std::span<const double> values, const Diagnostics* diagnostics) override {
    count_ += values.size();
    if (diagnostics) {
      append(interleaved(values, *diagnostics));
    } else {
      append(values);
    }
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
                                                       const FieldDescription& description) {
  if (description.double_precision) return std::make_unique<NpyLatticeWriter<double>>(output, lattice);
  return std::make_unique<NpyLatticeWriter<float>>(output, lattice);
}

std::unique_ptr<PointWriter> make_npy_point_writer(OutputFile& output, std::optional<std::uint64_t> size,
                                                   bool diagnostics) {
  return std::make_unique<NpyPointWriter>(output, size, diagnostics);
}

}  // namespace raycone
