#include "core/contour/cell_polygons.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/cells/triangle_shape.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

constexpr double kInPlane = 0.125;  // units: how far from its plane a point may be
constexpr double kNeedle = 32.0;    // likewise, how near to each other points may be

// A step of the loop that a surface makes on the border of a cell: a mixed edge, and the face behind it.
struct LoopStep {
  std::uint8_t low, direction;  // of the edge
  std::uint8_t face_low, face;  // of the face, as in kuhn::kFaces
  std::uint8_t square;          // that it is half of
  bool forward;                 // whether the loop meets the points of the face in their order
};
struct LoopSteps {
  std::array<LoopStep, 12> steps{};
  std::size_t size = 0;  // 0 where there is not just one loop
};

// Half of one of a cell's six squares.
struct BorderFace {
  std::array<unsigned, 3> corners;
  unsigned face, square;
};

constexpr std::array<int, 3> place_of(unsigned corner) {
  return {static_cast<int>(corner & 1U), static_cast<int>(corner >> 1U & 1U), static_cast<int>(corner >> 2U & 1U)};
}

std::array<BorderFace, 12> border_faces() {
  constexpr std::size_t kBorderKinds = 6;
  std::array<BorderFace, 12> faces{};
  std::size_t next = 0;
  for (unsigned face = 0; face < kBorderKinds; ++face) {
    const auto [first, second] = kuhn::kFaces[face];
    const unsigned across = (kuhn::kCorners - 1) ^ second;
    const auto axis = static_cast<unsigned>(std::countr_zero(across));
    for (const unsigned low : {0U, across})
      faces[next++] = {{low, low | first, low | second}, face, 2 * axis + (low == 0 ? 0U : 1U)};
  }
  return faces;
}

// Seen from outside of the cell, the surface has what is inside to the right of its border.
bool runs_forward(const BorderFace& face, unsigned inside_corner, unsigned outside_corner,
                  const std::array<int, 3>& step) {
  const std::size_t axis = face.square / 2, next = (axis + 1) % 3, last = (axis + 2) % 3;
  const std::array<int, 3> in = place_of(inside_corner), out = place_of(outside_corner);
  const int outward = face.square % 2 == 1 ? 1 : -1;
  // The outward normal times the step, along what leads from outside to inside.
  const int turn = step[next] * (in[last] - out[last]) - step[last] * (in[next] - out[next]);
  return outward * turn < 0;
}

using Edge = std::pair<unsigned, unsigned>;  // its corners, the lower one first

// The mixed edges of a face, in the order in which the loop has them.
std::optional<std::pair<Edge, Edge>> step_through(const BorderFace& face, unsigned inside) {
  const auto is_inside = [&](unsigned corner) { return (inside >> corner & 1U) != 0; };
  const auto [a, b, c] = face.corners;
  std::array<Edge, 3> mixed;
  std::size_t count = 0;
  for (const Edge& edge : {Edge{a, b}, Edge{b, c}, Edge{a, c}}) {
    if (is_inside(edge.first) != is_inside(edge.second)) mixed[count++] = edge;
  }
  if (count == 0) return std::nullopt;
  std::array<int, 3> step{};  // twice the way from the middle of the first to that of the second
  for (std::size_t axis = 0; axis < 3; ++axis) {
    step[axis] = place_of(mixed[1].first)[axis] + place_of(mixed[1].second)[axis] - place_of(mixed[0].first)[axis] -
                 place_of(mixed[0].second)[axis];
  }
  const auto [low, high] = mixed[0];
  const bool forward = runs_forward(face, is_inside(low) ? low : high, is_inside(low) ? high : low, step);
  return forward ? std::pair(mixed[0], mixed[1]) : std::pair(mixed[1], mixed[0]);
}

LoopSteps loop_around(unsigned inside, const std::array<BorderFace, 12>& faces) {
  std::array<std::pair<Edge, Edge>, 12> through;
  std::array<const BorderFace*, 12> of{};
  std::size_t count = 0;
  for (const BorderFace& face : faces) {
    const auto step = step_through(face, inside);
    if (!step) continue;
    through[count] = *step;
    of[count++] = &face;
  }
  LoopSteps loop;
  if (count == 0) return loop;
  std::size_t at = 0;
  do {
    const Edge from = through[at].first, to = through[at].second;
    loop.steps[loop.size++] = {
        static_cast<std::uint8_t>(from.first),         static_cast<std::uint8_t>(from.first ^ from.second),
        static_cast<std::uint8_t>(of[at]->corners[0]), static_cast<std::uint8_t>(of[at]->face),
        static_cast<std::uint8_t>(of[at]->square),     from < to};
    at = static_cast<std::size_t>(std::find_if(through.begin(), through.begin() + static_cast<std::ptrdiff_t>(count),
                                               [&](const auto& each) { return each.first == to; }) -
                                  through.begin());
  } while (at != 0);
  if (loop.size != count) loop.size = 0;
  return loop;
}

