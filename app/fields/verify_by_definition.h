// Some samples of a run computed again by definition, as direct sums over all triangles and as distances to each of
// them (core/exact/direct_sum.h, core/exact/direct_distance.h), and compared with the numbers that the run has.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>

#include "app/fields/named_numbers.h"
#include "app/fields/sample_draw.h"
#include "app/report/run_report.h"
#include "core/data/rule.h"
#include "core/data/triangle_mesh.h"
#include "core/data/vec3.h"

namespace raycone {

// A value is wrong: exit status 6. what() is one line that names the sample, both values and the bound.
class VerificationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Throws VerificationError: the sample of the mesh file `name` has this number, `but`.
[[noreturn]] void throw_wrong(const std::string& name, const DrawnSample& sample, const NamedNumber& number,
                              const std::string& but);

// Whether the rule holds for `mesh` at `point`, by its winding number as the direct sum; nothing where that is not
// known well enough to tell.
[[nodiscard]] std::optional<bool> inside_by_definition(const TriangleMesh& mesh, const Vec3& point, const Rule& rule);

// What the numbers of a run are about.
struct VerifiedMeshes {
  const TriangleMesh& mesh;
  const TriangleMesh* solid = nullptr;  // the closed surface that solid distances are to, where they are wanted
};

// What the numbers of a run have to keep to.
struct Expectations {
  double accuracy = 1e-10;  // of winding numbers and densities, turns
  Rule rule;
  double band_width = std::numeric_limits<double>::infinity();  // where distances are cut off, world units
  std::span<const double> error_bounds{};                       // of the samples' winding numbers, where there are any
};

// Compares `samples` with what the meshes are by definition, on the threads that ThreadLimit allows: some 2.7 us per
// triangle and sample, 9 us with a gradient. A winding number or density may be off by the accuracy, whether or not the
// query is on the surface; inside and the sign of a distance must be what the rule says of the true winding number, a
// number that cannot be told from its threshold (kIndistinguishable) counting as reaching it; a distance may be off by
// 1e-12 of itself and the mesh's size, or by 4 roundings of the coordinates; a gradient by 1e-11 of the lengths of what
// the sides of all triangles add to it. Throws VerificationError about the first sample that is wrong. `name`: the file
// concerned.
[[nodiscard]] Verification verify_by_definition(const std::string& name, const VerifiedMeshes& meshes,
                                                std::span<const DrawnSample> samples, const Expectations& expectations);

}  // namespace raycone
