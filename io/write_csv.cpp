// CSV: a header line, then one row per sample; numbers as the shortest text that reads back as the same double.
#include <array>
#include <charconv>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "io/format_writers.h"

namespace raycone {
namespace {

// The longest double is -2.2250738585072014e-308, the longest integer -9223372036854775808.
constexpr std::size_t kMaxNumber = 24;
constexpr std::size_t kMaxRow = 11 * (kMaxNumber + 1);

constexpr std::string_view kDiagnosticColumns = ",crossings,degenerate,on_surface,error_bound";

// The last columns of the header: the value's, and those of the diagnostics where wanted.
std::string value_columns(const std::string& value, bool diagnostics) {
  return value + std::string(diagnostics ? kDiagnosticColumns : "") + '\n';
}

// Prints at `at`, where there is room for kMaxNumber characters, and returns the end. -0 prints as 0.
template <typename Number>
char* print(char* at, Number value) {
  if (value == 0) value = 0;
  return std::to_chars(at, at + kMaxNumber, value).ptr;
}

// "first,second," or "first,": the part of a row that many rows share.
template <typename... Numbers>
std::string joined(Numbers... numbers) {
  std::array<char, kMaxRow> text;
  char* end = text.data();
  const auto append = [&end](auto number) {
    end = print(end, number);
    *end++ = ',';
  };
  (append(numbers), ...);
  return {text.data(), end};
}

// Collects rows and hands them to the file in large pieces. begin_row() makes room for one row.
class RowBuffer {
 public:
  explicit RowBuffer(OutputFile& output) : output_(output) {}

  void begin_row() {
    if (end_ + kMaxRow > bytes_.data() + bytes_.size()) hand_over();
  }
  void append(std::string_view text) {
    std::memcpy(end_, text.data(), text.size());
    end_ += text.size();
  }
  void append(char c) { *end_++ = c; }
  void append(double value) { end_ = print(end_, value); }
  // Sample n's columns of diagnostics, each with a comma before it.
  void append(const Diagnostics& diagnostics, std::size_t n) {
    for (const std::int64_t number :
         {diagnostics.crossings[n], diagnostics.degenerate[n], std::int64_t{diagnostics.on_surface[n]}}) {
      *end_++ = ',';
      end_ = print(end_, number);
    }
    *end_++ = ',';
    end_ = print(end_, diagnostics.error_bound[n]);
  }
  void hand_over() {
    output_.write(bytes_.data(), static_cast<std::size_t>(end_ - bytes_.data()));
    end_ = bytes_.data();
  }

 private:
  OutputFile& output_;
  std::array<char, 65536> bytes_;
  char* end_ = bytes_.data();
};

class CsvLatticeWriter final : public LatticeWriter {
 public:
  // `columns`: the header behind the sample's indices and coordinates.
  CsvLatticeWriter(OutputFile& output, const Lattice& lattice, const std::string& columns)
      : output_(output), lattice_(lattice), rows_(output) {
    const std::string header = "i,j,k,x,y,z," + columns;
    output_.write(header.data(), header.size());
    // The texts of one axis are the same in every row; printing them once makes rows three times as fast.
    for (std::int64_t n = 0; n < lattice.counts[0]; ++n) {
      const std::int64_t i = lattice.index_min[0] + n;
      i_texts_.push_back(joined(i));
      x_texts_.push_back(joined(lattice.coordinate(0, i)));
    }
  }

  int slab_axis() const override { return 2; }
  std::int64_t slab_alignment() const override { return 1; }

  void write(const LatticeBlock& block, std::span<const double> values, const Diagnostics* diagnostics) override {
    std::size_t row = 0;
    for (std::int64_t k = block.first[2]; k < block.first[2] + block.counts[2]; ++k) {
      for (std::int64_t j = block.first[1]; j < block.first[1] + block.counts[1]; ++j) {
        write_row(j, k, row, values, diagnostics);
        row += i_texts_.size();
      }
    }
    rows_.hand_over();
  }

  void finish(const FieldTotals&) override { output_.commit(); }

 private:
  // The samples of `values` from `begin` on.
  void write_row(std::int64_t j, std::int64_t k, std::size_t begin, std::span<const double> values,
                 const Diagnostics* diagnostics) {
    const std::string jk = joined(j, k);
    const std::string yz = joined(lattice_.coordinate(1, j), lattice_.coordinate(2, k));
    for (std::size_t n = 0; n < i_texts_.size(); ++n) {
      rows_.begin_row();
      rows_.append(i_texts_[n]);
      rows_.append(jk);
      rows_.append(x_texts_[n]);
      rows_.append(yz);
      rows_.append(values[begin + n]);
      if (diagnostics) rows_.append(*diagnostics, begin + n);
      rows_.append('\n');
    }
  }

  OutputFile& output_;
  Lattice lattice_;
  std::vector<std::string> i_texts_;  // of each sample along x, with the comma behind it
  std::vector<std::string> x_texts_;
  RowBuffer rows_;
};

class CsvPointWriter final : public PointWriter {
 public:
  CsvPointWriter(OutputFile& output, bool diagnostics) : output_(output), rows_(output) {
    const std::string header = "x,y,z," + value_columns("w", diagnostics);
    output_.write(header.data(), header.size());
  }

  void write(std::span<const Vec3> points, std::span<const double> values, const Diagnostics* diagnostics) override {
    for (std::size_t n = 0; n < points.size(); ++n) {
      rows_.begin_row();
      for (const double number : {points[n].x, points[n].y, points[n].z}) {
        rows_.append(number);
        rows_.append(',');
      }
      rows_.append(values[n]);
      if (diagnostics) rows_.append(*diagnostics, n);
      rows_.append('\n');
    }
    rows_.hand_over();
  }

  void flush() override { output_.flush(); }
  void finish() override { output_.commit(); }

 private:
  OutputFile& output_;
  RowBuffer rows_;
};

}  // namespace

std::unique_ptr<LatticeWriter> make_csv_lattice_writer(OutputFile& output, const Lattice& lattice,
                                                       const FieldDescription& description) {
  const std::string column = description.field == "winding" ? "w" : description.field;
  return std::make_unique<CsvLatticeWriter>(output, lattice, value_columns(column, description.diagnostics));
}

std::unique_ptr<PointWriter> make_csv_point_writer(OutputFile& output, bool diagnostics) {
  return std::make_unique<CsvPointWriter>(output, diagnostics);
}

}  // namespace raycone