const LoopSteps& loop_of(std::uint8_t inside) {
  static const std::array<LoopSteps, 256> kLoops = [] {
    const std::array<BorderFace, 12> faces = border_faces();
    std::array<LoopSteps, 256> loops;
    for (unsigned labels = 0; labels < loops.size(); ++labels) loops[labels] = loop_around(labels, faces);
    return loops;
  }();
  return kLoops[inside];
}

bool is_diagonal(unsigned direction) { return std::popcount(direction) == 2; }

}  // namespace

bool CellPolygons::find(std::uint32_t cell) {
  cell_ = cell;
  count_ = diagonal_count_ = 0;
  spare_points_.clear();
  if (!find_loop() || has_needles() || !find_planes() || !find_ends()) return false;
  if (!holds_diagonal() || !holds_face_points()) return false;
  if (has_apex_ ? !cone_runs() : !cut_off_runs()) return false;
  find_diagonals();
  return true;
}

bool CellPolygons::find_loop() {
  const SurfaceCell& cell = cells_.cells()[cell_];
  const LoopSteps& loop = loop_of(cell.inside);
  loop_size_ = face_count_ = 0;
  for (std::size_t n = 0; n < loop.size; ++n) {
    const LoopStep& step = loop.steps[n];
    const std::uint32_t edge = cells_.cells()[corners_.of(step.low)].edge(step.direction);
    const EdgePoint& point = edge_points_[edge];
    if (point.source == kHole) return false;
    const auto [first, count] = face_points_.find(corners_.of(step.face_low), step.face);
    if (loop_size_ + 1 + count > loop_.size() || face_count_ + count > kMostSteps) return false;
    loop_[loop_size_++] = {edge, point.position, &point, step.square, step.direction, nullptr};
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t number = first + (step.forward ? i : count - 1 - i);
      const EdgePoint* const piece =
          i + 1 < count ? &face_points_.piece_behind(step.forward ? number : number - 1) : nullptr;
      loop_[loop_size_++] = {cells_.edges() + number, face_points_.positions()[number], nullptr, step.square, 0, piece};
    }
    face_count_ += count;
  }
  return loop.size > 0;
}

// Points of diagonals may be near to others, where a plane leads through a node: they are in line then.
bool CellPolygons::has_needles() const {
  const double least = kNeedle * unit_;
  const LoopCorner* last = nullptr;
  for (std::size_t n = 0; n <= loop_size_; ++n) {
    const LoopCorner& here = loop_[n < loop_size_ ? n : 0];
    if (is_diagonal(here.direction) && n < loop_size_) continue;
    if (last) {
      const Vec3 step = here.position - last->position;
      if (&here != last && !(dot(step, step) > least * least)) return true;
    }
    last = &here;
  }
  return false;
}

bool CellPolygons::is_in_plane(const EdgePoint& plane, const Vec3& p) const {
  return std::abs(dot(creases_.all_creases().normal_of(plane.source), p - plane.position)) <= kInPlane * unit_;
}

// How many of the planes it is in.
std::size_t CellPolygons::planes_through(const Vec3& p) const {
  const auto planes = std::span(planes_).first(run_count_);
  const auto count = std::ranges::count_if(planes, [&](const EdgePoint* plane) { return is_in_plane(*plane, p); });
  return static_cast<std::size_t>(count);
}

bool CellPolygons::is_near_node(const Vec3& p) const {
  const SurfaceCell& cell = cells_.cells()[cell_];
  const Vec3 low = p - cells_.corner(cell, 0), high = p - cells_.corner(cell, kuhn::kCorners - 1);
  const double least = kNeedle * unit_;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::min(std::abs(low[axis]), std::abs(high[axis])) > least) return false;
  }
  return true;
}

