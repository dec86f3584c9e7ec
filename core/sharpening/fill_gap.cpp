#include "core/sharpening/fill_gap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/cells/source_plane.h"
#include "core/data/coordinate_precision.h"
#include "core/sharpening/best_triangulation.h"

namespace raycone {
namespace {

// Runs of sides in one plane are cut off one by one, each along the lines where the planes before and after it meet it,
// until one plane is left.
class GapFiller {
 public:
  GapFiller(const GapLoop& loop, const TriangleMesh& input, const GapLimits& limits)
      : limits_(limits), loop_corners_(loop.corners.size()), points_(loop.corners) {
    const std::size_t count = points_.size();
    for (std::size_t i = 0; i < count; ++i) {
      SourcePlane plane = source_plane(input, loop.sources[i]);
      const double front = dot(plane.normal, loop.fronts[i]);
      if (front < 0.0) plane.normal = -1.0 * plane.normal;
      const Vec3 &from = points_[i], &to = points_[(i + 1) % count];
      const auto is_same = [&](const Label& label) {
        return dot(label.plane.normal, plane.normal) > 0.0 &&
               is_same_plane(label.plane, plane, from, 2 * limits_.off) &&
               is_same_plane(label.plane, plane, to, 2 * limits_.off);
      };
      auto label = std::ranges::find_if(labels_, is_same);
      if (label == labels_.end()) label = labels_.insert(label, {plane, 0.0});
      label->front += std::abs(front);
      sides_.push_back({i, static_cast<std::size_t>(label - labels_.begin()), loop.sources[i]});
    }
  }

  std::optional<GapFill> fill() {
    if (!has_fronts() || !fill_rest()) return std::nullopt;
    return std::move(filled_);
  }
  std::optional<GapFill> fill_from(const Vec3& corner) {
    if (!has_fronts() || !fill_sectors(rounded_to(limits_.precision, corner))) return std::nullopt;
    return std::move(filled_);
  }

 private:
  // A plane, from one side: it may have faces that look either way.
  struct Label {
    SourcePlane plane;  // which shows its front
    double front;       // 0 where that is not known
  };
  struct Side {
    std::size_t corner;  // where it begins
    std::size_t label;
    std::int32_t source;
  };
  struct Run {
    bool has_corner;  // the planes before and after it are not one
    double square;    // of the distance between its ends
    std::size_t first, sides;
    friend auto operator<=>(const Run&, const Run&) = default;
  };
  // Of a run, and of the sides before and after it.
  struct RunLabels {
    std::size_t own, before, after;
  };
  // A line along which a run is cut off.
  struct Path {
    std::vector<std::size_t> places;  // on the run, from 0
    std::size_t turn = 0;             // which of them is the first that lines in the plane after the run begin at
    bool has_new_corner = false;      // lines turn at a new corner before that one
  };

  [[nodiscard]] const Side& side(std::size_t i) const { return sides_[i % sides_.size()]; }
  [[nodiscard]] bool is_in(std::size_t label, const Vec3& p) const {
    return std::abs(labels_[label].plane.height(p)) <= limits_.off;
  }

  // Those between planes that are one first, the shortest first.
  [[nodiscard]] std::vector<Run> find_runs() const {
    std::vector<Run> runs;
    const std::size_t count = sides_.size();
    for (std::size_t first = 0; first < count; ++first) {
      if (side(first + count - 1).label == side(first).label) continue;
      std::size_t sides = 1;
      while (side(first + sides).label == side(first).label) ++sides;
      const Vec3 step = points_[side(first + sides).corner] - points_[side(first).corner];
      runs.push_back({side(first + count - 1).label != side(first + sides).label, dot(step, step), first, sides});
    }
    std::ranges::sort(runs);
    return runs;
  }

