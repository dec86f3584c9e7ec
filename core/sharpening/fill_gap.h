// Gaps of a surface filled by planes of the mesh.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/data/coordinate_precision.h"
#include "core/data/triangle_mesh.h"
#include "core/distance/distance.h"

namespace raycone {

// What is around a gap: a simple loop, in the direction in which the gap's faces run along it. Side i leads from corner
// i to the next one; the face behind it is the one beyond the gap.
struct GapLoop {
  std::vector<Vec3> corners;
  std::vector<std::int32_t> sources;  // of the face behind each side, in whose plane the side is
  std::vector<Vec3> fronts;           // of these faces: a normal of any length
};

struct GapFill {
  std::vector<Triangle> triangles;  // of corners of the loop, and after these the new ones
  std::vector<std::int32_t> sources;
  std::vector<Vec3> corners;  // new ones
};

// Whether all points are within `off` of the mesh that `distance` is from.
[[nodiscard]] bool are_on_mesh(std::span<const Vec3> points, const DistanceEvaluator& distance, double off);

struct GapLimits {
  double off = 0.0;    // how far points of one plane are from it at most, world units
  double reach = 0.0;  // how far new corners may be from corners of the loop, likewise
  std::size_t new_corners = 0;
  CoordinatePrecision precision = CoordinatePrecision::kDouble;  // of new corners
  std::function<bool(std::span<const Vec3>)> are_on_mesh;        // all of them
};

// Fills a gap with the planes behind its loop, continued until they meet: two planes along a straight line between
// corners of the loop that are in both, three in a new corner. Nothing where that leads off the mesh, needs more new
// corners than allowed, or would fold a plane. Whether triangles of different planes meet, or meet other faces, is not
// looked at.
[[nodiscard]] std::optional<GapFill> fill_gap(const GapLoop& loop, const TriangleMesh& input, const GapLimits& limits);

// Fills a gap around a corner of the mesh with sectors of the planes behind its loop, which meet in that corner, the
// one new one. Nothing where the corner is not in all these planes, or where the sectors lead off the mesh or would
// have to be folded. `limits.reach` only says how closely lines and triangles are looked at.
[[nodiscard]] std::optional<GapFill> fill_gap_from(const Vec3& corner, const GapLoop& loop, const TriangleMesh& input,
                                                   const GapLimits& limits);

}  // namespace raycone
