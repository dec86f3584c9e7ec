#include "io/fields/nifti_head.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "io/fields/nifti_fields.h"
#include "io/fields/quaternion.h"
#include "io/fields/volume_error.h"
#include "io/files/ascii.h"
#include "io/files/byte_order.h"

namespace raycone {
namespace {

// By the head's first number; nothing where it is none.
std::optional<std::endian> nifti_order(std::string_view head) {
  if (head.size() < nifti::kHeadSize) return std::nullopt;
  const std::string_view magic = head.substr(nifti::kMagic, 3);
  if (magic != "n+1" && magic != "ni1") return std::nullopt;
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    if (load<std::int32_t>(head.data(), order) == nifti::kHeadSize) return order;
  }
  return std::nullopt;
}

}  // namespace

std::optional<NiftiHead> nifti_head(std::string_view bytes) {
  const std::optional<std::endian> order = nifti_order(bytes);
  return order ? std::optional(NiftiHead(bytes.substr(0, nifti::kHeadSize), *order)) : std::nullopt;
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

namespace {

// Three numbers, one behind the other.
Vec3 parts_at(const NiftiHead& head, std::size_t offset) {
  return {head.real(offset), head.real(offset + 4), head.real(offset + 8)};
}

Vec3 sform_column(const NiftiHead& head, std::size_t column) {
  const auto part = [&](std::size_t row) { return head.real(nifti::kSRow + nifti::kRowSize * row + 4 * column); };
  return {part(0), part(1), part(2)};
}

// The columns of the qform's rotation. Where all of them are axes of the world up to what 32 bits of the quaternion
// leave (3e-7), they are these axes: those of scanners that turned theirs by right angles.
std::array<Vec3, 3> qform_columns(const NiftiHead& head) {
  constexpr double kRounding = 1e-6;
  const Vec3 parts = parts_at(head, nifti::kQuatern);
  const std::array<Vec3, 3> columns = columns_of({parts.x, parts.y, parts.z});
  std::array<Vec3, 3> nearest;
  for (std::size_t a = 0; a < 3; ++a) {
    for (int row = 0; row < 3; ++row) {
      nearest[a][row] = std::round(columns[a][row]) + 0.0;  // no negative zero
      if (!(std::abs(columns[a][row] - nearest[a][row]) <= kRounding)) return columns;
    }
  }
  return nearest;
}

}  // namespace

PlacedLattice nifti_lattice(const std::string& path, const NiftiHead& head) {
  const int dimension = head.integer(nifti::kDim);
  if (dimension < 3) fail_as_volume(path, "its dimension, expected at least 3, found " + std::to_string(dimension));
  std::array<std::int64_t, 3> counts{};
  for (std::size_t a = 0; a < 3; ++a) counts[a] = head.integer(nifti::kDim + 2 * (a + 1));
  std::array<Vec3, 3> steps;
  if (head.integer(nifti::kSFormCode) > 0) {
    for (std::size_t a = 0; a < 3; ++a) steps[a] = sform_column(head, a);
    return {sform_column(head, 3), steps, {0, 0, 0}, counts};
  }
  if (!(head.integer(nifti::kQFormCode) > 0))
    fail_as_volume(path, "it has neither sform nor qform, expected a place in the world");
  steps = qform_columns(head);
  for (std::size_t a = 0; a < 3; ++a) {
    const double spacing = head.real(nifti::kPixDim + 4 * (a + 1));
    if (!(spacing > 0.0))
      fail_as_volume(path, "its spacing, expected positive numbers, found " + shortest_text(spacing));
    steps[a] = spacing * steps[a];
  }
  if (head.real(nifti::kPixDim) < 0.0) steps[2] = -1.0 * steps[2];
  return {parts_at(head, nifti::kQOffset), steps, {0, 0, 0}, counts};
}

NiftiFacts nifti_facts(const NiftiHead& head) {
  static const std::map<int, const char*> kTypes{
      {2, "uint8"},         {4, "int16"},     {8, "int32"},  {16, "float32"},    {32, "complex64"},
      {64, "float64"},      {128, "rgb24"},   {256, "int8"}, {512, "uint16"},    {768, "uint32"},
      {1024, "int64"},      {1280, "uint64"}, {1, "binary"}, {1536, "float128"}, {1792, "complex128"},
      {2048, "complex256"}, {2304, "rgba32"}};
  constexpr int kMostAxes = 7;
  NiftiFacts facts;
  const int code = head.integer(nifti::kDataType);
  const auto type = kTypes.find(code);
  facts.type = type == kTypes.end() ? "type " + std::to_string(code) : type->second;
  const int axes = std::clamp<int>(head.integer(nifti::kDim), 0, kMostAxes);
  for (int n = 1; n <= axes; ++n) {
    facts.shape.push_back(
        static_cast<std::uint64_t>(std::max<int>(head.integer(nifti::kDim + 2 * static_cast<std::size_t>(n)), 0)));
  }
  facts.description = head.text(nifti::kDescrip, nifti::kDescripRoom);
  return facts;
}

}  // namespace raycone
