// Points in NumPy's NPY format, versions 1 to 3 (NumPy documentation, "numpy.lib.format"): shape (n, 3 or more), any
// real or integer type, byte order and memory order. Read in blocks, but Fortran order on a pipe or compressed.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/files/ascii.h"
#include "io/files/byte_order.h"
#include "io/files/counted.h"
#include "io/files/file_error.h"
#include "io/files/half.h"
#include "io/files/npy_head.h"
#include "io/points/point_readers.h"

namespace raycone {
namespace {

constexpr std::size_t kMaxRow = std::size_t{1} << 24;  // bytes
constexpr std::size_t kBlockRows = std::size_t{1} << 14;

// --- Layout ---------------------------------------------------------------------------------------------------------

struct PointLayout {
  char kind = 'f';            // 'f', 'i' or 'u'
  std::size_t item_size = 0;  // bytes
  std::endian order = std::endian::little;
  bool fortran_order = false;
  std::uint64_t rows = 0;
  std::uint64_t columns = 0;
  std::uint64_t data_offset = 0;
};

[[noreturn]] void fail(const InputBuffer& input, const std::string& what) {
  throw InputError(input.name() + ": NPY " + what);
}

void interpret_type(const InputBuffer& input, const NpyHead& head, PointLayout& layout) {
  const std::string& type = head.type;
  static constexpr std::array<std::string_view, 11> kTypes{"f2", "f4", "f8", "i1", "i2", "i4",
                                                           "i8", "u1", "u2", "u4", "u8"};
  const bool known = type.size() == 3 && std::string_view("<>|=").find(type[0]) != std::string_view::npos &&
                     std::find(kTypes.begin(), kTypes.end(), type.substr(1)) != kTypes.end();
  if (!known) {
    fail(input, "file of type " + excerpt(type) + ", expected real or integer numbers of at most 64 bits");
  }
  layout.kind = type[1];
  layout.item_size = static_cast<std::size_t>(type[2] - '0');
  layout.order = type[0] == '>' ? std::endian::big : type[0] == '<' ? std::endian::little : std::endian::native;
}

PointLayout read_layout(InputBuffer& input) {
  const NpyHead head = read_npy_head(input);
  PointLayout layout;
  interpret_type(input, head, layout);
  if (head.shape.size() != 2 || head.shape[1] < 3) {
    fail(input, "shape " + excerpt(head.shape_text) + ", expected (n, 3 or more)");
  }
  layout.fortran_order = head.fortran_order;
  layout.rows = head.shape[0];
  layout.columns = head.shape[1];
  layout.data_offset = head.data_offset;
  return layout;
}

// Compares what the head announces with what the file has, before anything is allocated for it.
void check_size(const PointLayout& layout, const InputBuffer& input) {
  const std::uint64_t row = layout.columns > kMaxRow ? kMaxRow + 1 : layout.columns * layout.item_size;
  if (row > kMaxRow) {
    throw InputError(input.name() + ": NPY rows of " + counted(layout.columns, "column") + ", expected (n, 3)");
  }
  const auto file_size = input.file_size();
  if (!file_size) return;
  const std::uint64_t available = *file_size - std::min(*file_size, layout.data_offset);
  if (layout.rows > available / row) {
    throw InputError(input.name() + ": NPY data of " + counted(available, "byte") + ", expected " +
                     counted(layout.rows, "row") + " of " + std::to_string(row));
  }
}

// --- Values ---------------------------------------------------------------------------------------------------------

template <class Number>
double load_number(const char* bytes, std::endian order) {
  return static_cast<double>(load<Number>(bytes, order));
}

double load_half(const char* bytes, std::endian order) {
  return static_cast<double>(half_from_bits(load<std::uint16_t>(bytes, order)));
}

// Conversion of one stored number, chosen once per file.
using Loader = double (*)(const char*, std::endian);

Loader loader_of(const PointLayout& layout) {
  const bool is_signed = layout.kind == 'i';
  switch (layout.item_size) {
    case 1:
      return is_signed ? load_number<std::int8_t> : load_number<std::uint8_t>;
    case 2:
      return layout.kind == 'f' ? load_half : is_signed ? load_number<std::int16_t> : load_number<std::uint16_t>;
    case 4:
      return layout.kind == 'f' ? load_number<float>
             : is_signed        ? load_number<std::int32_t>
                                : load_number<std::uint32_t>;
    default:
      return layout.kind == 'f' ? load_number<double>
             : is_signed        ? load_number<std::int64_t>
                                : load_number<std::uint64_t>;
  }
}

// --- Readers --------------------------------------------------------------------------------------------------------

class NpyPointReader : public PointReader {
 public:
  NpyPointReader(std::unique_ptr<InputBuffer> input, const PointLayout& layout)
      : input_(std::move(input)), layout_(layout), load_(loader_of(layout)) {}

