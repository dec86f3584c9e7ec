#include "core/contour/face_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/cells/plane_tolerance.h"
#include "core/machine/first_touch.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

constexpr double kBorder = 16.0;  // margins: next to the border a point of an edge is as good, and there are no needles

// Of one face, and the triangles between them.
struct PointsOfFace {
  std::array<Vec3, CreasesHere::Section::kMost> positions{};
  std::array<std::uint32_t, CreasesHere::Section::kMost> beyond{};
  std::size_t size = 0;

  void add(const Vec3& p, std::uint32_t triangle) {
    positions[size] = p;
    beyond[size++] = triangle;
  }
};

// The mixed edges of a face: two of its three.
struct FaceEdges {
  Corners3 corners;
  std::array<const EdgePoint*, 2> points;
  std::array<Vec3, 2> normals;
};

// Nothing where the points of both edges are of one source: the surface is not bent there.
std::optional<FaceEdges> edges_of_two(const SurfaceInCells& surface, std::uint32_t n,
                                      const kuhn::FaceDirections& face) {
  const SurfaceCells& cells = surface.cells;
  const std::span<const EdgePoint> points = surface.edge_points;
  const SurfaceCell& cell = cells.cells()[n];
  const bool low = cell.is_inside(0), middle = cell.is_inside(face.first), high = cell.is_inside(face.second);
  if (low == middle && low == high) return std::nullopt;
  std::array<const EdgePoint*, 2> mixed{};
  std::size_t next = 0;
  if (low != middle) mixed[next++] = &points[cell.edge(face.first)];
  if (low != high) mixed[next++] = &points[cell.edge(face.second)];
  if (middle != high) {
    const SurfaceCell& other = cells.cells()[cells.cell_at(n, face.first)];
    mixed[next++] = &points[other.edge(face.second ^ face.first)];
  }
  if (mixed[0]->source == mixed[1]->source) return std::nullopt;
  return FaceEdges{{cells.corner(cell, 0), cells.corner(cell, face.first), cells.corner(cell, face.second)},
                   mixed,
                   {surface.creases.normal_of(mixed[0]->source), surface.creases.normal_of(mixed[1]->source)}};
}

