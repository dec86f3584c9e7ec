// Polynomials between samples of a lattice.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace raycone {

// Samples along one axis between some of which, the nodes, there is the polynomial of least degree through their
// values.
class AxisNodes {
 public:
  // Of at least one sample, by ascending coordinates. The nodes are about Chebyshev's, degree + 1 of them; all samples
  // where these are as few.
  AxisNodes(std::span<const double> coordinates, std::size_t degree);

  // Ascending numbers of samples.
  [[nodiscard]] std::span<const std::size_t> nodes() const { return nodes_; }
  [[nodiscard]] std::size_t degree() const { return nodes_.size() - 1; }
  // The value at sample i is the sum of weight(n)[i] times that at node n. Zeros fill the rows up to multiples of 8.
  [[nodiscard]] std::span<const double> weights(std::size_t node) const {
    return std::span(weights_).subspan(node * row_size_, row_size_);
  }
  [[nodiscard]] std::size_t row_size() const { return row_size_; }

  // What values at samples are off by is at most this times what those at nodes are off by: the largest sum of the
  // magnitudes of a sample's weights. Infinite where nodes have equal coordinates.
  [[nodiscard]] double growth() const { return growth_; }
  // The polynomial of a function whose derivatives of order degree() + 1 are at most `derivative` times the factorial
  // of this order is off by at most this at samples.
  [[nodiscard]] double error(double derivative) const;

 private:
  std::vector<std::size_t> nodes_;
  std::vector<double> weights_;
  std::size_t row_size_;
  double growth_ = 1.0;
  double product_ = 0.0;  // the largest one of a sample's distances from the nodes; 0 if all samples are nodes
};

}  // namespace raycone
