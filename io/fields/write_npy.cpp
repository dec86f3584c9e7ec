// NPY, NumPy's array files, format version 1.0 (NEP 1): a text head padded to 64 bytes, then the elements.
#include <cstddef>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "io/fields/array_elements.h"
#include "io/fields/format_writers.h"
#include "io/fields/lattice_array.h"
#include "io/fields/write_npy.h"
#include "io/files/npy_head.h"
#include "io/files/spool_file.h"

namespace raycone {
namespace {

class NpyLatticeWriter final : public LatticeWriter {
 public:
  NpyLatticeWriter(OutputFile& output, const Lattice& lattice, const OutputDescription& description)
      : output_(output), slab_axis_(array_slab_axis(lattice, output)) {
    auto elements = make_array_elements(description.fields.front(), description.precision.value_or(Precision::kSingle),
                                        output.name());
    const std::string head =
        npy_head(elements->descriptor(), shape_of(lattice, description.fields.front().components()));
    output_.write(head.data(), head.size());
    head_size_ = head.size();
    array_.emplace(lattice, std::move(elements));
  }

  int slab_axis() const override { return slab_axis_; }
  std::int64_t slab_alignment() const override { return 1; }

  void write(const LatticeBlock& block, std::span<const FieldValues> fields) override {
    array_->write_slab(block, fields.front(), [this](std::uint64_t offset, const char* data, std::size_t size) {
      output_.seek(head_size_ + offset);
      output_.write(data, size);
    });
  }

  void finish(const FieldTotals&) override { output_.commit(); }

 private:
  OutputFile& output_;
  int slab_axis_;
  std::uint64_t head_size_ = 0;
  std::optional<LatticeArray> array_;
};

// Elements follow the head at once where the count is known or can be filled in later; else they wait in a spool.
class NpyPointWriter final : public PointWriter {
 public:
  NpyPointWriter(OutputFile& output, std::optional<std::uint64_t> size, const OutputDescription& description)
      : output_(output),
        announced_(size),
        shape_end_(description.components() > 1 ? ", " + std::to_string(description.components()) + ")" : ",)") {
    const Precision precision = description.precision.value_or(Precision::kDouble);
    for (FieldDescription field : description.fields) {
      // Columns are of one type, whatever they hold; labels alone are integers.
      const bool has_own_type =
          field.kind == FieldKind::kDistance || field.kind == FieldKind::kVector || description.has_labels_alone();
      if (!has_own_type) field.kind = FieldKind::kReal;
      columns_.push_back(make_array_elements(field, precision, output.name()));
    }
    if (announced_ || output_.seekable()) {
      write_head(announced_.value_or(0));
    } else {
      spool_.emplace(output_.name());
    }
  }

  void write(std::span<const Vec3> points, std::span<const FieldValues> fields) override {
    count_ += points.size();
    std::vector<std::span<const char>> columns;
    std::vector<std::vector<double>> numbers(fields.size());
    for (std::size_t f = 0; f < fields.size(); ++f) {
      columns.push_back(columns_[f]->in_order(as_reals(fields[f], numbers[f])));
    }
    if (columns.size() == 1) return append(columns.front());
    append(rows_of(columns, points.size()));
  }

  void flush() override { output_.flush(); }

  void finish() override {
    if (announced_ && *announced_ != count_) throw std::logic_error("as many values as announced must be written");
    if (spool_) {
      write_head(count_);
      spool_->copy_to(output_);
    } else if (!announced_) {
      const std::string head = head_of(count_);
      output_.overwrite(0, head.data(), head.size());
    }
    output_.commit();
  }

 private:
  [[nodiscard]] FieldValues as_reals(const FieldValues& values, std::vector<double>& numbers) const {
    if (const auto* const labels = std::get_if<std::span<const std::int32_t>>(&values)) {
      if (columns_.size() == 1) return values;
      numbers.assign(labels->begin(), labels->end());
    } else if (const auto* const counts = std::get_if<std::span<const std::int64_t>>(&values)) {
      for (const std::int64_t count : *counts) numbers.push_back(static_cast<double>(count));
    } else if (const auto* const flags = std::get_if<std::span<const std::uint8_t>>(&values)) {
      numbers.assign(flags->begin(), flags->end());
    } else {
      return values;
    }
    return std::span<const double>(numbers);
  }

  static std::vector<char> rows_of(const std::vector<std::span<const char>>& columns, std::size_t count) {
    std::size_t all = 0;
    for (const std::span<const char>& column : columns) all += column.size();
    if (count == 0) return {};
    std::vector<char> rows(all);
    std::size_t before = 0;  // bytes of a row
    for (const std::span<const char>& column : columns) {
      const std::size_t size = column.size() / count;
      for (std::size_t n = 0; n < count; ++n) std::memcpy(&rows[n * (all / count) + before], &column[n * size], size);
      before += size;
    }
    return rows;
  }

  void append(std::span<const char> elements) {
    if (spool_) {
      spool_->stream().write(elements.data(), static_cast<std::streamsize>(elements.size()));
    } else {
      output_.write(elements.data(), elements.size());
    }
  }
  [[nodiscard]] std::string head_of(std::uint64_t count) const {
    return npy_head(columns_.front()->descriptor(), '(' + std::to_string(count) + shape_end_);
  }
  void write_head(std::uint64_t count) {
    const std::string head = head_of(count);
    output_.write(head.data(), head.size());
  }

  OutputFile& output_;
  std::optional<std::uint64_t> announced_;
  std::string shape_end_;  // of the tuple, behind the count
  std::vector<std::unique_ptr<ArrayElements>> columns_;
  std::optional<SpoolFile> spool_;
  std::uint64_t count_ = 0;
};

}  // namespace

std::unique_ptr<LatticeWriter> make_npy_lattice_writer(OutputFile& output, const PlacedLattice& lattice,
                                                       const OutputDescription& description) {
  if (description.fields.size() != 1) throw std::logic_error("NPY holds one field of a lattice");
  return std::make_unique<NpyLatticeWriter>(output, lattice.grid, description);
}

void write_npy_rows(OutputFile& output, std::int64_t rows, std::int64_t columns, std::span<const double> values) {
  const std::string shape = '(' + std::to_string(rows) + ", " + std::to_string(columns) + ')';
  const std::string head = npy_head("<f8", shape);
  output.write(head.data(), head.size());
  output.write(values.data(), values.size_bytes());
  output.commit();
}

std::unique_ptr<PointWriter> make_npy_point_writer(OutputFile& output, std::optional<std::uint64_t> size,
                                                   const OutputDescription& description) {
  return std::make_unique<NpyPointWriter>(output, size, description);
}

}  // namespace raycone
