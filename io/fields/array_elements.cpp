#include "io/fields/array_elements.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <utility>
#include <vector>

#include "core/machine/threads.h"
#include "io/fields/narrowing.h"
#include "io/files/file_error.h"
#include "io/files/half.h"

namespace raycone {
namespace {

static_assert(std::endian::native == std::endian::little, "elements are written as they are in memory");

// Each type here turns a field's Numbers into Elements, one, or many at once.

// As they are. Adding 0 turns -0 into 0, here and below.
template <typename Type>
struct Kept {
  using Number = Type;
  using Element = Type;
  Element operator()(Number number) const { return static_cast<Element>(number + 0); }
  void operator()(std::span<const Number> numbers, Element* elements) const {
    for (std::size_t n = 0; n < numbers.size(); ++n) elements[n] = (*this)(numbers[n]);
  }
};

struct ByteElement : Kept<std::uint8_t> {
  static constexpr const char* kDescriptor = "|b1";  // NumPy's bool is a byte
};
struct IntegerElement : Kept<std::int64_t> {
  static constexpr const char* kDescriptor = "<i8";
};
struct LabelElement : Kept<std::int32_t> {
  static constexpr const char* kDescriptor = "<i4";
};
struct DoubleElement : Kept<double> {
  static constexpr const char* kDescriptor = "<f8";
};

struct FloatElement {
  using Number = double;
  using Element = float;
  static constexpr const char* kDescriptor = "<f4";
  float operator()(double number) const { return narrowing(number) + 0.0F; }
  void operator()(std::span<const double> numbers, float* elements) const { narrowing.store(numbers, elements); }
  Narrowing narrowing;
};

struct HalfElement {
  using Number = double;
  using Element = std::uint16_t;
  static constexpr const char* kDescriptor = "<f2";
  std::uint16_t operator()(double number) const { return bits_of_half(narrowing(number)); }
  void operator()(std::span<const double> numbers, std::uint16_t* elements) const {
    constexpr std::size_t kPiece = 256;
    std::array<float, kPiece> stored;
    for (std::size_t begin = 0; begin < numbers.size(); begin += kPiece) {
      const std::span<const double> piece = numbers.subspan(begin, std::min(kPiece, numbers.size() - begin));
      narrowing.store(piece, stored.data());
      for (std::size_t n = 0; n < piece.size(); ++n) elements[begin + n] = bits_of_half(stored[n]);
    }
  }
  Narrowing narrowing;
};

// Convert: one of the types above, for each component.
template <typename Convert>
struct VectorElement {
  using Number = Vec3;
  using Element = std::array<typename Convert::Element, 3>;
  static constexpr const char* kDescriptor = Convert::kDescriptor;
  void operator()(std::span<const Vec3> vectors, Element* elements) const {
    std::ranges::transform(vectors, elements, [this](const Vec3& v) {
      return Element{convert(v.x), convert(v.y), convert(v.z)};
    });
  }
  Convert convert;
};

template <typename Convert>
class TypedElements final : public ArrayElements {
 public:
  using Number = typename Convert::Number;
  using Element = typename Convert::Element;

  // `largest`: the magnitude that numbers may have.
  TypedElements(Convert convert, double largest, std::string output)
      : convert_(std::move(convert)), largest_(largest), output_(std::move(output)) {}

  const char* descriptor() const override { return Convert::kDescriptor; }
  std::size_t size() const override { return sizeof(Element); }

  std::span<const char> in_order(const FieldValues& values) override {
    const auto numbers = std::get<std::span<const Number>>(values);
    check_range(numbers);
    elements_.resize(numbers.size());
    constexpr std::size_t kGrain = std::size_t{1} << 14;
    parallel_for(numbers.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      convert_(numbers.subspan(begin, end - begin), &elements_[begin]);
    });
    return bytes();
  }

  std::span<const char> planes(const LatticeBlock& block, const FieldValues& values, std::size_t x_begin,
                               std::size_t x_end) override {
    const auto numbers = std::get<std::span<const Number>>(values);
    if (x_begin == 0) check_range(numbers);
    const auto ny = static_cast<std::size_t>(block.counts[1]), nz = static_cast<std::size_t>(block.counts[2]);
    elements_.resize((x_end - x_begin) * ny * nz);
    parallel_for_each(ny, [&](std::size_t y) { transpose_row(block, numbers, y, x_begin, x_end); });
    return bytes();
  }

