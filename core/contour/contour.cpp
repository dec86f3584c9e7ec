#include "core/contour/contour.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "core/cells/planes_point.h"
#include "core/contour/cell_polygons.h"
#include "core/contour/contour_parts.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

constexpr double kSamePlace = 16.0;  // square of how many tolerances points on two planes may be apart

// A corner of a loop: a vertex of the surface, and the edge point where it is one.
struct LoopCorner {
  std::uint32_t vertex;
  const EdgePoint* edge_point;
};
struct Loop {
  std::array<LoopCorner, 4 * (1 + CreasesHere::Section::kMost)> corners;
  std::size_t size = 0;
  bool has_face_point = false;

  void add(std::uint32_t vertex, const EdgePoint* point) { corners[size++] = {vertex, point}; }
};

class CellContour {
 public:
  CellContour(const SurfaceInCells& surface, const FacePoints& face_points, ContourPart& part, SparePoints* spare)
      : surface_(surface),
        face_points_(face_points),
        creases_(surface.creases),
        corner_cells_(surface.cells),
        polygons_(surface, face_points, creases_, corner_cells_),
        spare_(spare),
        part_(part) {}

  void add(std::uint32_t cell) {
    cell_ = cell;
    corner_cells_.enter(cell);
    creases_.enter(cell);
    if (spare_ && polygons_.find(cell)) {
      add_polygons();
      return;
    }
    if (face_points_.kind() == PointsOfFaces::kSections) find_points_within();
    for (std::size_t n = 0; n < kuhn::kTetrahedra.size(); ++n) {
      const Loop loop = loop_of(kuhn::kTetrahedra[n]);
      if (loop.size > 0) fill(loop, n);
    }
  }

 private:
  using Corners = std::array<Vec3, 4>;
  struct Apex {
    Vec3 position;
    bool on_mesh;
  };
  // Relative to an origin.
  struct LoopPoints {
    std::array<PointOnPlane, std::tuple_size_v<decltype(Loop::corners)>> planes;  // that the surface is of, in the loop
    std::size_t count = 0;                                                        // of these
    std::size_t face_points = 0;
    Vec3 middle;  // of several face points; else of all corners
  };

  [[nodiscard]] bool is_inside(unsigned corner) const { return surface_.cells.cells()[cell_].is_inside(corner); }
  [[nodiscard]] std::uint32_t cell_of(unsigned corner) { return corner_cells_.of(corner); }
  void add_edge(Loop& loop, unsigned a, unsigned b) {
    const unsigned low = std::min(a, b), high = std::max(a, b);
    const std::uint32_t edge = surface_.cells.cells()[cell_of(low)].edge(high ^ low);
    loop.add(edge, &surface_.edge_points[edge]);
  }
  // The points of a face between its edges from `common` to `last` and to `next`.
  void add_face(Loop& loop, unsigned common, unsigned last, unsigned next) {
    std::array<unsigned, 3> corners{common, last, next};
    std::ranges::sort(corners);
    const std::size_t face = kuhn::face_number(corners[1] ^ corners[0], corners[2] ^ corners[0]);
    if (face >= kuhn::kFacesBetweenCells && face_points_.kind() == PointsOfFaces::kSections) {
      const std::uint32_t point = within_[face - kuhn::kFacesBetweenCells];
      if (point != kNone) loop.add(point, nullptr);
      loop.has_face_point = loop.has_face_point || point != kNone;
      return;
    }
    const auto [first, count] = face_points_.find(cell_of(corners[0]), face);
    for (std::uint32_t n = 0; n < count; ++n)
      loop.add(surface_.cells.edges() + first + (last < next ? n : count - 1 - n), nullptr);
    loop.has_face_point = loop.has_face_point || count > 0;
  }

  void add_around_two(Loop& loop, const std::array<unsigned, 4>& corners);
  void add_around_one(Loop& loop, const std::array<unsigned, 4>& corners);

