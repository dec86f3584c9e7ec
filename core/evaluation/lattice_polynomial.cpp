#include "core/evaluation/lattice_polynomial.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace raycone {
namespace {

constexpr double kSumsRound = 1e-12;  // of products and sums of a few numbers, relative to their magnitudes
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLeastProduct = 0x1p-900;  // less has lost bits

// The samples next to Chebyshev's points, each once.
std::vector<std::size_t> choose_nodes(std::size_t samples, std::size_t count) {
  std::vector<std::size_t> nodes;
  const double half = static_cast<double>(samples - 1) / 2;
  for (std::size_t n = 0; n < count; ++n) {
    const double angle = std::numbers::pi * static_cast<double>(2 * n + 1) / static_cast<double>(2 * count);
    const auto wanted = static_cast<std::size_t>(std::lround(half - half * std::cos(angle)));
    const std::size_t least = n == 0 ? 0 : nodes.back() + 1;
    nodes.push_back(std::clamp(wanted, least, samples - (count - n)));
  }
  return nodes;
}

}  // namespace

AxisNodes::AxisNodes(std::span<const double> coordinates, std::size_t degree)
    : nodes_(choose_nodes(coordinates.size(), std::min(degree + 1, coordinates.size()))),
      row_size_((coordinates.size() + 7) / 8 * 8) {
  weights_.assign(nodes_.size() * row_size_, 0.0);
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    double sum = 0.0, product = 1.0;
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      const double node = coordinates[nodes_[n]];
      double weight = 1.0;
      for (std::size_t other = 0; other < nodes_.size(); ++other) {
        const double from = coordinates[nodes_[other]];
        if (other != n) weight *= (coordinates[i] - from) / (node - from);
      }
      weights_[n * row_size_ + i] = weight;
      sum += std::abs(weight);
      product *= std::abs(coordinates[i] - node);
    }
    growth_ =
        std::max(growth_, std::isfinite(sum) ? sum * (1 + kSumsRound) : kInfinity);  // equal coordinates: infinite
    product_ = std::max(product_, product * (1 + kSumsRound));
  }
  if (nodes_.size() < coordinates.size()) product_ = std::max(product_, kLeastProduct);
}

double AxisNodes::error(double derivative) const { return product_ > 0.0 ? product_ * derivative : 0.0; }

}  // namespace raycone