// Barycentric coordinates that are within the face, but for rounding, are moved into it.
std::optional<Vec3> inside_face(const Corners3& corners, std::array<double, 3> weights, double margin) {
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

// What points of a plane may be off it, where creases of these kinds count.
double tolerance_of(const SurfaceInCells& surface, CreaseKinds kinds) {
  if (kinds == CreaseKinds::kNotFine) return surface.tolerance;
  return std::min(surface.tolerance, fine_tolerance(surface.cells.lattice()));
}

// Whether the surface is bent between the two points, of different sources.
bool disagree(const FaceEdges& face, const SurfaceInCells& surface, CreaseKinds kinds) {
  const EdgePoint &p = *face.points[0], &q = *face.points[1];
  const Vec3 step = q.position - p.position;
  const Vec3 first = face.corners[1] - face.corners[0], second = face.corners[2] - face.corners[0];
  const double moved = 2.0 * surface.margin * std::sqrt(std::max(dot(first, first), dot(second, second)));
  // Where one of the points lies on both planes, so does the straight line between them on one.
  const double same = tolerance_of(surface, kinds) + moved;
  return (p.source == kHole || std::abs(dot(face.normals[0], step)) > same) &&
         (q.source == kHole || std::abs(dot(face.normals[1], step)) > same);
}

// Where the planes at the two points meet in the face's plane.
std::optional<Vec3> meeting_in_face(const FaceEdges& face, double margin) {
  const EdgePoint &p = *face.points[0], &q = *face.points[1];
  if (p.source == kHole || q.source == kHole) return std::nullopt;
  const Vec3 first = face.corners[1] - face.corners[0], second = face.corners[2] - face.corners[0];
  const auto& [m, n] = face.normals;
  const double pu = dot(m, first), pv = dot(m, second), pw = dot(m, p.position - face.corners[0]);
  const double qu = dot(n, first), qv = dot(n, second), qw = dot(n, q.position - face.corners[0]);
  const double determinant = pu * qv - pv * qu;
  const double u = (pw * qv - pv * qw) / determinant, v = (pu * qw - pw * qu) / determinant;
  return inside_face(face.corners, {1.0 - u - v, u, v}, margin);
}

// A point of a crease in the face, if it is not next to the border.
std::optional<Vec3> within_face(const FaceEdges& face, const Vec3& hit, double margin) {
  const auto& [low, middle, high] = face.corners;
  const Vec3 first = middle - low, second = high - low, normal = cross(first, second), from = hit - low;
  const double size = dot(normal, normal);
  const double u = dot(cross(from, second), normal) / size, v = dot(cross(first, from), normal) / size;
  if (std::min({1.0 - u - v, u, v}) < kBorder * margin) return std::nullopt;
  return inside_face(face.corners, {1.0 - u - v, u, v}, margin);
}

// Where the mesh leads from one point to the other by way of other triangles: the points of the creases in between.
// Each must be farther along the straight line between the two than the one before, so that lines between them do not
// cross.
PointsOfFace section_points(const FaceEdges& face, CreasesHere& creases, const SurfaceInCells& surface) {
  constexpr double kAhead = 32.0;  // margins
  const EdgePoint &p = *face.points[0], &q = *face.points[1];
  if (p.source == kHole || q.source == kHole) return {};
  const CreasesHere::Section section =
      creases.section(face.corners, static_cast<std::uint32_t>(p.source), static_cast<std::uint32_t>(q.source));
  const Vec3 along = q.position - p.position;
  const double least = kAhead * surface.largest_margin() * std::sqrt(dot(along, along));
  PointsOfFace points;
  const Vec3* last = &p.position;
  for (std::size_t n = 0; n < section.size; ++n) {
    const std::optional<Vec3> point = within_face(face, section.corners[n].position, surface.margin);
    if (!point || !(dot(*point - *last, along) > least)) return {};
    points.add(*point, section.corners[n].beyond);
    last = &points.positions[n];
  }
  return dot(q.position - *last, along) > least ? points : PointsOfFace{};
}

// The point of a crease in the face that is farthest from the straight line between the two points.
std::optional<Vec3> crease_point(const FaceEdges& face, CreasesHere& creases, double margin) {
  const std::optional<Vec3> hit =
      creases.farthest_hit(face.corners, face.points[0]->position, face.points[1]->position);
  return hit ? within_face(face, *hit, margin) : std::nullopt;
}

// Whether the planes at the points meet on a crease: there it is in both as well as numbers can tell.
std::optional<Vec3> meeting_on_crease(const FaceEdges& face, CreasesHere& creases, const SurfaceInCells& surface,
                                      CreaseKinds kinds) {
  // The margin and rounding move points off the mesh by less than this.
  const double near = 4.0 * (tolerance_of(surface, kinds) + surface.largest_margin());
  const std::optional<Vec3> meeting = meeting_in_face(face, surface.margin);
  return meeting && creases.has_hit_near(face.corners, *meeting, near, kinds) ? meeting : std::nullopt;
}

}  // namespace

std::array<std::uint32_t, 2> cells_at_face(const SurfaceCells& cells, std::uint32_t cell, std::size_t face) {
  const unsigned across = (kuhn::kCorners - 1) ^ kuhn::kFaces[face].second;
  if (across == 0) return {cell, cell};
  auto [i, j, k] = cells.cells()[cell].node;
  if (across == 1) return {cell - 1, cell};
  (across == 2 ? j : k) -= 1;
  return {cells.first_from(cells.row_begin(j, k), cells.row_end(j, k), i), cell};
}

std::optional<Vec3> face_point(const SurfaceInCells& surface, std::uint32_t cell, std::size_t face,
                               CreasesHere& creases) {
  const auto edges = edges_of_two(surface, cell, kuhn::kFaces[face]);
  if (!edges || !disagree(*edges, surface, CreaseKinds::kNotFine)) return std::nullopt;
  const std::optional<Vec3> meeting = meeting_on_crease(*edges, creases, surface, CreaseKinds::kNotFine);
  return meeting ? meeting : crease_point(*edges, creases, surface.margin);
}

