// Slabs are large enough to keep all threads busy and small enough to be no burden beside the mesh.
#include "app/slabs.h"

#include <algorithm>
#include <cmath>

#include "app/sample_values.h"

namespace raycone {
namespace {

constexpr std::int64_t kSlabSamples = std::int64_t{1} << 22;

// OpenVDB stores blocks of 8^3 voxels.
constexpr double kLeafSide = 8.0;
constexpr double kLeafVoxels = kLeafSide * kLeafSide * kLeafSide;

std::int64_t floor_to_multiple(std::int64_t value, std::int64_t of) {
  const std::int64_t remainder = value % of;
  return value - (remainder < 0 ? remainder + of : remainder);
}

}  // namespace

LatticeBlock slab_from(const Lattice& lattice, int axis, std::int64_t alignment, std::int64_t first) {
  LatticeBlock slab = whole(lattice);
  const auto a = static_cast<std::size_t>(axis);
  slab.counts[a] = 1;
  const std::int64_t layers = std::max<std::int64_t>(kSlabSamples / slab.size(), 1);
  std::int64_t end = floor_to_multiple(first + layers, alignment);
  if (end <= first) end = floor_to_multiple(first, alignment) + alignment;
  slab.first[a] = first;
  slab.counts[a] = std::min(end, lattice.index_max(axis) + 1) - first;
  return slab;
}

double slab_memory(const LatticeBlock& slab, bool diagnostics) {
  return static_cast<double>(bytes_per_sample(diagnostics)) * static_cast<double>(slab.size());
}

double writer_memory(const Lattice& lattice, FieldFormat format, const FieldDescription& description) {
  if (format != FieldFormat::kVdb) return 0.0;
  const double layer = static_cast<double>(lattice.counts[0]) * static_cast<double>(lattice.counts[1]);
  const double samples = layer * static_cast<double>(lattice.counts[2]);
  // Leaves that a surface through the whole lattice meets at least.
  const double surface_leaves = std::pow(samples / kLeafVoxels, 2.0 / 3.0);
  const bool closed = description.exterior_edges == 0;
  const double value_bytes = description.double_precision ? sizeof(double) : sizeof(float);
  const double values = value_bytes * ((closed ? surface_leaves * kLeafVoxels : samples) + kLeafSide * layer);
  if (!description.diagnostics) return values;
  constexpr double kBlocksInTheMaking = 3 * sizeof(float) + sizeof(std::uint8_t);
  const double bounds = closed ? 0.0 : sizeof(float) * samples;
  return values + bounds + kBlocksInTheMaking * kLeafSide * layer;
}

}  // namespace raycone
