// Slabs are large enough to keep all threads busy and small enough to be no burden beside the mesh.
#include "app/samples/slabs.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "app/samples/lattice_checks.h"
#include "core/crossings/lattice_sums.h"

namespace raycone {
namespace {

// OpenVDB stores blocks of 8^3 voxels.
constexpr double kLeafSide = 8.0;
constexpr double kLeafVoxels = kLeafSide * kLeafSide * kLeafSide;

std::int64_t floor_to_multiple(std::int64_t value, std::int64_t of) {
  const std::int64_t remainder = value % of;
  return value - (remainder < 0 ? remainder + of : remainder);
}

// Whether a band of so many voxels holds all samples, wherever the surface is: that of --band all is as wide as the
// lattice is long from corner to corner, or wider.
bool is_everywhere(double band, const Lattice& lattice) {
  constexpr double kRounding = 1e-9;
  const auto side = [&](std::size_t axis) { return static_cast<double>(lattice.counts[axis] - 1); };
  return band * (1 + kRounding) >= std::hypot(side(0), side(1), side(2)) || !cuts_off(band, lattice);
}

double grid_memory(const Lattice& lattice, const FieldDescription& field, const OutputDescription& description,
                   SlabKind kind) {
  const double layer = static_cast<double>(lattice.counts[0]) * static_cast<double>(lattice.counts[1]);
  const double samples = layer * static_cast<double>(lattice.counts[2]);
  // Those of leaves that a surface through the whole lattice meets at least.
  const double at_surface = kLeafVoxels * std::pow(samples / kLeafVoxels, 2.0 / 3.0);
  const double blocks_in_the_making = kLeafSide * layer;
  const double real_bytes = description.is(Precision::kDouble) ? sizeof(double) : sizeof(float);
  switch (field.kind) {
    case FieldKind::kReal:
    case FieldKind::kDensity:
      return real_bytes * ((kind.open ? samples : at_surface) + blocks_in_the_making);
    case FieldKind::kDistance: {
      const bool all = is_everywhere(field.background / lattice.spacing.x, lattice);
      return real_bytes * ((all ? samples : at_surface) + blocks_in_the_making);
    }
    case FieldKind::kVector:
      return 3 * real_bytes * ((kind.open ? samples : 0.0) + blocks_in_the_making);
    case FieldKind::kBound:
      return sizeof(float) * ((kind.open ? samples : 0.0) + blocks_in_the_making);
    case FieldKind::kCount:
      return sizeof(float) * blocks_in_the_making;
    case FieldKind::kLabel:
      return sizeof(std::int32_t) * (at_surface + blocks_in_the_making);
    case FieldKind::kFlag:
      return sizeof(std::uint8_t) * blocks_in_the_making;
  }
  return 0.0;
}

double bytes_per_sample(const FieldOptions& options, SlabKind kind) {
  const bool caps = kind.open && (options.rule_only() || options.tolerance > 0.0);
  const double of_caps = caps ? sizeof(double) : 0.0;  // their crossings
  const double of_fields =
      kind.blocks ? sizeof(std::uint8_t) : static_cast<double>(FieldSamples::bytes_per_sample(options));
  return of_fields + LatticeSums::kBytesPerSample + of_caps + (kind.turned ? sizeof(Vec3) : 0.0);
}

}  // namespace

LatticeBlock slab_from(const Lattice& lattice, int axis, std::int64_t alignment, std::int64_t first,
                       std::int64_t samples) {
  LatticeBlock slab = whole(lattice);
  const auto a = static_cast<std::size_t>(axis);
  slab.counts[a] = 1;
  const std::int64_t layers = std::max<std::int64_t>(samples / slab.size(), 1);
  std::int64_t end = floor_to_multiple(first + layers, alignment);
  if (end <= first) end = floor_to_multiple(first, alignment) + alignment;
  slab.first[a] = first;
  slab.counts[a] = std::min(end, lattice.index_max(axis) + 1) - first;
  return slab;
}

std::int64_t slab_samples(const FieldOptions& options, SlabKind kind, double left) {
  const double samples = left / 3 / bytes_per_sample(options, kind);
  return static_cast<std::int64_t>(std::clamp(samples, 1.0, static_cast<double>(kSlabSamples)));
}

double slab_memory(const LatticeBlock& slab, const FieldOptions& options, SlabKind kind) {
  return bytes_per_sample(options, kind) * static_cast<double>(slab.size());
}

double working_memory(SlabKind kind, double samples) {
  constexpr double kManySamples = 1e5, kBytes = 8.0 * 1024 * 1024;
  return kind.open && samples >= kManySamples ? kBytes : 0.0;
}

double writer_memory(const Lattice& lattice, FieldFormat format, const OutputDescription& description, SlabKind kind) {
  const auto samples = static_cast<double>(whole(lattice).size());
  if (format == FieldFormat::kNpz && description.packs_flags) return samples / 8;
  if (format == FieldFormat::kCsv) {
    const double texts = kind.turned ? 1.0 : 2.0;  // the index, and the coordinate where it depends on that alone
    return texts * sizeof(std::string) * static_cast<double>(lattice.counts[0]);
  }
  if (format != FieldFormat::kVdb) return 0.0;
  double bytes = 0.0;
  for (const FieldDescription& field : description.fields) bytes += grid_memory(lattice, field, description, kind);
  return bytes;
}

}  // namespace raycone