  [[nodiscard]] std::optional<std::uint64_t> size() const override { return layout_.rows; }
  [[nodiscard]] bool has_certain_size() const override { return input_->is_seekable(); }

 protected:
  // The number of rows to read next, at most `max`.
  [[nodiscard]] std::size_t next_count(std::size_t max) const {
    return static_cast<std::size_t>(std::min<std::uint64_t>(max, layout_.rows - row_));
  }

  [[nodiscard]] double coordinate(const char* bytes, std::uint64_t row, int axis) const {
    const double value = load_(bytes, layout_.order);
    if (!std::isfinite(value)) {
      fail_at_byte(input_->name(), offset_of(row, axis),
                   "row " + std::to_string(row) + " has " + "xyz"[axis] + " = " + std::to_string(value) +
                       ", expected a finite number");
    }
    return value;
  }

  // Of a number in the file; rows and columns count from 0.
  [[nodiscard]] std::uint64_t offset_of(std::uint64_t row, int axis) const {
    const auto column = static_cast<std::uint64_t>(axis);
    const std::uint64_t index = layout_.fortran_order ? column * layout_.rows + row : row * layout_.columns + column;
    return layout_.data_offset + index * layout_.item_size;
  }

  std::unique_ptr<InputBuffer> input_;
  PointLayout layout_;
  std::uint64_t row_ = 0;  // the next one

 private:
  Loader load_;
};

// Row after row, as they arrive.
class RowMajorReader : public NpyPointReader {
 public:
  using NpyPointReader::NpyPointReader;

  bool next(std::vector<Vec3>& batch, std::size_t max) override {
    batch.clear();
    if (next_count(max) == 0) {
      input_->check_rest();
      return false;
    }
    require_bytes(*input_, row_size(), "the NPY data");
    const std::size_t count = std::min(next_count(max), input_->pending().size() / row_size());
    const char* row = input_->pending().data();
    for (std::size_t i = 0; i < count; ++i, ++row_, row += row_size()) {
      Vec3& point = batch.emplace_back();
      for (int axis = 0; axis < 3; ++axis) {
        point[axis] = coordinate(row + static_cast<std::size_t>(axis) * layout_.item_size, row_, axis);
      }
    }
    input_->consume(count * row_size());
    return true;
  }

  // Reads what has arrived: half a row is no answer.
  [[nodiscard]] bool would_block() override {
    while (row_ < layout_.rows && input_->pending().size() < row_size()) {
      if (input_->would_wait()) return true;
      if (!input_->fill()) return false;
    }
    return false;
  }

 private:
  [[nodiscard]] std::size_t row_size() const { return static_cast<std::size_t>(layout_.columns) * layout_.item_size; }
};

// Column after column: x, y and z are read side by side. What cannot be sought is held in memory, as its last number
// may belong to the first point.
class ColumnMajorReader : public NpyPointReader {
 public:
  ColumnMajorReader(std::unique_ptr<InputBuffer> input, const PointLayout& layout)
      : NpyPointReader(std::move(input), layout) {
    if (!input_->is_seekable()) hold();
    input_->check_rest();
  }

  bool next(std::vector<Vec3>& batch, std::size_t max) override {
    batch.resize(next_count(std::min(max, kBlockRows)));
    std::vector<char> column(batch.size() * layout_.item_size);
    for (int axis = 0; axis < 3; ++axis) {
      read_at(offset_of(row_, axis), column);
      for (std::size_t i = 0; i < batch.size(); ++i) {
        batch[i][axis] = coordinate(column.data() + i * layout_.item_size, row_ + i, axis);
      }
    }
    row_ += batch.size();
    return !batch.empty();
  }

  [[nodiscard]] bool would_block() override { return false; }
  [[nodiscard]] bool has_certain_size() const override { return true; }  // all are held or can be sought

 private:
  void hold() {
    const std::uint64_t size = layout_.rows * layout_.columns * layout_.item_size;
    if (size / layout_.item_size / layout_.columns != layout_.rows) fail(*input_, "of more rows than memory holds");
    require_bytes(*input_, static_cast<std::size_t>(size), "the NPY data");
    held_.emplace(input_->pending().substr(0, static_cast<std::size_t>(size)));
    input_->consume(held_->size());
  }

  void read_at(std::uint64_t offset, std::vector<char>& bytes) const {
    if (!held_) return input_->read_at(offset, bytes.data(), bytes.size());
    held_->copy(bytes.data(), bytes.size(), static_cast<std::size_t>(offset - layout_.data_offset));
  }

  std::optional<std::string> held_;  // the data
};

}  // namespace

std::unique_ptr<PointReader> read_npy_points(std::unique_ptr<InputBuffer> input) {
  const PointLayout layout = read_layout(*input);
  check_size(layout, *input);
  if (!layout.fortran_order) return std::make_unique<RowMajorReader>(std::move(input), layout);
  return std::make_unique<ColumnMajorReader>(std::move(input), layout);
}

}  // namespace raycone