  void add_polygons();
  void find_points_within();
  [[nodiscard]] std::uint64_t triangles_of_tetrahedra();
  [[nodiscard]] std::uint64_t points_at(const kuhn::Tetrahedron& tetrahedron);
  [[nodiscard]] Loop loop_of(const kuhn::Tetrahedron& tetrahedron);
  [[nodiscard]] Vec3 position(const LoopCorner& corner) const {
    if (corner.edge_point) return corner.edge_point->position;
    return corner.vertex < kFirstApex ? face_points_.positions()[corner.vertex - surface_.cells.edges()]
                                      : part_.apexes[corner.vertex - kFirstApex];
  }
  // What the surface is of between two corners of a loop, one of them a face point.
  [[nodiscard]] const EdgePoint& piece_between(const LoopCorner& a, const LoopCorner& b) const {
    if (a.edge_point) return *a.edge_point;
    return b.edge_point ? *b.edge_point
                        : face_points_.piece_behind(std::min(a.vertex, b.vertex) - surface_.cells.edges());
  }
  [[nodiscard]] Vec3 normal_of(const EdgePoint& point) const { return creases_.all_creases().normal_of(point.source); }
  void fill(const Loop& loop, std::size_t number);
  void fill_flat(const Loop& loop);
  [[nodiscard]] Apex apex_of(const Loop& loop, const kuhn::Tetrahedron& tetrahedron);
  [[nodiscard]] LoopPoints points_of(const Loop& loop, const Vec3& origin) const;
  [[nodiscard]] std::optional<Vec3> point_on_crease(const LoopPoints& points, const BarycentricCoordinates& within,
                                                    const kuhn::Tetrahedron& tetrahedron);
  [[nodiscard]] std::optional<Vec3> crease_exit(const Corners& corners, const kuhn::Tetrahedron& tetrahedron,
                                                const Vec3& from);
  void add_triangle(const Triangle& triangle, std::int32_t source) {
    part_.triangles.push_back(triangle);
    part_.sources.push_back(source);
  }

  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  SurfaceInCells surface_;
  const FacePoints& face_points_;
  CreasesHere creases_;
  CornerCells corner_cells_;
  CellPolygons polygons_;
  SparePoints* spare_;
  ContourPart& part_;
  std::uint32_t cell_ = 0;
  std::array<std::uint32_t, kuhn::kFaces.size() - kuhn::kFacesBetweenCells> within_{};  // points of its own faces
};

// Only tetrahedra have them.
void CellContour::find_points_within() {
  for (std::size_t n = 0; n < within_.size(); ++n) {
    within_[n] = kNone;
    const std::size_t face = kuhn::kFacesBetweenCells + n;
    const auto point = face_point(surface_, cell_, face, creases_);
    if (!point) continue;
    within_[n] = kFirstApex + static_cast<std::uint32_t>(part_.apexes.size());
    part_.apexes.push_back(*point);
    part_.tetrahedra.push_back(kFaceOfCell | number_of_face(cell_, face));
  }
}

void CellContour::add_polygons() {
  const SurfaceCell& cell = surface_.cells.cells()[cell_];
  if (cell.is_inside(0) != cell.is_inside(kuhn::kCorners - 1)) spare_->within[cell.edge(kuhn::kCorners - 1)] = 1;
  for (const DiagonalPoint& point : polygons_.diagonals()) {
    if (point.is_inline) (point.is_above ? spare_->above : spare_->below)[point.edge] = 1;
  }
  for (const std::uint32_t face : polygons_.spare_points()) spare_->faces[face] = 1;
  std::uint32_t apex = 0;
  for (const PlanePolygon& polygon : polygons_.polygons()) {
    part_.polygons.push_back({polygon.source, static_cast<std::uint32_t>(polygon.size)});
    for (std::size_t n = 0; n < polygon.size; ++n) {
      std::uint32_t corner = polygon.corners[n];
      if (corner == CellPolygons::kApex) {
        if (apex == 0) {
          apex = kFirstApex + static_cast<std::uint32_t>(part_.apexes.size());
          part_.apexes.push_back(polygons_.apex());
          part_.tetrahedra.push_back(kWholeCell | cell_);
        }
        corner = apex;
      }
      part_.polygon_corners.push_back(corner);
    }
  }
  part_.full_triangles += triangles_of_tetrahedra();
}

