// Values at points without any format, for programs at the other end of a pipe.
#include <bit>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "io/fields/array_elements.h"
#include "io/fields/format_writers.h"
#include "io/fields/interleaved.h"
#include "io/fields/narrowing.h"

namespace raycone {
namespace {

static_assert(std::endian::native == std::endian::little, "elements are written as they are in memory");

template <typename Element>
class RawPointWriter final : public PointWriter {
 public:
  RawPointWriter(OutputFile& output, const OutputDescription& description) : output_(output) {
    for (const FieldDescription& field : description.fields) {
      narrowings_.emplace_back(field);
      are_distances_.push_back(field.kind == FieldKind::kDistance);
    }
  }

  void write(std::span<const Vec3> points, std::span<const FieldValues> fields) override {
    if (std::is_same_v<Element, float>) check(fields);
    const auto element = [this](std::size_t field, auto number) {
      return std::is_same_v<Element, float> ? static_cast<Element>(narrowings_[field](static_cast<double>(number)))
                                            : static_cast<Element>(number);
    };
    const std::vector<Element> elements = interleaved<Element>(fields, points.size(), element);
    output_.write(elements.data(), elements.size() * sizeof(Element));
  }
  void flush() override { output_.flush(); }
  void finish() override { output_.commit(); }

 private:
  void check(std::span<const FieldValues> fields) const {
    for (std::size_t n = 0; n < fields.size(); ++n) {
      if (!are_distances_[n]) continue;
      check_distances(std::get<std::span<const double>>(fields[n]), kLargestFloat, "--raw", output_.name());
    }
  }

  OutputFile& output_;
  std::vector<Narrowing> narrowings_;  // of each field
  std::vector<bool> are_distances_;
};

}  // namespace

std::unique_ptr<PointWriter> make_raw_point_writer(OutputFile& output, RawPrecision precision,
                                                   const OutputDescription& description) {
  if (precision == RawPrecision::kSingle) return std::make_unique<RawPointWriter<float>>(output, description);
  return std::make_unique<RawPointWriter<double>>(output, description);
}

}  // namespace raycone
