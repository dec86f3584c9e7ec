// CSV: a header line, then one row per sample; numbers as the shortest text that reads back as the same double.
#include <algorithm>
#include <array>
#include <charconv>
#include <concepts>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/machine/threads.h"
#include "io/fields/format_writers.h"

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
requires std::integral<Number> || std::floating_point<Number>
char* print(char* at, Number value) {
  if (value == 0) value = 0;
  return std::to_chars(at, at + kMaxNumber, value).ptr;
}

// "first,second," or "first,": the part of a row that many rows share.
template <typename... Numbers>
std::string cells(Numbers... numbers) {
  std::array<char, sizeof...(Numbers) * (kMaxNumber + 1)> text;
  char* end = text.data();
  const auto append = [&end](auto number) {
    end = print(end, number);
    *end++ = ',';
  };
  (append(numbers), ...);
  return {text.data(), end};
}

char* print(char* at, std::string_view text) {
  std::memcpy(at, text.data(), text.size());
  return at + text.size();
}

char* print(char* at, const Vec3& vector) {
  for (int axis = 0; axis < 3; ++axis) {
    if (axis > 0) *at++ = ',';
    at = print(at, vector[axis]);
  }
  return at;
}

// Prints what sample n has of each field, and the end of the row.
char* print(char* at, std::span<const FieldValues> fields, std::size_t n) {
  for (const FieldValues& field : fields) {
    if (const auto* const reals = std::get_if<std::span<const double>>(&field)) {
      at = print(at, (*reals)[n]);
    } else if (const auto* const vectors = std::get_if<std::span<const Vec3>>(&field)) {
      at = print(at, (*vectors)[n]);
    } else if (const auto* const counts = std::get_if<std::span<const std::int64_t>>(&field)) {
      at = print(at, (*counts)[n]);
    } else if (const auto* const labels = std::get_if<std::span<const std::int32_t>>(&field)) {
      at = print(at, (*labels)[n]);
    } else {
      at = print(at, std::int64_t{std::get<std::span<const std::uint8_t>>(field)[n]});
    }
    *at++ = ',';
  }
  at[-1] = '\n';
  return at;
}

// Prints rows on all threads, piece by piece, and writes them in order.
class RowWriter {
 public:
  // Rows have at most `columns` numbers.
  RowWriter(OutputFile& output, std::size_t columns) : output_(output), longest_row_(columns * (kMaxNumber + 1)) {}

  // print_rows(at, begin, end) prints the rows begin to end - 1 and returns what follows them.
  template <class PrintRows>
  void write(std::size_t count, const PrintRows& print_rows) {
    for (std::size_t begin = 0; begin < count; begin += kPieces * kPieceRows) {
      const std::size_t rows = std::min(count - begin, kPieces * kPieceRows);
      const std::size_t pieces = (rows + kPieceRows - 1) / kPieceRows;
      while (pieces_.size() < pieces) pieces_.emplace_back(longest_row_ * kPieceRows);
      parallel_for_each(pieces, [&](std::size_t n) {
        const std::size_t from = begin + n * kPieceRows;
        char* const text = pieces_[n].text.get();
        pieces_[n].end = print_rows(text, from, std::min(from + kPieceRows, count));
      });
      for (std::size_t n = 0; n < pieces; ++n) {
        const char* const text = pieces_[n].text.get();
        output_.write(text, static_cast<std::size_t>(pieces_[n].end - text));
      }
    }
  }

 private:
  // As many as keep the threads busy, and few enough that their text stays in the cache.
  static constexpr std::size_t kPieceRows = 1024;
  static constexpr std::size_t kPieces = 32;

  struct Piece {
    explicit Piece(std::size_t size) : text(std::make_unique_for_overwrite<char[]>(size)) {}
    std::unique_ptr<char[]> text;
    char* end = nullptr;
  };

  OutputFile& output_;
  std::size_t longest_row_;  // characters
  std::vector<Piece> pieces_;
};