FacePoints::FacePoints(const SurfaceInCells& surface, PointsOfFaces kind) : kind_(kind) {
  constexpr std::size_t kCellsPerPart = 512;
  const std::size_t count = surface.cells.cells().size();
  std::vector<FacePoints> parts((count + kCellsPerPart - 1) / kCellsPerPart);
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    CreasesHere creases(surface.creases);
    const std::size_t last_cell = std::min(end * kCellsPerPart, count);
    for (auto cell = static_cast<std::uint32_t>(begin * kCellsPerPart); cell < last_cell; ++cell) {
      creases.enter(cell);
      FacePoints& part = parts[cell / kCellsPerPart];
      for (std::size_t face = 0; face < kuhn::kFaces.size(); ++face) {
        if (kind == PointsOfFaces::kSections) {
          if (face < kuhn::kFacesBetweenCells) part.add_section(surface, cell, face, creases);
        } else if (const auto one = face_point(surface, cell, face, creases)) {
          part.add(number_of_face(cell, face), *one);
        }
      }
    }
  });
  join(parts);
}

void FacePoints::add_section(const SurfaceInCells& surface, std::uint32_t cell, std::size_t face,
                             CreasesHere& creases) {
  const auto edges = edges_of_two(surface, cell, kuhn::kFaces[face]);
  if (!edges || !disagree(*edges, surface, CreaseKinds::kAll)) return;
  const std::uint64_t number = number_of_face(cell, face);
  const bool is_bent = disagree(*edges, surface, CreaseKinds::kNotFine);
  std::optional<Vec3> one;
  if (is_bent) one = meeting_on_crease(*edges, creases, surface, CreaseKinds::kNotFine);
  if (one) {
    add(number, *one);
    return;
  }
  PointsOfFace more;
  one = meeting_on_crease(*edges, creases, surface, CreaseKinds::kAll);
  if (one) {
    more.add(*one, 0);
  } else {
    more = section_points(*edges, creases, surface);
  }
  if (more.size > 0) sections_.push_back(number);
  for (std::size_t n = 0; n < more.size; ++n) {
    if (n + 1 < more.size) {
      const auto point = static_cast<std::uint32_t>(faces_.size());
      pieces_.push_back({point, {more.positions[n], static_cast<std::int32_t>(more.beyond[n])}});
    }
    add(number, more.positions[n]);
  }
  if (more.size > 0 || !is_bent) return;
  one = crease_point(*edges, creases, surface.margin);
  if (one) add(number, *one);
}

void FacePoints::join(std::vector<FacePoints>& parts) {
  std::vector<std::size_t> places;
  std::size_t count = 0;
  for (const FacePoints& part : parts) {
    places.push_back(count);
    for (const Piece& piece : part.pieces_)
      pieces_.push_back({static_cast<std::uint32_t>(count + piece.point), piece.plane});
    sections_.insert(sections_.end(), part.sections_.begin(), part.sections_.end());
    count += part.faces_.size();
  }
  resize_on_all_threads(faces_, count);
  resize_on_all_threads(positions_, count);
  parallel_for_each(parts.size(), [&](std::size_t n) {
    std::ranges::copy(parts[n].faces_, faces_.begin() + static_cast<std::ptrdiff_t>(places[n]));
    std::ranges::copy(parts[n].positions_, positions_.begin() + static_cast<std::ptrdiff_t>(places[n]));
    parts[n] = {};
  });
  number_cells();
}

FacePoints::FacePoints(std::vector<std::uint64_t> faces, std::vector<Vec3> positions)
    : faces_(std::move(faces)), positions_(std::move(positions)) {
  number_cells();
}

void FacePoints::number_cells() {
  const std::size_t cells = faces_.empty() ? 0 : std::size_t{cell_of_face(faces_.back())} + 1;
  first_of_cell_.assign(cells + 1, 0);
  faces_of_cell_.assign(cells, 0);
  for (const std::uint64_t face : faces_) {
    const std::size_t cell = cell_of_face(face);
    ++first_of_cell_[cell + 1];
    faces_of_cell_[cell] = static_cast<std::uint16_t>(faces_of_cell_[cell] | 1U << face_in_cell(face));
  }
  for (std::size_t cell = 0; cell < cells; ++cell) first_of_cell_[cell + 1] += first_of_cell_[cell];
}