  [[nodiscard]] bool has_fronts() const {
    return std::ranges::none_of(labels_, [](const Label& label) { return label.front == 0.0; });
  }
  bool fill_rest();
  bool fill_sectors(const Vec3& corner);
  [[nodiscard]] std::size_t nearest_end(std::size_t between, const Vec3& point) const;
  bool cut_off(const Run& run);
  [[nodiscard]] Path straight_path(const std::vector<std::size_t>& corners, std::size_t label) const;
  [[nodiscard]] Path turning_path(const std::vector<std::size_t>& corners, const RunLabels& labels) const;
  bool add_corner(const std::vector<std::size_t>& corners, const RunLabels& labels);
  bool add_polygon(const std::vector<std::size_t>& corners, const Side& like);
  void add_line(std::size_t from, std::size_t to);
  void add_triangle(const Vec3& a, const Vec3& b, const Vec3& c);
  [[nodiscard]] int pieces(double square) const;

  const GapLimits& limits_;
  std::size_t loop_corners_;
  std::vector<Vec3> points_;  // corners of the loop, then new ones
  std::vector<Label> labels_;
  std::vector<Side> sides_;  // of what is left
  GapFill filled_;
  std::vector<Vec3> on_mesh_;  // what must be
  int tries_ = 0;
};

// What one run is cut off by may not suit the next one: then another one goes first. In the end, each triangle and each
// line must be on the mesh: a plane may go on where the mesh does not.
bool GapFiller::fill_rest() {
  constexpr int kMostTries = 32;
  const std::vector<Run> runs = find_runs();
  if (runs.size() <= 1) {
    std::vector<std::size_t> rest;
    for (const Side& side : sides_) rest.push_back(side.corner);
    return add_polygon(rest, sides_.front()) && limits_.are_on_mesh(on_mesh_);
  }
  for (const Run& run : runs) {
    if (++tries_ > kMostTries) return false;
    const std::vector<Side> sides = sides_;
    const std::size_t corners = filled_.corners.size(), triangles = filled_.triangles.size(), checks = on_mesh_.size();
    if (cut_off(run) && fill_rest()) return true;
    sides_ = sides;
    filled_.corners.resize(corners);
    points_.resize(loop_corners_ + corners);
    filled_.triangles.resize(triangles);
    filled_.sources.resize(triangles);
    on_mesh_.resize(checks);
  }
  return false;
}

// One of each run, between lines to its ends. Where several corners around an end are on the line, the nearest one is
// the end: others are on a side of the sector that they lead along.
bool GapFiller::fill_sectors(const Vec3& corner) {
  const auto is_on_plane = [&](const Side& side) { return is_in(side.label, corner); };
  std::vector<Run> runs = find_runs();
  const auto is_there = [&](const Side& side) {
    const Vec3 step = points_[side.corner] - corner;
    return dot(step, step) <= 4 * limits_.off * limits_.off;
  };
  if (runs.size() < 2 || !std::ranges::all_of(sides_, is_on_plane) || std::ranges::any_of(sides_, is_there))
    return false;
  std::ranges::sort(runs, {}, &Run::first);
  const std::size_t apex = points_.size(), count = sides_.size();
  points_.push_back(corner);
  filled_.corners.push_back(corner);
  std::vector<std::size_t> ends;
  for (const Run& run : runs) ends.push_back(nearest_end(run.first, corner));
  for (std::size_t n = 0; n < runs.size(); ++n) {
    const std::size_t first = ends[n], end = n + 1 < ends.size() ? ends[n + 1] : ends[0] + count;
    if (!(first < end && end <= first + count)) return false;
    std::vector<std::size_t> polygon{apex};
    for (std::size_t i = first; i <= end; ++i) polygon.push_back(side(i).corner);
    add_line(apex, polygon[1]);
    if (!add_polygon(polygon, side(runs[n].first))) return false;
  }
  return limits_.are_on_mesh(on_mesh_);
}

// Looks at corners around the one between two runs that are on both planes, one next to the other. Returns the place of
// the one that is nearest to a point, counted on around the loop.
std::size_t GapFiller::nearest_end(std::size_t between, const Vec3& point) const {
  const std::size_t count = sides_.size(), before = side(between + count - 1).label, after = side(between).label;
  const auto is_on_line = [&](std::size_t i) {
    const Vec3& p = points_[side(i).corner];
    return is_in(before, p) && is_in(after, p);
  };
  const auto square = [&](std::size_t i) {
    const Vec3 step = points_[side(i).corner] - point;
    return dot(step, step);
  };
  const std::size_t here = between + count;
  std::size_t nearest = here;
  for (std::size_t i = here - 1; i > here - count && is_on_line(i); --i)
    nearest = square(i) < square(nearest) ? i : nearest;
  for (std::size_t i = here + 1; i < here + count && is_on_line(i); ++i)
    nearest = square(i) < square(nearest) ? i : nearest;
  return nearest;
}

// Between two runs in one plane, along the one line where it meets that of the run.
GapFiller::Path GapFiller::straight_path(const std::vector<std::size_t>& corners, std::size_t label) const {
  Path path;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (i == 0 || i + 1 == corners.size() || is_in(label, points_[corners[i]])) path.places.push_back(i);
  }
  return path;
}

// Where lines meet in a corner of the run, there is no new one.
GapFiller::Path GapFiller::turning_path(const std::vector<std::size_t>& corners, const RunLabels& labels) const {
  const std::size_t last = corners.size() - 1;
  std::size_t corner = SIZE_MAX, first_after = last;
  for (std::size_t i = 0; i <= last; ++i) {
    const Vec3& p = points_[corners[i]];
    const bool in_before = i == 0 || is_in(labels.before, p), in_after = i == last || is_in(labels.after, p);
    if (in_before && in_after && corner == SIZE_MAX) corner = i;
    if (corner == SIZE_MAX && in_after) first_after = std::min(first_after, i);
  }
  Path path;
  path.has_new_corner = corner == SIZE_MAX;
  const std::size_t turn = path.has_new_corner ? first_after : corner;
  for (std::size_t i = 0; i <= last; ++i) {
    const bool is_on =
        i == 0 || i == last || i == corner || is_in(i < turn ? labels.before : labels.after, points_[corners[i]]);
    if (i == turn) path.turn = path.places.size();
    if (is_on) path.places.push_back(i);
  }
  return path;
}

// Adds the corner in which lines turn, where the three planes meet. False where there is no such point near the run and
// on the mesh, or no further corner is allowed.
bool GapFiller::add_corner(const std::vector<std::size_t>& corners, const RunLabels& labels) {
  if (filled_.corners.size() >= limits_.new_corners) return false;
  const std::array planes{labels_[labels.own].plane, labels_[labels.before].plane, labels_[labels.after].plane};
  const Vec3 &from = points_[corners.front()], &to = points_[corners.back()];
  std::optional<Vec3> point = meeting_point(planes, 0.5 * from + 0.5 * to);
  if (!point) return false;
  point = rounded_to(limits_.precision, *point);
  const auto is_near = [&](std::size_t end) {
    const Vec3 step = *point - points_[end];
    return dot(step, step) <= limits_.reach * limits_.reach;
  };
  if (std::ranges::none_of(corners, is_near)) return false;
  if (!limits_.are_on_mesh({&*point, 1})) return false;
  points_.push_back(*point);
  return true;
}

// None longer than half of the reach; not too many. `square`: of the length of the whole.
int GapFiller::pieces(double square) const {
  constexpr double kMost = 16.0;
  return static_cast<int>(std::clamp(std::ceil(2.0 * std::sqrt(square) / limits_.reach), 1.0, kMost));
}

// The middle of each piece of a line.
void GapFiller::add_line(std::size_t from, std::size_t to) {
  const Vec3 step = points_[to] - points_[from];
  const int count = pieces(dot(step, step));
  for (int n = 0; n < count; ++n) on_mesh_.push_back(points_[from] + (n + 0.5) / count * step);
}

// The middle of each part of a triangle that is cut along lines parallel to its sides.
void GapFiller::add_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a, w = c - b;
  const int count = pieces(std::max({dot(u, u), dot(v, v), dot(w, w)}));
  for (int i = 0; i < count; ++i) {
    for (int j = 0; i + j < count; ++j) {
      on_mesh_.push_back(a + (i + 1.0 / 3) / count * u + (j + 1.0 / 3) / count * v);
    }
  }
}

