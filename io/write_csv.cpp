// CSV: a header line, then one row per sample; numbers as the shortest text that reads back as the same double.
#include <algorithm>
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

// The last columns of the header.
std::string columns_of(const OutputDescription& description) {
  std::string text;
  for (const FieldDescription& field : description.fields) text += (text.empty() ? "" : ",") + field.column;
  return text + '\n';
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
  std::array<char, sizeof...(Numbers) * (kMaxNumber + 1)> text;
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
  // Rows have at most `columns` numbers.
  RowBuffer(OutputFile& output, std::size_t columns)
      : output_(output), longest_row_(columns * (kMaxNumber + 1)), bytes_(std::max(longest_row_, std::size_t{65536})) {}

  void begin_row() {
    if (static_cast<std::size_t>(bytes_.data() + bytes_.size() - end_) < longest_row_) hand_over();
  }
  void append(std::string_view text) {
    std::memcpy(end_, text.data(), text.size());
    end_ += text.size();
  }
  void append(char c) { *end_++ = c; }
  void append(double value) { end_ = print(end_, value); }
  // Sample n's number of each field, and the end of the row.
  void append(std::span<const FieldValues> fields, std::size_t n) {
    for (const FieldValues& field : fields) {
      if (const auto* const reals = std::get_if<std::span<const double>>(&field)) {
        end_ = print(end_, (*reals)[n]);
      } else {
        std::visit([&](const auto& numbers) { end_ = print(end_, std::int64_t(numbers[n])); }, field);
      }
      *end_++ = ',';
    }
    end_[-1] = '\n';
  }
  void hand_over() {
    output_.write(bytes_.data(), static_cast<std::size_t>(end_ - bytes_.data()));
    end_ = bytes_.data();
  }

 private:
  OutputFile& output_;
  std::size_t longest_row_;  // characters
  std::vector<char> bytes_;
  char* end_ = bytes_.data();
};

class CsvLatticeWriter final : public LatticeWriter {
 public:
  CsvLatticeWriter(OutputFile& output, const Lattice& lattice, const OutputDescription& description)
      : output_(output), lattice_(lattice), rows_(output, 6 + description.fields.size()) {
    const std::string header = "i,j,k,x,y,z," + columns_of(description);
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

  void write(const LatticeBlock& block, std::span<const FieldValues> fields) override {
    std::size_t row = 0;
    for (std::int64_t k = block.first[2]; k < block.first[2] + block.counts[2]; ++k) {
      for (std::int64_t j = block.first[1]; j < block.first[1] + block.counts[1]; ++j) {
        write_row(j, k, row, fields);
        row += i_texts_.size();
      }
    }
    rows_.hand_over();
  }

  void finish(const FieldTotals&) override { output_.commit(); }

 private:
  // The samples of `fields` from `begin` on.
  void write_row(std::int64_t j, std::int64_t k, std::size_t begin, std::span<const FieldValues> fields) {
    const std::string jk = joined(j, k);
    const std::string yz = joined(lattice_.coordinate(1, j), lattice_.coordinate(2, k));
    for (std::size_t n = 0; n < i_texts_.size(); ++n) {
      rows_.begin_row();
      rows_.append(i_texts_[n]);
      rows_.append(jk);
      rows_.append(x_texts_[n]);
      rows_.append(yz);
      rows_.append(fields, begin + n);
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
  CsvPointWriter(OutputFile& output, const OutputDescription& description)
      : output_(output), rows_(output, 3 + description.fields.size()) {
    const std::string header = "x,y,z," + columns_of(description);
    output_.write(header.data(), header.size());
  }

  void write(std::span<const Vec3> points, std::span<const FieldValues> fields) override {
    for (std::size_t n = 0; n < points.size(); ++n) {
      rows_.begin_row();
      for (const double number : {points[n].x, points[n].y, points[n].z}) {
        rows_.append(number);
        rows_.append(',');
      }
      rows_.append(fields, n);
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
                                                       const OutputDescription& description) {
  return std::make_unique<CsvLatticeWriter>(output, lattice, description);
}

std::unique_ptr<PointWriter> make_csv_point_writer(OutputFile& output, const OutputDescription& description) {
  return std::make_unique<CsvPointWriter>(output, description);
}

}  // namespace raycone
