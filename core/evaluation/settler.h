// Values that are moved to the side of a critical value on which winding numbers are.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/boundary/sample_tile.h"
#include "core/evaluation/scaled_mesh.h"

namespace raycone {

// Of an open mesh. Needs DefaultFloatingPoint; not thread-safe.
class Settler {
 public:
  // `values`: as the mesh's set_values() sets them. They are moved as Boundary::settle() says.
  Settler(const ScaledMesh& mesh, double critical, std::span<double> values)
      : mesh_(mesh), critical_(critical), values_(values) {}

  // The value with that index is one of the query, and is settled by evaluate(), which this calls now and then.
  void add(std::size_t index, const Vec3& scaled_query) {
    indices_[samples_.count] = index;
    samples_.add(scaled_query);
    if (samples_.count == kTile) evaluate();
  }

  void evaluate();

 private:
  const ScaledMesh& mesh_;
  double critical_;
  std::span<double> values_;
  SampleTile samples_;
  std::array<std::size_t, kTile> indices_;
};

}  // namespace raycone
