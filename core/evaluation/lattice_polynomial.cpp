#include "core/evaluation/lattice_polynomial.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/evaluation/sums_round.h"
#include "core/machine/simd.h"

namespace raycone {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLeastProduct = 0x1p-900;  // less has lost bits

// The samples next to Chebyshev's points, each once.
std::vector<std::size_t> chebyshev_nodes(std::size_t samples, std::size_t count) {
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
    : nodes_(chebyshev_nodes(coordinates.size(), std::min(degree + 1, coordinates.size()))),
      row_size_(padded_to_lanes(coordinates.size())) {
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

NodeGrid::NodeGrid(const LatticeRows& rows, const SampleBox& box, const std::array<std::size_t, 3>& degrees,
                   std::span<const double> derivatives)
    : begin_(box.begin) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::span<const double> all(rows.along(axis));
    const AxisNodes& along = along_.emplace_back(all.subspan(box.begin[axis], box.side(axis)), degrees[axis]);
    bend_ = along.error(derivatives[along.degree()]) + along.growth() * bend_;
    growth_ *= along.growth();
  }
  bend_ *= 1 + kSumsRound;
}

std::vector<std::array<std::size_t, 3>> NodeGrid::nodes() const {
  std::vector<std::array<std::size_t, 3>> samples;
  samples.reserve(size());
  for (const std::size_t k : along_[2].nodes()) {
    for (const std::size_t j : along_[1].nodes()) {
      for (const std::size_t i : along_[0].nodes()) samples.push_back({begin_[0] + i, begin_[1] + j, begin_[2] + k});
    }
  }
  return samples;
}

double NodeGrid::at(std::span<const double> values, const std::array<std::size_t, 3>& sample) const {
  double sum = 0.0;
  for (std::size_t k = 0, n = 0; k < size(2); ++k) {
    double layer = 0.0;
    for (std::size_t j = 0; j < size(1); ++j) {
      double row = 0.0;
      for (std::size_t i = 0; i < size(0); ++i) row += along_[0].weights(i)[sample[0] - begin_[0]] * values[n++];
      layer += along_[1].weights(j)[sample[1] - begin_[1]] * row;
    }
    sum += along_[2].weights(k)[sample[2] - begin_[2]] * layer;
  }
  return sum;
}

// One axis after the other: `below` numbers side by side are of one node along the axis.
std::vector<double> NodeGrid::at_nodes_of(const NodeGrid& part, std::span<const double> values) const {
  std::vector<double> numbers(values.begin(), values.end()), next;
  std::size_t below = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t nodes = size(axis), above = numbers.size() / (nodes * below);
    const std::span<const std::size_t> of_part = part.along_[axis].nodes();
    next.assign(above * of_part.size() * below, 0.0);
    for (std::size_t n = 0; n < of_part.size(); ++n) {
      const std::size_t sample = part.begin_[axis] + of_part[n] - begin_[axis];
      for (std::size_t node = 0; node < nodes; ++node) {
        const double weight = along_[axis].weights(node)[sample];
        for (std::size_t a = 0; a < above; ++a) {
          const double* const from = &numbers[(a * nodes + node) * below];
          double* const to = &next[(a * of_part.size() + n) * below];
          for (std::size_t i = 0; i < below; ++i) to[i] += weight * from[i];
        }
      }
    }
    std::swap(numbers, next);
    below *= of_part.size();
  }
  return numbers;
}

void NodeGrid::interpolate(std::span<const double> values, const SampleBox& part, std::size_t z,
                           const MatrixKernel& matrices, LayerValues& out) const {
  const AxisNodes &x = along_[0], &y = along_[1];
  const std::size_t nx = size(0), ny = size(1), rows = part.side(1);
  out.layer.assign(ny * nx, 0.0);
  for (std::size_t n = 0; n < size(2); ++n) {
    const double weight = along_[2].weights(n)[z - begin_[2]];
    for (std::size_t i = 0; i < out.layer.size(); ++i) out.layer[i] += weight * values[n * out.layer.size() + i];
  }
  out.nodes.assign(rows * nx, 0.0);
  for (std::size_t n = 0; n < ny; ++n) {
    for (std::size_t j = 0; j < rows; ++j) {
      const double weight = y.weights(n)[part.begin[1] - begin_[1] + j];
      for (std::size_t i = 0; i < nx; ++i) out.nodes[j * nx + i] += weight * out.layer[n * nx + i];
    }
  }
  out.width = padded_to_lanes(part.side(0));
  out.values.resize(rows * out.width);
  matrices.multiply({out.nodes.data(), nx, 1}, {x.weights(0).data() + (part.begin[0] - begin_[0]), x.row_size()},
                    {out.values.data(), out.width}, rows, nx, out.width);
}

}  // namespace raycone