 private:
  // Tile by tile, each of which is read, converted and written by itself: reading waits for memory, and many reads wait
  // at the same time where nothing else is between them.
  void transpose_row(const LatticeBlock& block, std::span<const Number> numbers, std::size_t y, std::size_t x_begin,
                     std::size_t x_end) {
    constexpr std::size_t kTile = 16;  // a tile's cache lines on both sides fit in the first-level cache
    std::array<Number, kTile * kTile> tile;
    std::array<Element, kTile * kTile> converted;
    const auto nx = static_cast<std::size_t>(block.counts[0]);
    const auto ny = static_cast<std::size_t>(block.counts[1]);
    const auto nz = static_cast<std::size_t>(block.counts[2]);
    for (std::size_t z = 0; z < nz; z += kTile) {
      const std::size_t lines = std::min(kTile, nz - z);
      for (std::size_t x = x_begin; x < x_end; x += kTile) {
        const std::size_t columns = std::min(kTile, x_end - x);
        for (std::size_t k = 0; k < lines; ++k)
          std::copy_n(&numbers[((z + k) * ny + y) * nx + x], columns, &tile[k * columns]);
        convert_({tile.data(), lines * columns}, converted.data());
        for (std::size_t i = 0; i < columns; ++i) {
          Element* const line = &elements_[((x + i - x_begin) * ny + y) * nz + z];
          for (std::size_t k = 0; k < lines; ++k) line[k] = converted[k * columns + i];
        }
      }
    }
  }

  void check_range(std::span<const Vec3>) const {}

  void check_range(std::span<const double> numbers) const { check_distances(numbers, largest_, "--dtype", output_); }
  template <typename Integer>
  void check_range(std::span<const Integer>) const {}

  [[nodiscard]] std::span<const char> bytes() const {
    return {reinterpret_cast<const char*>(elements_.data()), elements_.size() * sizeof(Element)};
  }

  Convert convert_;
  double largest_;
  std::string output_;
  std::vector<Element> elements_;
};

// Components beyond the range of fewer bits are stored as the largest there.
std::unique_ptr<ArrayElements> make_vector_elements(const FieldDescription& field, Precision precision,
                                                    const std::string& output) {
  const auto made = [&](auto convert) -> std::unique_ptr<ArrayElements> {
    constexpr double kAny = std::numeric_limits<double>::infinity();
    using Vector = VectorElement<decltype(convert)>;
    return std::make_unique<TypedElements<Vector>>(Vector{convert}, kAny, output);
  };
  if (precision == Precision::kDouble) return made(DoubleElement{});
  if (precision == Precision::kSingle) return made(FloatElement{Narrowing(field)});
  return made(HalfElement{Narrowing(field, Digits::kHalf)});
}

}  // namespace

void check_distances(std::span<const double> numbers, double largest, const char* option, const std::string& output) {
  if (!std::isfinite(largest)) return;
  const auto beyond = std::ranges::find_if(numbers, [=](double number) { return std::abs(number) > largest; });
  if (beyond == numbers.end()) return;
  const bool half = largest <= kLargestHalf;
  char message[160];
  std::snprintf(message, sizeof message,
                ": the distance %.6g is beyond %g, the range of %d bits; expected %s f%d, or another --scale", *beyond,
                largest, half ? 16 : 32, option, half ? 32 : 64);
  throw OutputError(output + message);
}

std::unique_ptr<ArrayElements> make_array_elements(const FieldDescription& field, Precision precision,
                                                   const std::string& output) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  if (field.kind == FieldKind::kFlag) return std::make_unique<TypedElements<ByteElement>>(ByteElement{}, kAny, output);
  if (field.kind == FieldKind::kCount) {
    return std::make_unique<TypedElements<IntegerElement>>(IntegerElement{}, kAny, output);
  }
  if (field.kind == FieldKind::kLabel) {
    return std::make_unique<TypedElements<LabelElement>>(LabelElement{}, kAny, output);
  }
  if (field.kind == FieldKind::kVector) return make_vector_elements(field, precision, output);
  if (field.kind == FieldKind::kBound || precision == Precision::kDouble) {
    return std::make_unique<TypedElements<DoubleElement>>(DoubleElement{}, kAny, output);
  }
  if (precision == Precision::kSingle) {
    const double largest = field.kind == FieldKind::kDistance ? kLargestFloat : kAny;
    return std::make_unique<TypedElements<FloatElement>>(FloatElement{Narrowing(field)}, largest, output);
  }
  // Winding numbers beyond are stored as the largest half.
  const double largest = field.kind == FieldKind::kDistance ? kLargestHalf : kAny;
  return std::make_unique<TypedElements<HalfElement>>(HalfElement{Narrowing(field, Digits::kHalf)}, largest, output);
}

}  // namespace raycone
