#include "core/surface/face_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

#include "core/machine/threads.h"

namespace raycone {
namespace {

struct FacePoint {
  std::uint64_t face;
  Vec3 position;
};

// The mixed edges of a face: two of its three.
struct FaceEdges {
  std::array<Vec3, 3> corners;
  std::array<const EdgePoint*, 2> points;
};

std::optional<FaceEdges> mixed_edges(const SurfaceCells& cells, std::span<const EdgePoint> points, std::uint32_t n,
                                     const kuhn::FaceDirections& face) {
  const SurfaceCell& cell = cells.cells()[n];
  const bool low = cell.is_inside(0), middle = cell.is_inside(face.first), high = cell.is_inside(face.second);
  if (low == middle && low == high) return std::nullopt;
  FaceEdges edges{{cells.corner(cell, 0), cells.corner(cell, face.first), cells.corner(cell, face.second)}, {}};
  std::size_t next = 0;
  if (low != middle) edges.points[next++] = &points[cell.edge(face.first)];
  if (low != high) edges.points[next++] = &points[cell.edge(face.second)];
  if (middle != high) {
    const SurfaceCell& other = cells.cells()[cells.cell_at(n, face.first)];
    edges.points[next++] = &points[other.edge(face.second ^ face.first)];
  }
  return edges;
}

// Barycentric coordinates that are within the face, but for rounding, are moved into it.
std::optional<Vec3> inside_face(const std::array<Vec3, 3>& corners, std::array<double, 3> weights, double margin) {
  constexpr double kRounding = 1e-9;
  double sum = 0.0;
  for (double& weight : weights) {
    if (!(weight >= -kRounding)) return std::nullopt;
    weight = std::max(weight, margin);
    sum += weight;
  }
  const Vec3 first = corners[1] - corners[0], second = corners[2] - corners[0];
  return corners[0] + (weights[1] / sum) * first + (weights[2] / sum) * second;
}

// Where the planes at the two points meet in the face's plane.
std::optional<Vec3> meeting_point(const FaceEdges& face, double tolerance, double margin) {
  const EdgePoint &p = *face.points[0], &q = *face.points[1];
  if (p.source == kHole || q.source == kHole || p.source == q.source) return std::nullopt;
  const Vec3 step = q.position - p.position;
  const Vec3 first = face.corners[1] - face.corners[0], second = face.corners[2] - face.corners[0];
  const double moved = 2.0 * margin * std::sqrt(std::max(dot(first, first), dot(second, second)));
  // Where one of the points lies on both planes, so does the straight line between them on one.
  const double same = tolerance + moved;
  if (std::abs(dot(p.normal, step)) <= same || std::abs(dot(q.normal, step)) <= same) return std::nullopt;
  const double pu = dot(p.normal, first), pv = dot(p.normal, second), pw = dot(p.normal, p.position - face.corners[0]);
  const double qu = dot(q.normal, first), qv = dot(q.normal, second), qw = dot(q.normal, q.position - face.corners[0]);
  const double determinant = pu * qv - pv * qu;
  const double u = (pw * qv - pv * qw) / determinant, v = (pu * qw - pw * qu) / determinant;
  return inside_face(face.corners, {1.0 - u - v, u, v}, margin);
}

}  // namespace

double plane_tolerance(const TriangleMesh& mesh, const Lattice& lattice) {
  const Vec3& h = lattice.spacing;
  double largest = 0.0;
  bool single = true;
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t corner : t) {
      const Vec3& p = mesh.vertices[corner];
      for (int axis = 0; axis < 3; ++axis) {
        largest = std::max(largest, std::abs(p[axis]));
        single = single && std::abs(p[axis]) < 0x1p127 && static_cast<double>(static_cast<float>(p[axis])) == p[axis];
      }
    }
  }
  constexpr double kVoxels = 1e-9, kSingle = 0x1p-22, kDouble = 0x1p-50;
  return std::max(kVoxels * std::min({h.x, h.y, h.z}), (single ? kSingle : kDouble) * largest);
}

FacePoints::FacePoints(const SurfaceCells& cells, std::span<const EdgePoint> edge_points,
                       const DistanceEvaluator& distance, double tolerance, const SurfaceMargins& margins) {
  std::vector<FacePoint> candidates;
  std::mutex mutex;
  parallel_for(cells.cells().size(), 256, [&](std::size_t begin, std::size_t end) {
    std::vector<FacePoint> found;
    for (std::size_t cell = begin; cell < end; ++cell) {
      for (std::size_t face = 0; face < kuhn::kFaces.size(); ++face) {
        const auto edges = mixed_edges(cells, edge_points, static_cast<std::uint32_t>(cell), kuhn::kFaces[face]);
        const auto point = edges ? meeting_point(*edges, tolerance, margins.inner) : std::nullopt;
        if (point) found.push_back({16 * cell + face, *point});
      }
    }
    const std::scoped_lock lock(mutex);
    candidates.insert(candidates.end(), found.begin(), found.end());
  });
  std::ranges::sort(candidates, {}, &FacePoint::face);
  std::vector<Vec3> positions;
  for (const FacePoint& candidate : candidates) positions.push_back(candidate.position);
  std::vector<double> distances(positions.size());
  if (!positions.empty()) distance.evaluate(positions, distances);
  // The margin and rounding move points off the mesh by less than this.
  const Vec3& h = cells.lattice().spacing;
  const double near = 4.0 * (tolerance + margins.inner * std::max({h.x, h.y, h.z}));
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!(distances[i] <= near)) continue;
    faces_.push_back(candidates[i].face);
    positions_.push_back(positions[i]);
  }
}

std::optional<std::uint32_t> FacePoints::find(std::uint32_t cell, std::size_t face) const {
  const std::uint64_t wanted = std::uint64_t{16} * cell + face;
  const auto found = std::ranges::lower_bound(faces_, wanted);
  if (found == faces_.end() || *found != wanted) return std::nullopt;
  return static_cast<std::uint32_t>(found - faces_.begin());
}

FacePoints FacePoints::without(const std::vector<bool>& dropped) const {
  FacePoints left;
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    if (dropped[i]) continue;
    left.faces_.push_back(faces_[i]);
    left.positions_.push_back(positions_[i]);
  }
  return left;
}

}  // namespace raycone
