// Values at points without any format, for programs at the other end of a pipe.
#include <bit>
#include <cstddef>

#include "io/format_writers.h"
#include "io/interleaved.h"

namespace raycone {
namespace {

static_assert(std::endian::native == std::endian::little, "elements are written as they are in memory");

template <typename Element>
class RawPointWriter final : public PointWriter {
 public:
  explicit RawPointWriter(OutputFile& output) : output_(output) {}

  void write(std::span<const Vec3> points, std::span<const FieldValues> fields) override {
    const std::vector<Element> elements = interleaved<Element>(fields, points.size());
    output_.write(elements.data(), elements.size() * sizeof(Element));
  }
  void flush() override { output_.flush(); }
  void finish() override { output_.commit(); }

 private:
  OutputFile& output_;
};

}  // namespace

std::unique_ptr<PointWriter> make_raw_point_writer(OutputFile& output, RawPrecision precision) {
  if (precision == RawPrecision::kFloat) return std::make_unique<RawPointWriter<float>>(output);
  return std::make_unique<RawPointWriter<double>>(output);
}

}  // namespace raycone
