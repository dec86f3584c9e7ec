// Points as nothing but their coordinates, little-endian, x, y, z of one after the other.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "io/files/byte_order.h"
#include "io/files/counted.h"
#include "io/files/file_error.h"
#include "io/points/point_readers.h"

namespace raycone {
namespace {

template <typename Number>
class RawPointReader final : public PointReader {
 public:
  explicit RawPointReader(std::unique_ptr<InputBuffer> input) : input_(std::move(input)) {}

  bool next(std::vector<Vec3>& batch, std::size_t max) override {
    batch.clear();
    while (input_->pending().size() < kPointSize) {
      if (!input_->fill()) return at_end();
    }
    const std::size_t count = std::min(max, input_->pending().size() / kPointSize);
    for (std::size_t i = 0; i < count; ++i) {
      Vec3& point = batch.emplace_back();
      for (int axis = 0; axis < 3; ++axis) {
        point[axis] = coordinate(i * kPointSize + static_cast<std::size_t>(axis) * sizeof(Number));
      }
    }
    input_->consume(count * kPointSize);
    return true;
  }

  // Reads what has arrived: part of a point is no question.
  [[nodiscard]] bool would_block() override {
    while (input_->pending().size() < kPointSize) {
      if (input_->would_wait()) return true;
      if (!input_->fill()) return false;
    }
    return false;
  }

  [[nodiscard]] std::optional<std::uint64_t> size() const override {
    const std::optional<std::uint64_t> bytes = input_->file_size();
    return bytes ? std::optional(*bytes / kPointSize) : std::nullopt;
  }

 private:
  static constexpr std::size_t kPointSize = 3 * sizeof(Number);

  bool at_end() const {
    const std::size_t rest = input_->pending().size();
    if (rest == 0) return false;
    fail_at_byte(input_->name(), input_->offset() + rest,
                 "end of the input " + counted(rest, "byte") + " into a point, expected " + std::to_string(kPointSize));
  }

  // At `place` of what is pending.
  [[nodiscard]] double coordinate(std::size_t place) const {
    const auto number = static_cast<double>(load_little_endian<Number>(input_->pending().data() + place));
    if (!std::isfinite(number)) {
      fail_at_byte(input_->name(), input_->offset() + place,
                   "coordinate " + std::to_string(number) + ", expected a finite number");
    }
    return number;
  }

  std::unique_ptr<InputBuffer> input_;
};

}  // namespace

std::unique_ptr<PointReader> read_raw_points(std::unique_ptr<InputBuffer> input, RawPrecision precision) {
  if (precision == RawPrecision::kSingle) return std::make_unique<RawPointReader<float>>(std::move(input));
  return std::make_unique<RawPointReader<double>>(std::move(input));
}

}  // namespace raycone
