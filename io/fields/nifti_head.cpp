#include "io/fields/nifti_head.h"

#include <algorithm>
#include <array>
#include <map>

#include "io/fields/quaternion.h"
#include "io/fields/volume_error.h"
#include "io/files/ascii.h"
#include "io/files/byte_order.h"

namespace raycone {
namespace {

// By the head's first number; nothing where it is none.
std::optional<std::endian> nifti_order(std::string_view head) {
  if (head.size() < kNiftiHead || (head.substr(344, 3) != "n+1" && head.substr(344, 3) != "ni1")) return std::nullopt;
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    if (load<std::int32_t>(head.data(), order) == kNiftiHead) return order;
  }
  return std::nullopt;
}

}  // namespace

std::optional<NiftiHead> nifti_head(std::string_view bytes) {
  const std::optional<std::endian> order = nifti_order(bytes);
  return order ? std::optional(NiftiHead(bytes.substr(0, kNiftiHead), *order)) : std::nullopt;
}

bool is_nifti2(std::string_view bytes) {
  constexpr std::uint32_t kHead2 = 540;  // bytes, as its first number says
  if (bytes.size() < 8 || (bytes.substr(4, 3) != "n+2" && bytes.substr(4, 3) != "ni2")) return false;
  return load<std::uint32_t>(bytes.data(), std::endian::little) == kHead2 ||
         load<std::uint32_t>(bytes.data(), std::endian::big) == kHead2;
}

std::int16_t NiftiHead::integer(std::size_t offset) const { return load<std::int16_t>(&bytes_[offset], order_); }

double NiftiHead::real(std::size_t offset) const { return static_cast<double>(load<float>(&bytes_[offset], order_)); }

std::string NiftiHead::text(std::size_t offset, std::size_t room) const {
  return bytes_.substr(offset, std::min(room, bytes_.find('\0', offset) - offset));
}

PlacedLattice nifti_lattice(const std::string& path, const NiftiHead& head) {
  if (head.integer(40) < 3)
    fail_as_volume(path, "its dimension, expected at least 3, found " + std::to_string(head.integer(40)));
  const std::array<std::int64_t, 3> counts{head.integer(42), head.integer(44), head.integer(46)};
  std::array<Vec3, 3> steps;
  if (head.integer(254) > 0) {
    for (std::size_t a = 0; a < 3; ++a) {
      steps[a] = {head.real(280 + 4 * a), head.real(296 + 4 * a), head.real(312 + 4 * a)};
    }
    return {{head.real(292), head.real(308), head.real(324)}, steps, {0, 0, 0}, counts};
  }
  if (!(head.integer(252) > 0)) fail_as_volume(path, "it has neither sform nor qform, expected a place in the world");
  steps = columns_of({head.real(256), head.real(260), head.real(264)});
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(head.real(80 + 4 * a) > 0.0))
      fail_as_volume(path, "its spacing, expected positive numbers, found " + shortest_text(head.real(80 + 4 * a)));
    steps[a] = head.real(80 + 4 * a) * steps[a];
  }
  if (head.real(76) < 0.0) steps[2] = -1.0 * steps[2];
  return {{head.real(268), head.real(272), head.real(276)}, steps, {0, 0, 0}, counts};
}

NiftiFacts nifti_facts(const NiftiHead& head) {
  static const std::map<int, const char*> kTypes{
      {2, "uint8"},         {4, "int16"},     {8, "int32"},  {16, "float32"},    {32, "complex64"},
      {64, "float64"},      {128, "rgb24"},   {256, "int8"}, {512, "uint16"},    {768, "uint32"},
      {1024, "int64"},      {1280, "uint64"}, {1, "binary"}, {1536, "float128"}, {1792, "complex128"},
      {2048, "complex256"}, {2304, "rgba32"}};
  constexpr int kMostAxes = 7;
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