FacePoints::Range FacePoints::find(std::uint32_t cell, std::size_t face) const {
  if (cell >= faces_of_cell_.size() || (faces_of_cell_[cell] >> face & 1U) == 0) return {};
  Range range{first_of_cell_[cell], 0};
  while (face_in_cell(faces_[range.first]) != face) ++range.first;
  const std::uint32_t end = first_of_cell_[cell + 1];
  while (range.first + range.count < end && face_in_cell(faces_[range.first + range.count]) == face) ++range.count;
  return range;
}

const EdgePoint& FacePoints::piece_behind(std::uint32_t point) const {
  return std::ranges::lower_bound(pieces_, point, {}, &Piece::point)->plane;
}

void FacePoints::add_face(const FacePoints& of, std::size_t begin, std::size_t end) {
  const auto here = static_cast<std::uint32_t>(faces_.size()), first = static_cast<std::uint32_t>(begin);
  if (end - begin > 1) {  // else it has no pieces
    auto piece = std::ranges::lower_bound(of.pieces_, first, {}, &Piece::point);
    for (; piece != of.pieces_.end() && piece->point < end; ++piece)
      pieces_.push_back({here + (piece->point - first), piece->plane});
  }
  for (std::size_t n = begin; n < end; ++n) add(of.faces_[n], of.positions_[n]);
}

std::size_t FacePoints::end_of_face(std::size_t point) const {
  const std::uint64_t face = faces_[point];
  while (point < faces_.size() && faces_[point] == face) ++point;
  return point;
}

void FacePoints::keep_sections_at(const std::vector<std::uint8_t>& cells_of_polygons, const SurfaceInCells& surface) {
  constexpr std::size_t kPointsPerPart = 1024;
  std::vector<FacePoints> parts((faces_.size() + kPointsPerPart - 1) / kPointsPerPart);
  const auto is_of_polygons = [&](std::uint32_t cell) { return cells_of_polygons[cell] != 0; };
  const auto add_face_to = [&](FacePoints& part, CreasesHere& creases, std::size_t begin, std::size_t end) {
    const std::uint64_t face = faces_[begin];
    const std::uint32_t cell = cell_of_face(face);
    const bool is_section = std::ranges::binary_search(sections_, face);
    if (!is_section || std::ranges::any_of(cells_at_face(surface.cells, cell, face_in_cell(face)), is_of_polygons)) {
      if (is_section) part.sections_.push_back(face);
      part.add_face(*this, begin, end);
      return;
    }
    creases.enter(cell);
    if (const auto one = face_point(surface, cell, face_in_cell(face), creases)) part.add(face, *one);
  };
  parallel_for(parts.size(), 1, [&](std::size_t first, std::size_t last) {
    CreasesHere creases(surface.creases);
    for (std::size_t n = first; n < last; ++n) {
      std::size_t point = n * kPointsPerPart;
      if (point > 0 && faces_[point] == faces_[point - 1]) point = end_of_face(point);
      while (point < std::min((n + 1) * kPointsPerPart, faces_.size())) {
        const std::size_t end = end_of_face(point);
        add_face_to(parts[n], creases, point, end);
        point = end;
      }
    }
  });
  FacePoints left;
  left.kind_ = kind_;
  left.join(parts);
  *this = std::move(left);
}

FacePoints FacePoints::without(const std::vector<bool>& dropped) const {
  FacePoints left;
  left.kind_ = kind_;
  for (std::size_t begin = 0, end = 0; begin < faces_.size(); begin = end) {
    end = end_of_face(begin);
    const auto first = dropped.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = dropped.begin() + static_cast<std::ptrdiff_t>(end);
    if (std::find(first, last, true) == last) left.add_face(*this, begin, end);
  }
  left.number_cells();
  return left;
}

}  // namespace raycone
