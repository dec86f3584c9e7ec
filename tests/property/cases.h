// Generated meshes and queries that try to break the evaluator.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "tests/support/shapes.h"

namespace raycone::test {

struct Case {
  std::string family;
  TriangleMesh mesh;  // welded
  std::vector<Vec3> queries;
};

[[nodiscard]] std::size_t family_count();

// A random member of a family, its mesh moved, stretched and scaled at random; the same for the same arguments.
[[nodiscard]] Case make_case(std::size_t family, std::uint64_t seed);

}  // namespace raycone::test