// How many triangles the cell's tetrahedra would have. With sections, the points of faces within the cell are not
// known: where a crease comes into a tetrahedron, it counts as leaving it by such a face.
std::uint64_t CellContour::triangles_of_tetrahedra() {
  const bool knows_all = face_points_.kind() == PointsOfFaces::kOne;
  std::uint64_t count = 0;
  for (const kuhn::Tetrahedron& tetrahedron : kuhn::kTetrahedra) {
    const auto inside = std::ranges::count_if(tetrahedron.corners, [&](unsigned c) { return is_inside(c); });
    if (inside == 0 || inside == 4) continue;
    const std::uint64_t corners = inside == 2 ? 4 : 3;
    const std::uint64_t points = polygons_.has_face_points() ? points_at(tetrahedron) : 0;
    count += points == 0 ? corners - 2 : corners + points + (knows_all ? 0 : 1);
  }
  return count;
}

// On its faces.
std::uint64_t CellContour::points_at(const kuhn::Tetrahedron& tetrahedron) {
  std::uint64_t points = 0;
  for (std::size_t without = 0; without < tetrahedron.corners.size(); ++without) {
    std::array<unsigned, 3> corners;
    for (std::size_t n = 0; n < corners.size(); ++n) corners[n] = tetrahedron.corners[n < without ? n : n + 1];
    if (is_inside(corners[0]) == is_inside(corners[1]) && is_inside(corners[0]) == is_inside(corners[2])) continue;
    const std::size_t face = kuhn::face_number(corners[1] ^ corners[0], corners[2] ^ corners[0]);
    points += face_points_.find(cell_of(corners[0]), face).count;
  }
  return points;
}

// Around the first two corners, which are of one kind, or the last two.
void CellContour::add_around_two(Loop& loop, const std::array<unsigned, 4>& corners) {
  const auto [a, b, c, d] = corners;
  add_edge(loop, a, c);
  add_face(loop, a, c, d);
  add_edge(loop, a, d);
  add_face(loop, d, a, b);
  add_edge(loop, b, d);
  add_face(loop, b, d, c);
  add_edge(loop, b, c);
  add_face(loop, c, b, a);
}

// Around the first corner, which alone is of its kind.
void CellContour::add_around_one(Loop& loop, const std::array<unsigned, 4>& corners) {
  const auto [a, b, c, d] = corners;
  add_edge(loop, a, b);
  add_face(loop, a, b, c);
  add_edge(loop, a, c);
  add_face(loop, a, c, d);
  add_edge(loop, a, d);
  add_face(loop, a, d, b);
}

// Corners are reordered by transpositions, each of which turns the loop around.
Loop CellContour::loop_of(const kuhn::Tetrahedron& tetrahedron) {
  std::array<unsigned, 4> corner = tetrahedron.corners;
  const auto inside = static_cast<std::size_t>(std::ranges::count_if(corner, [&](unsigned c) { return is_inside(c); }));
  Loop loop;
  if (inside == 0 || inside == corner.size()) return loop;
  bool positive = tetrahedron.positive;
  const auto swap_corners = [&](std::size_t a, std::size_t b) {
    if (a == b) return;
    std::swap(corner[a], corner[b]);
    positive = !positive;
  };
  if (inside == 2) {
    for (std::size_t i = 0, next = 0; i < corner.size(); ++i) {
      if (is_inside(corner[i])) swap_corners(next++, i);
    }
    add_around_two(loop, corner);
  } else {
    const bool lone_inside = inside == 1;
    const auto lone = std::ranges::find_if(corner, [&](unsigned c) { return is_inside(c) == lone_inside; });
    swap_corners(0, static_cast<std::size_t>(lone - corner.begin()));
    add_around_one(loop, corner);
    if (!lone_inside) positive = !positive;
  }
  if (!positive) std::reverse(loop.corners.begin(), loop.corners.begin() + static_cast<std::ptrdiff_t>(loop.size));
  return loop;
}