// Where this fails, some of what it adds is there already: the caller takes it back.
bool GapFiller::cut_off(const Run& run) {
  const Side before = side(run.first + sides_.size() - 1), after = side(run.first + run.sides), here = side(run.first);
  std::vector<std::size_t> corners;
  for (std::size_t i = 0; i <= run.sides; ++i) corners.push_back(side(run.first + i).corner);
  const RunLabels labels{here.label, before.label, after.label};
  const Path path =
      labels.before == labels.after ? straight_path(corners, labels.before) : turning_path(corners, labels);
  const std::size_t new_corner = points_.size();
  if (path.has_new_corner && !add_corner(corners, labels)) return false;

  std::vector<Side> line;
  const auto add_to_line = [&](std::size_t corner, const Side& like) {
    line.push_back({corner, like.label, like.source});
  };
  for (std::size_t n = 0; n + 1 < path.places.size(); ++n) {
    const std::size_t from = path.places[n], to = path.places[n + 1];
    const bool turns = path.has_new_corner && n + 1 == path.turn;
    std::vector<std::size_t> polygon(corners.begin() + static_cast<std::ptrdiff_t>(from),
                                     corners.begin() + static_cast<std::ptrdiff_t>(to) + 1);
    add_to_line(corners[from], n < path.turn ? before : after);
    if (turns) {
      polygon.push_back(new_corner);
      add_to_line(new_corner, after);
    }
    if (polygon.size() < 3) continue;
    if (turns) {
      add_line(corners[from], new_corner);
      add_line(new_corner, corners[to]);
    } else {
      add_line(corners[from], corners[to]);
    }
    if (!add_polygon(polygon, side(run.first + from))) return false;
  }
  std::rotate(sides_.begin(), sides_.begin() + static_cast<std::ptrdiff_t>(run.first), sides_.end());
  sides_.erase(sides_.begin(), sides_.begin() + static_cast<std::ptrdiff_t>(run.sides));
  sides_.insert(sides_.begin(), line.begin(), line.end());
  if (path.has_new_corner) filled_.corners.push_back(points_[new_corner]);
  return true;
}

