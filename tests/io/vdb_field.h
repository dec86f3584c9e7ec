// Fields that the tests of VDB files write.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "core/data/lattice.h"
#include "io/fields/field_writer.h"
#include "tests/support/output_checks.h"

namespace raycone::test {

// On all samples of a lattice, x fastest.
struct VdbField {
  Lattice lattice;
  std::vector<double> values;
};

// A field on an anisotropic lattice whose indices start and end inside leaf blocks, on either side of 0.
inline VdbField field_of(const std::array<std::int64_t, 3>& counts,
                         const std::function<double(std::int64_t, std::int64_t, std::int64_t)>& value) {
  VdbField field;
  field.lattice = {{0.1, -20.7, 1e-3}, {0.1, 0.3, 1.0 / 3}, {-13, -3, -21}, counts};
  for (std::int64_t z = 0; z < counts[2]; ++z) {
    for (std::int64_t y = 0; y < counts[1]; ++y) {
      for (std::int64_t x = 0; x < counts[0]; ++x) field.values.push_back(value(x, y, z));
    }
  }
  return field;
}

// 0 outside a ball, 1 inside, random between: leaves, tiles and nothing, all in one grid.
inline VdbField ball_field() {
  std::mt19937 random(1);
  return field_of({70, 65, 66}, [&](auto x, auto y, auto z) {
    const double r = std::hypot(static_cast<double>(x) - 35, static_cast<double>(y) - 32, static_cast<double>(z) - 33);
    return r < 20 ? 1.0 : r > 25 ? 0.0 : std::uniform_real_distribution<double>(0, 1)(random);
  });
}

inline OutputDescription described_mesh() {
  OutputDescription description;
  description.mesh = "bunny.obj";
  description.mesh_sha256 = "0123456789abcdef";
  description.faces = 5'000'000'000;  // beyond 32 bits
  return description;
}

inline void write_vdb(const std::string& path, const VdbField& field,
                      const OutputDescription& description = described_mesh(), std::int64_t thickness = 8) {
  OutputFile output(path);
  write_in_slabs(FieldFormat::kVdb, output, field.lattice, description, field.values, thickness, {7, 9, 42});
}

}  // namespace raycone::test
