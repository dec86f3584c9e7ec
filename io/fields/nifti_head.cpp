#include "io/fields/nifti_head.h"

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <optional>

#include "io/fields/quaternion.h"
#include "io/files/byte_order.h"
#include "io/files/file_error.h"
#include "io/files/input_buffer.h"
#include "io/files/unpack.h"

namespace raycone {
namespace {

[[noreturn]] void fail_nifti(const std::string& path, const std::string& what) {
  throw InputError(path + ": not a readable volume: " + what);
}

// By the head's first number; nothing where it is none.
std::optional<std::endian> nifti_order(std::string_view head) {
  if (head.size() < kNiftiHead || (head.substr(344, 3) != "n+1" && head.substr(344, 3) != "ni1")) return std::nullopt;
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    if (load<std::int32_t>(head.data(), order) == kNiftiHead) return order;
  }
  return std::nullopt;
}

// Fields by their offsets.
class NiftiFields {
 public:
  explicit NiftiFields(const std::string& path) {
    InputBuffer input(path, unpacked(open_source(path), path));
    while (input.pending().size() < kNiftiHead && input.fill()) continue;
    const std::optional<std::endian> order = nifti_order(input.pending());
    if (!order) fail_nifti(path, "its head is damaged");
    bytes_ = input.pending().substr(0, kNiftiHead);
    order_ = *order;
  }

  [[nodiscard]] std::int16_t integer(std::size_t offset) const { return load<std::int16_t>(&bytes_[offset], order_); }
  [[nodiscard]] double real(std::size_t offset) const {
    return static_cast<double>(load<float>(&bytes_[offset], order_));
  }
  // Up to its end or the first zero.
  [[nodiscard]] std::string text(std::size_t offset, std::size_t room) const {
    return bytes_.substr(offset, std::min(room, bytes_.find('\0', offset) - offset));
  }

 private:
  std::string bytes_;
  std::endian order_ = std::endian::little;
};

}  // namespace

bool begins_as_nifti(std::string_view bytes) { return nifti_order(bytes).has_value(); }

PlacedLattice read_nifti_lattice(const std::string& path) {
  const NiftiFields head(path);
  if (head.integer(40) < 3) fail_nifti(path, "its dimension, expected at least 3");
  const std::array<std::int64_t, 3> counts{head.integer(42), head.integer(44), head.integer(46)};
  std::array<Vec3, 3> steps;
  if (head.integer(254) > 0) {
    for (std::size_t a = 0; a < 3; ++a) {
      steps[a] = {head.real(280 + 4 * a), head.real(296 + 4 * a), head.real(312 + 4 * a)};
    }
    return {{head.real(292), head.real(308), head.real(324)}, steps, {0, 0, 0}, counts};
  }
  if (!(head.integer(252) > 0)) fail_nifti(path, "it has neither sform nor qform, expected a place in the world");
  steps = columns_of({head.real(256), head.real(260), head.real(264)});
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(head.real(80 + 4 * a) > 0.0)) fail_nifti(path, "its spacing, expected three positive numbers");
    steps[a] = head.real(80 + 4 * a) * steps[a];
  }
  if (head.real(76) < 0.0) steps[2] = -1.0 * steps[2];
  return {{head.real(268), head.real(272), head.real(276)}, steps, {0, 0, 0}, counts};
}

NiftiFacts read_nifti_facts(const std::string& path) {
  static const std::map<int, const char*> kTypes{{2, "uint8"},      {4, "int16"},    {8, "int32"},    {16, "float32"},
                                                 {32, "complex64"}, {64, "float64"}, {128, "rgb24"},  {256, "int8"},
                                                 {512, "uint16"},   {768, "uint32"}, {1024, "int64"}, {1280, "uint64"}};
  constexpr int kMostAxes = 7;
  const NiftiFields head(path);
  NiftiFacts facts;
  const int code = head.integer(70);
  const auto type = kTypes.find(code);
  facts.type = type == kTypes.end() ? "type " + std::to_string(code) : type->second;
  const int axes = std::clamp<int>(head.integer(40), 0, kMostAxes);
  for (int n = 1; n <= axes; ++n) {
    facts.shape.push_back(
        static_cast<std::uint64_t>(std::max<int>(head.integer(40 + 2 * static_cast<std::size_t>(n)), 0)));
  }
  facts.description = head.text(148, 80);
  return facts;
}

}  // namespace raycone
