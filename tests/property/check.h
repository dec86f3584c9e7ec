// Checks of one mesh and its queries against definitions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone::test {

struct Failure {
  Vec3 query;
  std::string what;
};

struct CheckCounts {
  std::uint64_t values = 0;
  std::uint64_t on_surface = 0;
  std::uint64_t degenerate = 0;  // values with ties
  std::uint64_t undecided = 0;   // on the surface within 1e-30 of another vertex's coordinate: no step tells
};

// What the evaluator says of one query.
struct Answer {
  double value = 0;
  std::int64_t degenerate = 0;
  bool on_surface = false;
  double error_bound = 0;

  friend bool operator==(const Answer&, const Answer&) = default;
};

// The same query in each of the ways there are.
struct Answers {
  Vec3 query;
  Answer grid, passes, embree, over_triangles;
  bool closed = false;  // the mesh, for the evaluator
};

[[nodiscard]] std::vector<Answers> answers_of(const TriangleMesh& welded, const std::vector<Vec3>& queries);

// What is wrong with the answers of a query by their definitions on the mesh, see check().
[[nodiscard]] std::optional<std::string> wrong(const TriangleMesh& mesh, const Answers& answers, CheckCounts& counts);

// For each query: the value is the direct sum in 113 to 3000 bits within the value's own error bound (on the surface:
// the sum at the query moved as the symbolic perturbation has it), and that bound is below 1e-12; the value is an
// integer with bound 0 if the mesh is closed; on_surface and degenerate are what their definitions give, in integer
// arithmetic. Passes over the triangles and Embree say the same to the bit, the sum over triangles within both bounds.
// Nothing where all holds.
[[nodiscard]] std::optional<Failure> check(const TriangleMesh& welded, const std::vector<Vec3>& queries,
                                           CheckCounts* counts = nullptr);

// A part of the mesh that still fails at the failure's query, smaller by dropping faces one by one while that is
// possible.
[[nodiscard]] TriangleMesh shrink(TriangleMesh mesh, const Vec3& query);

// The case as text: an OBJ file with the query and the failure as comments.
[[nodiscard]] std::string describe(const TriangleMesh& mesh, const Failure& failure);

}  // namespace raycone::test
