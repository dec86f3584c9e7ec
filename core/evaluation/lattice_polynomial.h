// Polynomials between samples of a lattice.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/crossings/lattice_rows.h"
#include "core/data/sample_box.h"
#include "core/far/matrix_kernel.h"

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

// What a NodeGrid sets, and its scratch.
struct LayerValues {
  std::size_t width = 0;
  std::vector<double> values;        // of the rows along x, `width` apart
  std::vector<double> layer, nodes;  // of all nodes along x and y, and of those along x of each row
};

// Samples of a box that polynomials are put through, one axis after the other.
class NodeGrid {
 public:
  // Polynomials of these degrees along the axes, of a function whose derivatives of order k along any axis are at most
  // derivatives[k - 1] times the factorial of k.
  NodeGrid(const LatticeRows& rows, const SampleBox& box, const std::array<std::size_t, 3>& degrees,
           std::span<const double> derivatives);

  [[nodiscard]] std::size_t size() const { return size(0) * size(1) * size(2); }
  // Numbers of samples, x fastest: the order of values at nodes.
  [[nodiscard]] std::vector<std::array<std::size_t, 3>> nodes() const;

  // What is interpolated is off by at most this, beside growth() times what values at nodes are off by.
  [[nodiscard]] double bend() const { return bend_; }
  [[nodiscard]] double growth() const { return growth_; }

  // The value at a sample of the box; `values` at nodes.
  [[nodiscard]] double at(std::span<const double> values, const std::array<std::size_t, 3>& sample) const;

  // The values at the nodes of a part of the box, in their order.
  [[nodiscard]] std::vector<double> at_nodes_of(const NodeGrid& part, std::span<const double> values) const;

  // Sets out.values to those of the samples (x, y, z) of `part`, row by row. The part begins a multiple of 8 samples
  // behind the box along x.
  void interpolate(std::span<const double> values, const SampleBox& part, std::size_t z, const MatrixKernel& matrices,
                   LayerValues& out) const;

 private:
  [[nodiscard]] std::size_t size(std::size_t axis) const { return along_[axis].nodes().size(); }

  std::array<std::size_t, 3> begin_;  // of the box
  std::vector<AxisNodes> along_;
  double bend_ = 0.0, growth_ = 1.0;
};

}  // namespace raycone
