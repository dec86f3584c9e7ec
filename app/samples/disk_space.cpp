#include "app/samples/disk_space.h"

#include <algorithm>
#include <cstddef>

namespace raycone {
namespace {

double bytes_of_real(const OutputDescription& description, Precision otherwise) {
  switch (description.precision.value_or(otherwise)) {
    case Precision::kHalf:
      return 2.0;
    case Precision::kSingle:
      return 4.0;
    case Precision::kDouble:
      break;
  }
  return 8.0;
}

// Of all fields together.
double bytes_of_values(const OutputDescription& description, double of_real) {
  double bytes = 0.0;
  for (const FieldDescription& field : description.fields) {
    switch (field.kind) {
      case FieldKind::kReal:
      case FieldKind::kDensity:
      case FieldKind::kDistance:
        bytes += of_real;
        break;
      case FieldKind::kVector:
        bytes += 3 * of_real;
        break;
      case FieldKind::kBound:
      case FieldKind::kCount:
        bytes += 8.0;
        break;
      case FieldKind::kLabel:
        bytes += sizeof(std::int32_t);
        break;
      case FieldKind::kFlag:
        bytes += description.packs_flags ? 1.0 / 8 : 1.0;
    }
  }
  return bytes;
}

// Each number is a digit and a comma or line feed at least.
double bytes_of_row(std::size_t numbers) { return 2.0 * static_cast<double>(numbers); }

double bytes_of_sample(FieldFormat format, const OutputDescription& description) {
  constexpr std::size_t kIndicesAndPosition = 6;
  if (description.compress) return 0.0;  // zeros take next to nothing
  switch (traits_of(format).storage) {
    case NumberStorage::kArrays:
      return bytes_of_values(description, bytes_of_real(description, Precision::kSingle));
    case NumberStorage::kText:
      return bytes_of_row(kIndicesAndPosition + description.components());
    case NumberStorage::kGrids:
    case NumberStorage::kNothing:
      break;
  }
  return 0.0;
}

double bytes_of_point(FieldFormat format, const OutputDescription& description) {
  constexpr double kCoordinates = 3.0;
  const auto numbers = static_cast<double>(description.components());
  switch (format) {
    case FieldFormat::kNpy:
      if (description.has_labels_alone()) return sizeof(std::int32_t);
      return numbers * bytes_of_real(description, Precision::kDouble);
    case FieldFormat::kRawDouble:
      return numbers * sizeof(double);
    case FieldFormat::kRawSingle:
      return numbers * sizeof(float);
    case FieldFormat::kNpz:
      return kCoordinates * (description.has_places ? 2.0 : 1.0) * (description.single_points ? 4.0 : 8.0) +
             (description.has_places ? sizeof(std::int64_t) : 0.0) +
             bytes_of_values(description, bytes_of_real(description, Precision::kDouble));
    case FieldFormat::kCsv:
      return bytes_of_row(3 + description.components());
    default:
      return 0.0;
  }
}

std::uint64_t bytes_of(std::uint64_t samples, double bytes_each) {
  return static_cast<std::uint64_t>(std::min(static_cast<double>(samples) * bytes_each, 0x1p62));
}

}  // namespace

std::uint64_t least_lattice_file(FieldFormat format, const OutputDescription& description, std::uint64_t samples) {
  return bytes_of(samples, bytes_of_sample(format, description));
}

std::uint64_t least_point_file(FieldFormat format, const OutputDescription& description, std::uint64_t samples) {
  return bytes_of(samples, bytes_of_point(format, description));
}

}  // namespace raycone
