// The model parts of a 3MF package: objects and what is to be built of them.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "io/files/zip_reader.h"
#include "io/mesh/affine_map.h"

namespace raycone {

// An object that stands somewhere: a component of another, or an item of the build.
struct ThreeMfUse {
  std::string part;  // where the object is
  std::uint32_t object = 0;
  AffineMap placement;
};

struct ThreeMfObject {
  std::string name;  // may be empty
  TriangleMesh mesh;
  std::vector<ThreeMfUse> components;
  bool is_sliced = false;      // it has slices, which may be all that it has
  std::uint64_t lattices = 0;  // of beams, which are passed over
};

struct ThreeMfModel {
  std::string unit;               // of the root part: "millimeter" where it names none
  std::vector<ThreeMfUse> items;  // of the root part, in order
  std::map<std::uint32_t, ThreeMfObject> objects;
};

// The name of the root model's part. Throws InputError where `archive` is no 3MF, and where it is encrypted.
[[nodiscard]] std::string three_mf_root(const ZipReader& archive, const std::string& file);

// Reads a model part; names of parts have no leading '/'. Throws InputError where it is invalid, damaged or needs an
// extension that changes shapes and is not known; and LimitError. All indices of triangles are in range, all
// coordinates finite.
[[nodiscard]] ThreeMfModel read_three_mf_model(const ZipReader& archive, const std::string& part,
                                               const std::string& file);

}  // namespace raycone
