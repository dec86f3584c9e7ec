#include "core/surface/face_points.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/machine/first_touch.h"
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

// Whether the surface is bent between the two points.
bool disagree(const FaceEdges& face, double tolerance, double margin) {
  const EdgePoint &p = *face.points[0], &q = *face.points[1];
  if (p.source == q.source) return false;
  const Vec3 step = q.position - p.position;
  const Vec3 first = face.corners[1] - face.corners[0], second = face.corners[2] - face.corners[0];
  const double moved = 2.0 * margin * std::sqrt(std::max(dot(first, first), dot(second, second)));
  // Where one of the points lies on both planes, so does the straight line between them on one.
  const double same = tolerance + moved;
  return (p.source == kHole || std::abs(dot(p.normal, step)) > same) &&
         (q.source == kHole || std::abs(dot(q.normal, step)) > same);
}

// Where the planes at the two points meet in the face's plane.
std::optional<Vec3> meeting_point(const FaceEdges& face, double margin) {
  const EdgePoint &p = *face.points[0], &q = *face.points[1];
  if (p.source == kHole || q.source == kHole) return std::nullopt;
  const Vec3 first = face.corners[1] - face.corners[0], second = face.corners[2] - face.corners[0];
  const double pu = dot(p.normal, first), pv = dot(p.normal, second), pw = dot(p.normal, p.position - face.corners[0]);
  const double qu = dot(q.normal, first), qv = dot(q.normal, second), qw = dot(q.normal, q.position - face.corners[0]);
  const double determinant = pu * qv - pv * qu;
  const double u = (pw * qv - pv * qw) / determinant, v = (pu * qw - pw * qu) / determinant;
  return inside_face(face.corners, {1.0 - u - v, u, v}, margin);
}

// The point of a crease in the face that is farthest from the straight line between the two points.
std::optional<Vec3> crease_point(const FaceEdges& face, CreasesHere& creases, double margin) {
  const auto& [low, middle, high] = face.corners;
  const std::optional<Vec3> hit =
      creases.farthest_hit(face.corners, face.points[0]->position, face.points[1]->position);
  if (!hit) return std::nullopt;
  const Vec3 first = middle - low, second = high - low, normal = cross(first, second), from = *hit - low;
  const double size = dot(normal, normal);
  const double u = dot(cross(from, second), normal) / size, v = dot(cross(first, from), normal) / size;
  // Next to the border a point of an edge is as good, and there are no needles.
  constexpr double kBorder = 16.0;  // margins
  if (std::min({1.0 - u - v, u, v}) < kBorder * margin) return std::nullopt;
  return inside_face(face.corners, {1.0 - u - v, u, v}, margin);
}

// Where planes meet on a crease, that is the point: it is in both planes as well as numbers can tell.
std::optional<Vec3> face_point(const FaceEdges& face, CreasesHere& creases, double near, double margin) {
  const std::optional<Vec3> meeting = meeting_point(face, margin);
  if (meeting && creases.has_hit_near(face.corners, *meeting, near)) return meeting;
  return crease_point(face, creases, margin);
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

FacePoints::FacePoints(const SurfaceCells& cells, std::span<const EdgePoint> edge_points, const CellCreases& creases,
                       double tolerance, const SurfaceMargins& margins) {
  // The margin and rounding move points off the mesh by less than this.
  const Vec3& h = cells.lattice().spacing;
  const double near = 4.0 * (tolerance + margins.inner * std::max({h.x, h.y, h.z}));
  constexpr std::size_t kCellsPerPart = 512;
  std::vector<std::vector<FacePoint>> parts((cells.cells().size() + kCellsPerPart - 1) / kCellsPerPart);
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    CreasesHere creases_here(creases);
    const std::size_t last_cell = std::min(end * kCellsPerPart, cells.cells().size());
    for (auto cell = static_cast<std::uint32_t>(begin * kCellsPerPart); cell < last_cell; ++cell) {
      creases_here.enter(cell);
      for (std::size_t face = 0; face < kuhn::kFaces.size(); ++face) {
        const auto edges = mixed_edges(cells, edge_points, cell, kuhn::kFaces[face]);
        if (!edges || !disagree(*edges, tolerance, margins.inner)) continue;
        const auto point = face_point(*edges, creases_here, near, margins.inner);
        if (point) parts[cell / kCellsPerPart].push_back({std::uint64_t{16} * cell + face, *point});
      }
    }
  });
  std::vector<std::size_t> places;
  std::size_t count = 0;
  for (const std::vector<FacePoint>& part : parts) {
    places.push_back(count);
    count += part.size();
  }
  auto faces = sized_on_all_threads<std::uint64_t>(count);
  auto positions = sized_on_all_threads<Vec3>(count);
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      for (std::size_t i = 0; i < parts[n].size(); ++i) {
        faces[places[n] + i] = parts[n][i].face;
        positions[places[n] + i] = parts[n][i].position;
      }
      parts[n] = {};
    }
  });
  *this = FacePoints(std::move(faces), std::move(positions));
}

FacePoints::FacePoints(std::vector<std::uint64_t> faces, std::vector<Vec3> positions)
    : faces_(std::move(faces)), positions_(std::move(positions)) {
  const std::size_t cells = faces_.empty() ? 0 : faces_.back() / 16 + 1;
  first_of_cell_.resize(cells + 1, 0);
  faces_of_cell_.resize(cells, 0);
  for (const std::uint64_t face : faces_) {
    ++first_of_cell_[face / 16 + 1];
    faces_of_cell_[face / 16] = static_cast<std::uint16_t>(faces_of_cell_[face / 16] | 1U << face % 16);
  }
  for (std::size_t cell = 0; cell < cells; ++cell) first_of_cell_[cell + 1] += first_of_cell_[cell];
}

std::optional<std::uint32_t> FacePoints::find(std::uint32_t cell, std::size_t face) const {
  if (cell >= faces_of_cell_.size() || (faces_of_cell_[cell] >> face & 1U) == 0) return std::nullopt;
  std::uint32_t n = first_of_cell_[cell];
  while (faces_[n] % 16 != face) ++n;
  return n;
}

FacePoints FacePoints::without(const std::vector<bool>& dropped) const {
  std::vector<std::uint64_t> faces;
  std::vector<Vec3> positions;
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    if (dropped[i]) continue;
    faces.push_back(faces_[i]);
    positions.push_back(positions_[i]);
  }
  return {std::move(faces), std::move(positions)};
}

}  // namespace raycone