void CellPolygons::find_runs() {
  const auto loop = std::span(loop_).first(loop_size_);
  const auto start =
      face_count_ == 0 ? std::size_t{0}
                       : static_cast<std::size_t>(std::ranges::find(loop, nullptr, &LoopCorner::point) - loop.begin());
  run_count_ = 0;
  runs_[0].size = 0;
  runs_[0].plane = face_count_ > 0 ? loop_[start].piece : nullptr;
  for (std::size_t n = 0; n < loop_size_; ++n) {
    const std::size_t corner = (start + n) % loop_size_;
    Run& run = runs_[run_count_];
    run.add(corner);
    if (loop_[corner].point) {
      if (!run.plane) run.plane = loop_[corner].point;
    } else if (n > 0) {
      Run& next = runs_[++run_count_];
      next.size = 0;
      next.plane = loop_[corner].piece;
      next.add(corner);
    }
  }
  if (face_count_ > 0) runs_[run_count_].add(start);
  ++run_count_;
}

// Each run is in the plane of a source. Of several sources, planes through nodes would have it on different sides.
bool CellPolygons::find_planes() {
  find_runs();
  for (std::size_t n = 0; n < run_count_; ++n) {
    const Run& run = runs_[n];
    planes_[n] = run.plane;
    bool is_of_one = true;
    for (const std::uint8_t number : run.on_loop()) {
      const LoopCorner& corner = loop_[number];
      if (!is_in_plane(*run.plane, corner.position)) return false;
      is_of_one = is_of_one && (!corner.point || corner.point->source == run.plane->source);
    }
    if (!is_of_one && has_corner_at_node(run)) return false;
  }
  return true;
}

// Of an edge.
bool CellPolygons::has_corner_at_node(const Run& run) const {
  return std::ranges::any_of(run.on_loop(),
                             [&](std::uint8_t n) { return loop_[n].point && is_near_node(loop_[n].position); });
}

// Where sections follow fine creases, these are in several planes, too. Creases end in the cell nowhere, or at one
// point, of all planes.
bool CellPolygons::find_ends() {
  const SurfaceCell& cell = cells_.cells()[cell_];
  const double off = kNeedle * unit_;
  const bool has_fine = run_count_ > 1 && face_points_.kind() == PointsOfFaces::kSections;
  const CreasesHere::Ends ends = creases_.ends_within(cells_.corner(cell, 0), cells_.corner(cell, kuhn::kCorners - 1),
                                                      off, has_fine ? CreaseKinds::kAll : CreaseKinds::kNotFine);
  if (ends.many) return false;
  has_apex_ = ends.one.has_value();
  if (!has_apex_) return true;
  apex_ = *ends.one;
  return planes_through(apex_) == run_count_;
}

bool CellPolygons::holds_diagonal() {
  const SurfaceCell& cell = cells_.cells()[cell_];
  if (cell.is_inside(0) == cell.is_inside(kuhn::kCorners - 1)) return true;
  return planes_through(edge_points_[cell.edge(kuhn::kCorners - 1)].position) > 0;
}

// Those of faces within the cell are where two of the planes meet.
bool CellPolygons::holds_face_points() {
  for (std::size_t face = kuhn::kFacesBetweenCells; face < kuhn::kFaces.size(); ++face) {
    const auto [first, count] = face_points_.find(cell_, face);
    for (std::uint32_t point = first; point < first + count; ++point) {
      if (planes_through(face_points_.positions()[point]) < 2) return false;
      spare_points_.push_back(point);
    }
  }
  return true;
}

// Of the corners of a run, which may be too few for one.
PlanePolygon& CellPolygons::add_polygon(const Run& run) {
  PlanePolygon& polygon = polygons_[count_++];
  polygon.source = run.plane->source;
  polygon.size = 0;
  for (const std::uint8_t corner : run.on_loop()) polygon.add(loop_[corner].vertex);
  return polygon;
}

bool CellPolygons::cone_runs() {
  if (run_count_ < 2) return false;
  for (std::size_t n = 0; n < run_count_; ++n) {
    PlanePolygon& polygon = add_polygon(runs_[n]);
    polygon.add(kApex);
    if (polygon.size < 3) return false;
  }
  return true;
}

bool CellPolygons::is_one_plane(const Run& a, const Run& b) const {
  const auto holds = [&](const EdgePoint& plane, const Run& run) {
    return std::ranges::all_of(run.on_loop(),
                               [&](std::uint8_t corner) { return is_in_plane(plane, loop_[corner].position); });
  };
  return a.plane->source == b.plane->source || (holds(*a.plane, b) && holds(*b.plane, a));
}