class CsvLatticeWriter final : public LatticeWriter {
 public:
  CsvLatticeWriter(OutputFile& output, const PlacedLattice& lattice, const OutputDescription& description)
      : output_(output),
        lattice_(lattice),
        turned_(!lattice.along_axes()),
        rows_(output, 6 + description.components()) {
    const std::string header = "i,j,k,x,y,z," + columns_of(description);
    output_.write(header.data(), header.size());
    // The texts of one axis are the same in every row; printing them once makes rows three times as fast.
    for (std::int64_t n = 0; n < lattice.grid.counts[0]; ++n) {
      const std::int64_t i = lattice.grid.index_min[0] + n;
      i_texts_.push_back(cells(i));
      if (!turned_) x_texts_.push_back(cells(lattice.grid.coordinate(0, i)));
    }
  }

  int slab_axis() const override { return 2; }
  std::int64_t slab_alignment() const override { return 1; }

  void write(const LatticeBlock& block, std::span<const FieldValues> fields) override {
    rows_.write(static_cast<std::size_t>(block.size()), [&](char* at, std::size_t begin, std::size_t end) {
      return print_rows(at, block, fields, begin, end);
    });
  }

  void finish(const FieldTotals&) override { output_.commit(); }

 private:
  // The samples begin to end - 1 of the block.
  char* print_rows(char* at, const LatticeBlock& block, std::span<const FieldValues> fields, std::size_t begin,
                   std::size_t end) const {
    const std::size_t length = i_texts_.size();
    while (begin < end) {
      const auto line = static_cast<std::int64_t>(begin / length);
      const std::int64_t j = block.first[1] + line % block.counts[1];
      const std::int64_t k = block.first[2] + line / block.counts[1];
      const std::string jk = cells(j, k);
      const std::string yz = turned_ ? "" : cells(lattice_.grid.coordinate(1, j), lattice_.grid.coordinate(2, k));
      std::size_t i = begin % length;
      for (const std::size_t line_end = std::min(end, begin - i + length); begin < line_end; ++begin, ++i) {
        at = print(print(at, i_texts_[i]), jk);
        at = turned_ ? print_place(at, block, begin) : print(print(at, x_texts_[i]), yz);
        at = print(at, fields, begin);
      }
    }
    return at;
  }

  char* print_place(char* at, const LatticeBlock& block, std::size_t n) const {
    at = print(at, lattice_.position(block, n));
    *at++ = ',';
    return at;
  }

  OutputFile& output_;
  PlacedLattice lattice_;
  bool turned_;                       // each coordinate may depend on all indices
  std::vector<std::string> i_texts_;  // of each sample along x, with the comma behind it
  std::vector<std::string> x_texts_;
  RowWriter rows_;
};

class CsvPointWriter final : public PointWriter {
 public:
  CsvPointWriter(OutputFile& output, const OutputDescription& description)
      : output_(output), rows_(output, 3 + description.components()) {
    const std::string header = "x,y,z," + columns_of(description);
    output_.write(header.data(), header.size());
  }

  void write(std::span<const Vec3> points, std::span<const FieldValues> fields) override {
    rows_.write(points.size(), [&](char* at, std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        for (const double number : {points[n].x, points[n].y, points[n].z}) {
          at = print(at, number);
          *at++ = ',';
        }
        at = print(at, fields, n);
      }
      return at;
    });
  }

  void flush() override { output_.flush(); }
  void finish() override { output_.commit(); }

 private:
  OutputFile& output_;
  RowWriter rows_;
};

}  // namespace

std::unique_ptr<LatticeWriter> make_csv_lattice_writer(OutputFile& output, const PlacedLattice& lattice,
                                                       const OutputDescription& description) {
  return std::make_unique<CsvLatticeWriter>(output, lattice, description);
}

std::unique_ptr<PointWriter> make_csv_point_writer(OutputFile& output, const OutputDescription& description) {
  return std::make_unique<CsvPointWriter>(output, description);
}

}  // namespace raycone
