#include "core/boundary/cone.h"

#include <array>
#include <cmath>

#include "core/boundary/enclosure.h"

namespace raycone {
namespace {

// In double, the argument of a product of three factors next to an edge is off by up to 1.6e-14 turns. Values are
// expected to be right within 1e-12. Times more than this it would show; edges that so many faces share are rare enough
// for the enclosure.
constexpr std::int32_t kLargestInDouble = 32;

void add_enclosed(const ChainGroup& group, SampleTile& samples, std::span<Turns> cone) {
  std::array<TurnsWithin, kTile> turns;
  enclose({&group, 1}, samples, {turns.data(), cone.size()});
  for (std::size_t i = 0; i < cone.size(); ++i) {
    const double whole = std::nearbyint(static_cast<double>(turns[i].rest));
    cone[i].whole += turns[i].whole + static_cast<std::int64_t>(whole);
    cone[i].rest += static_cast<double>(turns[i].rest - whole);
  }
}

void add_product(const ChainGroup& group, const ProductTile& products, std::span<Turns> cone) {
  for (std::size_t i = 0; i < cone.size(); ++i) {
    cone[i].whole += group.multiplicity * products.turns(i);
    cone[i].rest += group.multiplicity * products.argument[i];
  }
}

}  // namespace

Cone::Cone(const Boundary& boundary, SimdLevel level)
    : CompleteEngine(boundary, boundary.total_multiplicity()), multiply_chains_(cone_kernel(level)) {}

void Cone::winding_numbers(SampleTile& samples, std::span<const std::int64_t> crossings, std::span<double> w) const {
  samples.fill_up();
  std::array<Turns, kTile> cone{};
  const std::span<Turns> turns(cone.data(), samples.count);
  ProductTile products;
  for (const ChainGroup& group : boundary().groups()) {
    if (group.multiplicity > kLargestInDouble) {
      add_enclosed(group, samples, turns);
    } else {
      multiply_chains_(group.steps, samples, TileShape::kScattered, products);
      add_product(group, products, turns);
    }
  }
  for (std::size_t i = 0; i < turns.size(); ++i) {
    w[i] = static_cast<double>(crossings[i] - turns[i].whole) - turns[i].rest;
  }
}

}  // namespace raycone
