// Harmonic polynomials from values on the faces of a cube.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/data/vec3.h"
#include "core/far/harmonic_polynomial.h"
#include "core/far/matrix_kernel.h"

namespace raycone {

// Of each harmonic function, the harmonic polynomial of total degree kDegree that is closest to it at the nodes, in the
// sense of least squares. The nodes are Chebyshev points on the faces of the cube. A harmonic polynomial of that degree
// is its own fit. What becomes of others: core/far/harmonic_error.h. Thread-safe.
class HarmonicFit {
 public:
  static constexpr std::size_t kNodesAlong = 12;  // a side of a face
  static constexpr std::size_t kNodes = 6 * kNodesAlong * kNodesAlong;
  static constexpr std::size_t kTogether = 8;  // functions that are fitted at a time

  // Made when first asked for, in about a millisecond.
  [[nodiscard]] static const HarmonicFit& instance();

  // Node n on the cube around 0 with half side 1.
  [[nodiscard]] const Vec3& node(std::size_t n) const { return nodes_[n]; }

  // The value of function f at node n is values[n * kTogether + f]. Sets the first polynomials.size() of kTogether.
  void fit(std::span<const double> values, std::span<Coefficients> polynomials, const MatrixKernel& kernel) const;

  // No value of a fit exceeds kLargestWeights times the largest magnitude at the nodes. A fit rounds by at most
  // kRounding times that magnitude: measured (tests/core/lattice_blocks_test.cpp), not proved.
  static constexpr double kLargestWeights = 27.5;
  static constexpr double kRounding = 4e-12;

  // The least squares of one parity, by a basis that is orthonormal at the nodes.
  struct Kind {
    struct Group {
      std::size_t first_row, terms;
    };
    std::size_t rows = 0;          // of the basis
    std::vector<double> to_basis;  // a row per function of the basis, a column per node of an octant
    std::vector<double> to_terms;  // a row per coefficient, a column per function
    std::vector<Group> groups;     // of coefficients one after the other, which depend on no function before first_row
  };

 private:
  HarmonicFit();
  void set_nodes();

  // Functions that are even or odd along each axis: the values at the nodes of an octant tell the coefficients of like
  // parity.
  struct ParityClass {
    std::size_t kind;
    std::vector<std::size_t> nodes;   // of the octant, in the kind's order
    std::vector<std::size_t> places;  // of the coefficients, likewise
  };

  static constexpr std::size_t kOctant = kNodes / 8;

  std::array<Vec3, kNodes> nodes_;  // those of the first octant, then their mirror images
  std::array<Kind, 4> kinds_;
  std::array<ParityClass, 8> classes_;
};

}  // namespace raycone