// A run between two others of one plane ends where this meets its own: the straight line between its ends is in both.
// It is cut off there, and its neighbours become one.
bool CellPolygons::cut_off_runs() {
  while (run_count_ > 1) {
    std::size_t n = 0;
    const auto neighbour = [&](std::size_t step) -> Run& { return runs_[(n + step) % run_count_]; };
    const auto is_between = [&] {
      const Run& run = runs_[n];
      const Run &before = neighbour(run_count_ - 1), &behind = neighbour(1);
      return is_one_plane(before, behind) && loop_[run.corners[0]].square != loop_[run.corners[run.size - 1]].square;
    };
    while (n < run_count_ && !is_between()) ++n;
    if (n == run_count_ || add_polygon(runs_[n]).size < 3) return false;
    Run& before = neighbour(run_count_ - 1);
    const Run& behind = neighbour(1);
    if (&before != &behind) {
      for (const std::uint8_t corner : behind.on_loop()) before.add(corner);
    }
    const std::size_t gone = (n + 1) % run_count_, merged = (n + run_count_ - 1) % run_count_;
    std::array<Run, kMostRuns> left{};
    std::size_t count = 0;
    for (std::size_t i = 0; i < run_count_; ++i) {
      if (i != n && (i != gone || gone == merged)) left[count++] = runs_[i];
    }
    runs_ = left;
    run_count_ = count;
  }
  // It goes around to the point of a face that it starts at, where its plane is on both sides of that.
  Run& last = runs_[0];
  if (last.corners[0] == last.corners[last.size - 1]) --last.size;
  return add_polygon(last).size >= 3;
}

// Both cells at a square look at the same points in the same order.
void CellPolygons::find_diagonals() {
  for (std::size_t n = 0; n < loop_size_; ++n) {
    const LoopCorner& here = loop_[n];
    if (!here.point || !is_diagonal(here.direction)) continue;
    const LoopCorner* a = &loop_[n == 0 ? loop_size_ - 1 : n - 1];
    const LoopCorner* b = &loop_[n + 1 == loop_size_ ? 0 : n + 1];
    if (a->vertex > b->vertex) std::swap(a, b);
    const Vec3 along = b->position - a->position, off = cross(along, here.position - a->position);
    const double most = kInPlane * unit_;
    const bool is_inline = dot(off, off) <= most * most * dot(along, along);
    diagonals_[diagonal_count_++] = {here.vertex, here.square % 2 == 0, is_inline};
  }
}

std::vector<std::uint8_t> polygons_at_sections(const SurfaceInCells& surface, const FacePoints& face_points) {
  std::vector<std::uint8_t> found(surface.cells.cells().size(), 0);
  for (const std::uint64_t face : face_points.section_faces()) {
    for (const std::uint32_t cell : cells_at_face(surface.cells, cell_of_face(face), face_in_cell(face)))
      found[cell] = 1;
  }
  parallel_for(found.size(), 512, [&](std::size_t begin, std::size_t end) {
    CreasesHere creases(surface.creases);
    CornerCells corners(surface.cells);
    CellPolygons polygons(surface, face_points, creases, corners);
    for (auto cell = static_cast<std::uint32_t>(begin); cell < end; ++cell) {
      if (found[cell] == 0) continue;
      creases.enter(cell);
      corners.enter(cell);
      found[cell] = polygons.find(cell) ? 1 : 0;
    }
  });
  return found;
}

std::size_t best_fan(std::span<const Vec3> polygon) {
  Vec3 normal;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    normal = normal + cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
  std::size_t best = 0;
  double best_shape = -std::numeric_limits<double>::infinity();
  for (std::size_t from = 0; from < polygon.size(); ++from) {
    double worst = std::numeric_limits<double>::infinity();
    const auto corner = [&](std::size_t step) -> const Vec3& {
      const std::size_t at = from + step;  // divisions would take longer than all else here
      return polygon[at < polygon.size() ? at : at - polygon.size()];
    };
    for (std::size_t i = 1; i + 1 < polygon.size() && worst > best_shape; ++i)
      worst = std::min(worst, shape_along(normal, corner(0), corner(i), corner(i + 1)));
    if (!(worst > best_shape)) continue;
    best_shape = worst;
    best = from;
  }
  return best;
}

}  // namespace raycone