std::int32_t source_of(std::int32_t a, std::int32_t b) { return a == kHole || b == kHole ? kHole : a; }

void CellContour::fill(const Loop& loop, std::size_t number) {
  if (!loop.has_face_point) {
    fill_flat(loop);
    return;
  }
  const auto vertex = kFirstApex + static_cast<std::uint32_t>(part_.apexes.size());
  const Apex apex = apex_of(loop, kuhn::kTetrahedra[number]);
  part_.apexes.push_back(apex.position);
  part_.tetrahedra.push_back(kuhn::kTetrahedra.size() * cell_ + number);
  const bool at_hole = std::ranges::any_of(std::span(loop.corners).first(loop.size), [](const LoopCorner& corner) {
    return corner.edge_point && corner.edge_point->source == kHole;
  });
  for (std::size_t i = 0; i < loop.size; ++i) {
    const LoopCorner &here = loop.corners[i], &next = loop.corners[(i + 1) % loop.size];
    const std::int32_t first = piece_between(here, next).source, second = piece_between(next, here).source;
    add_triangle({here.vertex, next.vertex, vertex}, at_hole && !apex.on_mesh ? kHole : source_of(first, second));
  }
}

// A loop of four is cut along its shorter diagonal.
void CellContour::fill_flat(const Loop& loop) {
  const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
    const auto &p = loop.corners[a], &q = loop.corners[b], &r = loop.corners[c];
    const std::int32_t source = source_of(p.edge_point->source, q.edge_point->source);
    add_triangle({p.vertex, q.vertex, r.vertex}, source_of(source, r.edge_point->source));
  };
  if (loop.size == 3) {
    add(0, 1, 2);
    return;
  }
  const auto diagonal = [&](std::size_t a, std::size_t b) {
    const Vec3 step = position(loop.corners[b]) - position(loop.corners[a]);
    return dot(step, step);
  };
  const std::size_t from = diagonal(0, 2) <= diagonal(1, 3) ? 0 : 1;
  add(from, from + 1, from + 2);
  add(from + 2, (from + 3) % 4, from);
}

// Where a crease leaves the tetrahedron through the face whose nodes are of one kind, as far from a point as there is
// one; relative to the first corner.
std::optional<Vec3> CellContour::crease_exit(const Corners& corners, const kuhn::Tetrahedron& tetrahedron,
                                             const Vec3& from) {
  for (std::size_t lone = 0; lone < corners.size(); ++lone) {
    Corners3 face;
    std::size_t next = 0, inside = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (i == lone) continue;
      face[next++] = corners[i];
      inside += is_inside(tetrahedron.corners[i]) ? 1 : 0;
    }
    if (inside != 0 && inside != face.size()) continue;
    const Vec3 start = corners[0] + from;
    const std::optional<Vec3> hit = creases_.farthest_hit(face, start, corners[lone]);
    return hit ? std::optional(*hit - corners[0]) : std::nullopt;
  }
  return std::nullopt;
}

CellContour::LoopPoints CellContour::points_of(const Loop& loop, const Vec3& origin) const {
  LoopPoints points;
  Vec3 of_all, of_faces;
  for (std::size_t i = 0; i < loop.size; ++i) {
    const LoopCorner& corner = loop.corners[i];
    const Vec3 from_origin = position(corner) - origin;
    of_all = of_all + from_origin;
    if (!corner.edge_point) {
      of_faces = of_faces + from_origin;
      ++points.face_points;
      const LoopCorner& next = loop.corners[(i + 1) % loop.size];
      if (!next.edge_point) points.planes[points.count++] = {from_origin, normal_of(piece_between(corner, next))};
    } else if (corner.edge_point->source != kHole) {
      points.planes[points.count++] = {from_origin, normal_of(*corner.edge_point)};
    }
  }
  points.middle = points.face_points > 1 ? (1.0 / static_cast<double>(points.face_points)) * of_faces
                                         : (1.0 / static_cast<double>(loop.size)) * of_all;
  return points;
}

