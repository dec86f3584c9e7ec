#include "core/evaluation/block_parts.h"

#include <array>

namespace raycone {
namespace {

// Indices [first, first + count) along one axis.
struct SampleRun {
  std::int64_t first;
  std::int64_t count;
};

std::vector<SampleRun> runs_alike(const Lattice& lattice, const LatticeBlock& block, int axis,
                                  const std::function<bool(double)>& property) {
  const auto a = static_cast<std::size_t>(axis);
  std::vector<SampleRun> runs;
  bool last = false;
  for (std::int64_t i = block.first[a]; i < block.first[a] + block.counts[a]; ++i) {
    const bool here = property(lattice.coordinate(axis, i));
    if (runs.empty() || here != last) runs.push_back({i, 0});
    ++runs.back().count;
    last = here;
  }
  return runs;
}

}  // namespace

std::vector<LatticeBlock> parts_alike(const Lattice& lattice, const LatticeBlock& block,
                                      const std::function<bool(double)>& property) {
  std::array<std::vector<SampleRun>, 3> runs;
  for (int axis = 0; axis < 3; ++axis) {
    runs[static_cast<std::size_t>(axis)] = runs_alike(lattice, block, axis, property);
  }
  std::vector<LatticeBlock> parts;
  for (const SampleRun& z : runs[2]) {
    for (const SampleRun& y : runs[1]) {
      for (const SampleRun& x : runs[0]) parts.push_back({{x.first, y.first, z.first}, {x.count, y.count, z.count}});
    }
  }
  return parts;
}

PartSamples::PartSamples(std::size_t count, bool with_diagnostics)
    : values_(count),
      error_bound_(with_diagnostics ? count : 0),
      crossings_(error_bound_.size()),
      degenerate_(error_bound_.size()),
      on_surface_(error_bound_.size()),
      diagnostics_{crossings_, degenerate_, on_surface_, error_bound_} {}

void PartSamples::copy_to(const LatticeBlock& whole, const LatticeBlock& part, std::span<double> values,
                          const Diagnostics* diagnostics) const {
  copy_part<double>(whole, part, values_, values);
  if (!diagnostics) return;
  copy_part<std::int64_t>(whole, part, crossings_, diagnostics->crossings);
  copy_part<std::int64_t>(whole, part, degenerate_, diagnostics->degenerate);
  copy_part<std::uint8_t>(whole, part, on_surface_, diagnostics->on_surface);
  copy_part<double>(whole, part, error_bound_, diagnostics->error_bound);
}

}  // namespace raycone