bool GapFiller::add_polygon(const std::vector<std::size_t>& corners, const Side& like) {
  if (corners.size() < 3) return true;  // two sides that meet
  std::vector<Vec3> points;
  for (const std::size_t corner : corners) points.push_back(points_[corner]);
  const std::vector<Triangle> triangles = best_triangulation(points, labels_[like.label].plane.normal);
  if (triangles.empty()) return false;
  for (const auto& [a, b, c] : triangles) {
    add_triangle(points[a], points[b], points[c]);
    filled_.triangles.push_back({static_cast<std::uint32_t>(corners[a]), static_cast<std::uint32_t>(corners[b]),
                                 static_cast<std::uint32_t>(corners[c])});
    filled_.sources.push_back(like.source);
  }
  return true;
}

}  // namespace

bool are_on_mesh(std::span<const Vec3> points, const DistanceEvaluator& distance, double off) {
  std::vector<double> distances(points.size());
  distance.evaluate(points, distances, off);
  return std::ranges::all_of(distances, [&](double d) { return d <= off; });
}

std::optional<GapFill> fill_gap(const GapLoop& loop, const TriangleMesh& input, const GapLimits& limits) {
  return GapFiller(loop, input, limits).fill();
}

std::optional<GapFill> fill_gap_from(const Vec3& corner, const GapLoop& loop, const TriangleMesh& input,
                                     const GapLimits& limits) {
  return GapFiller(loop, input, limits).fill_from(corner);
}

}  // namespace raycone