// Near the middle of the loop. Relative to the tetrahedron's first corner.
std::optional<Vec3> CellContour::point_on_crease(const LoopPoints& points, const BarycentricCoordinates& within,
                                                 const kuhn::Tetrahedron& tetrahedron) {
  std::optional<Vec3> point = creases_.nearest_end_within(within, points.middle, surface_.margin);
  if (!point && points.face_points == 1) point = crease_exit(within.corners(), tetrahedron, points.middle);
  if (!point) point = creases_.nearest_within(within, points.middle);
  // Points of sections may be on fine ones alone.
  if (!point && face_points_.kind() == PointsOfFaces::kSections)
    point = creases_.nearest_within(within, points.middle, CreaseKinds::kAll);
  return point;
}

CellContour::Apex CellContour::apex_of(const Loop& loop, const kuhn::Tetrahedron& tetrahedron) {
  Corners corners;
  std::ranges::transform(tetrahedron.corners, corners.begin(),
                         [&](unsigned corner) { return surface_.cells.corner(surface_.cells.cells()[cell_], corner); });
  const LoopPoints points = points_of(loop, corners[0]);
  const BarycentricCoordinates within(corners);
  const std::optional<Vec3> on_crease = point_on_crease(points, within, tetrahedron);
  const bool on_mesh = on_crease.has_value();
  const Vec3 target = on_crease.value_or(points.middle);
  // There it is in all planes as well as numbers can tell.
  const std::optional<Vec3> meeting =
      common_point(std::span(points.planes).first(points.count), target, surface_.tolerance);
  const auto off_square = [&] { return dot(*meeting - target, *meeting - target); };
  const bool meets = meeting && within.is_within(*meeting, surface_.margin) &&
                     (!on_mesh || off_square() <= kSamePlace * surface_.tolerance * surface_.tolerance);
  return {corners[0] + (meets ? *meeting : within.moved_within(target, surface_.margin)), on_mesh};
}

}  // namespace

ContouredSurface contour(const SurfaceInCells& surface, const FacePoints& face_points, ContourCells kind) {
  const std::span<const EdgePoint> edge_points = surface.edge_points;
  check_point_numbers(edge_points.size() + face_points.positions().size());
  const std::size_t count = surface.cells.cells().size();
  constexpr std::size_t kCellsPerPart = 512;
  std::vector<ContourPart> parts((count + kCellsPerPart - 1) / kCellsPerPart);
  SparePoints spare;
  if (kind == ContourCells::kPolygons) {
    for (std::vector<std::uint8_t>* of_edges : {&spare.above, &spare.below, &spare.within})
      of_edges->resize(edge_points.size());
    spare.faces.resize(face_points.positions().size());
  }
  parallel_for_each(parts.size(), [&](std::size_t part) {
    CellContour contour(surface, face_points, parts[part], kind == ContourCells::kPolygons ? &spare : nullptr);
    for (std::size_t cell = part * kCellsPerPart; cell < std::min((part + 1) * kCellsPerPart, count); ++cell) {
      contour.add(static_cast<std::uint32_t>(cell));
    }
  });
  if (kind == ContourCells::kTetrahedra) return joined(parts, edge_points, face_points.positions(), nullptr);
  spare.settle_edges();
  const std::uint64_t fewer = cut_polygons(parts, edge_points, face_points.positions(), spare);
  ContouredSurface contoured = joined(parts, edge_points, face_points.positions(), &spare);
  contoured.fewer = fewer;
  return contoured;
}

}  // namespace raycone
