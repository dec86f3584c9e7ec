#include "app/run/disk_space.h"

#include <algorithm>
#include <cstddef>

namespace raycone {
namespace {

// Of all fields together.
double bytes_of_values(const OutputDescription& description, std::size_t bytes_of_real) {
  double bytes = 0.0;
  for (const FieldDescription& field : description.fields) {
    switch (field.kind) {
      case FieldKind::kReal:
      case FieldKind::kDensity:
      case FieldKind::kDistance:
        bytes += static_cast<double>(bytes_of_real);
        break;
      case FieldKind::kBound:
      case FieldKind::kCount:
        bytes += sizeof(float);
        break;
      case FieldKind::kFlag:
        bytes += sizeof(std::uint8_t);
    }
  }
  return bytes;
}

// Each number is a digit and a comma or line feed at least.
double bytes_of_row(std::size_t numbers) { return 2.0 * static_cast<double>(numbers); }

double bytes_of_sample(FieldFormat format, const OutputDescription& description) {
  constexpr std::size_t kIndicesAndPosition = 6;
  switch (format) {
    case FieldFormat::kNpy:
    case FieldFormat::kVti:
      return bytes_of_values(description, description.double_precision ? sizeof(double) : sizeof(float));
    case FieldFormat::kCsv:
      return bytes_of_row(kIndicesAndPosition + description.fields.size());
    default:
      return 0.0;
  }
}

double bytes_of_point(FieldFormat format, const OutputDescription& description) {
  constexpr std::size_t kCoordinates = 3;
  const auto fields = static_cast<double>(description.fields.size());
  switch (format) {
    case FieldFormat::kNpy:
    case FieldFormat::kRawDouble:
      return fields * sizeof(double);
    case FieldFormat::kRawFloat:
      return fields * sizeof(float);
    case FieldFormat::kNpz:
      return kCoordinates * sizeof(double) + bytes_of_values(description, sizeof(double));
    case FieldFormat::kCsv:
      return bytes_of_row(kCoordinates + description.fields.size());
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
