#include "core/cells/edge_points.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/cells/edge_crossing.h"
#include "core/cells/edge_roots.h"
#include "core/data/keep_where.h"
#include "core/machine/first_touch.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// Hits that are nearer to each other, as fractions of an edge, are one: of triangles that share an edge.
constexpr double kSameHit = 0x1p-40;

constexpr std::size_t kCellsPerTask = 1024, kBracketsPerTask = 4096;
// Their open edges take a few hundred bytes each until they are decided, and are enough for all threads.
constexpr std::size_t kCellsAtOnce = std::size_t{1} << 15;

// An edge of which more has to be known than where it meets triangles.
struct OpenEdge {
  MixedEdge edge;
  std::vector<SegmentHit> hits;  // one for each place
};

class EdgePointFinder {
 public:
  EdgePointFinder(const TriangleMesh& mesh, const RuleAlong& rule, const SurfaceCells& cells,
                  const CellTriangles& triangles, double margin)
      : mesh_(mesh),
        rule_(rule),
        cells_(cells),
        triangles_(triangles),
        margin_(margin),
        points_(sized_on_all_threads<EdgePoint>(cells.edges())) {}

  std::vector<EdgePoint> find() {
    for (std::size_t first = 0; first < cells_.cells().size(); first += kCellsAtOnce) {
      find_hits(first, std::min(first + kCellsAtOnce, cells_.cells().size()));
      decide();
      find_roots(brackets_, [&](const std::vector<Vec3>& places) { return rule_.near(places); });
      set_roots();
    }
    return std::move(points_);
  }

 private:
  // Whether the rule holds just before a place, and just behind it.
  struct Sides {
    bool before, behind;
  };
  void find_hits(std::size_t first, std::size_t end);
  void find_hits(std::uint32_t number, HitFinder& finder, std::vector<SegmentHit>& hits, std::vector<OpenEdge>& open);
  void decide();
  [[nodiscard]] std::vector<Sides> sides_in_closed(const std::vector<const OpenEdge*>& edges, std::size_t place) const;
  [[nodiscard]] std::vector<Sides> sides_in_open(const std::vector<const OpenEdge*>& edges, std::size_t place) const;
  [[nodiscard]] bool decides(const OpenEdge& open, std::size_t place, const Sides& sides);
  void set_roots();

  void set_hit(const MixedEdge& edge, const SegmentHit& hit) {
    points_[edge.number] = {edge.point(within(hit.at)), static_cast<std::int32_t>(hit.triangle)};
  }
  [[nodiscard]] double within(double at) const { return std::clamp(at, margin_, 1.0 - margin_); }

  const TriangleMesh& mesh_;
  const RuleAlong& rule_;
  const SurfaceCells& cells_;
  const CellTriangles& triangles_;
  double margin_;
  std::vector<EdgePoint> points_;
  std::vector<OpenEdge> open_;
  std::vector<Bracket> brackets_;
};

// Places where the edge meets triangles, one hit for each.
void keep_places(std::vector<SegmentHit>& hits) {
  std::size_t left = 0;
  for (const SegmentHit& hit : hits) {
    if (left > 0 && hit.at - hits[left - 1].at <= kSameHit) {
      hits[left - 1].jump = 0;
    } else {
      hits[left++] = hit;
    }
  }
  hits.resize(left);
}

// Finds where the edges of cells [first, end) meet triangles. Leaves in open_ those for which that is not enough.
void EdgePointFinder::find_hits(std::size_t first, std::size_t end) {
  std::vector<std::vector<OpenEdge>> open((end - first + kCellsPerTask - 1) / kCellsPerTask);
  parallel_for_each(open.size(), [&](std::size_t n) {
    std::vector<SegmentHit> hits;
    HitFinder finder(mesh_);
    const std::size_t from = first + n * kCellsPerTask;
    for (std::size_t cell = from; cell < std::min(end, from + kCellsPerTask); ++cell) {
      find_hits(static_cast<std::uint32_t>(cell), finder, hits, open[n]);
    }
  });
  open_.clear();
  for (std::vector<OpenEdge>& some : open) std::ranges::move(some, std::back_inserter(open_));
}

// The same for the edges of one cell. Sets the points that follow from hits alone.
void EdgePointFinder::find_hits(std::uint32_t number, HitFinder& finder, std::vector<SegmentHit>& hits,
                                std::vector<OpenEdge>& open) {
  const SurfaceCell& cell = cells_.cells()[number];
  const bool from_inside = cell.is_inside(0);
  finder.enter(cells_.corner(cell, 0), triangles_.of(number));
  cells_.for_each_edge(cell, [&](const MixedEdge& edge) {
    if (from_inside) {
      finder.find(edge.outside, HitFinder::Way::kFromEnd, hits);
    } else {
      finder.find(edge.inside, HitFinder::Way::kToEnd, hits);
    }
    keep_places(hits);
    // A closed mesh changes w nowhere else.
    if (rule_.is_closed() && hits.size() == 1) {
      set_hit(edge, hits.front());
    } else {
      open.push_back({edge, hits});
    }
  });
}

// Between places, where w of a closed mesh is constant; not behind the last one.
double behind_in_closed(const std::vector<SegmentHit>& hits, std::size_t i) {
  return hits[i].at + (hits[i + 1].at - hits[i].at) / 2;
}

// Just before and just behind a place.
constexpr double kStep = 0x1p-24;
double before(const std::vector<SegmentHit>& hits, std::size_t i) {
  const double here = hits[i].at, last = i > 0 ? hits[i - 1].at : 0.0;
  return here - std::min(kStep, (here - last) / 4);
}
double behind(const std::vector<SegmentHit>& hits, std::size_t i) {
  const double here = hits[i].at, next = i + 1 < hits.size() ? hits[i + 1].at : 1.0;
  return here + std::min(kStep, (next - here) / 4);
}

// Of all open edges the first place, then of those that are left the next one: most end at their first.
void EdgePointFinder::decide() {
  brackets_.clear();
  std::vector<const OpenEdge*> left;
  for (const OpenEdge& open : open_) {
    if (open.hits.empty()) {
      brackets_.push_back({open.edge, 0.0, 1.0});
    } else {
      left.push_back(&open);
    }
  }
  for (std::size_t place = 0; !left.empty(); ++place) {
    const std::vector<Sides> sides = rule_.is_closed() ? sides_in_closed(left, place) : sides_in_open(left, place);
    keep_where([&](std::size_t n) { return !decides(*left[n], place, sides[n]); }, left);
  }
}

// Behind the last place the rule does not hold, as it does not at the end of the edge.
std::vector<EdgePointFinder::Sides> EdgePointFinder::sides_in_closed(const std::vector<const OpenEdge*>& edges,
                                                                     std::size_t place) const {
  const auto is_last = [&](const OpenEdge* open) { return place + 1 == open->hits.size(); };
  std::vector<Vec3> points;
  for (const OpenEdge* open : edges) {
    if (!is_last(open)) points.push_back(open->edge.point(behind_in_closed(open->hits, place)));
  }
  const std::vector<std::uint8_t> holds_there = rule_.holds_at(points);
  std::vector<Sides> sides;
  std::size_t next = 0;
  for (const OpenEdge* open : edges) sides.push_back({true, !is_last(open) && holds_there[next++] != 0});
  return sides;
}

// What is behind a place follows from what is before it where one triangle makes the difference, and leaves the rule in
// no doubt.
std::vector<EdgePointFinder::Sides> EdgePointFinder::sides_in_open(const std::vector<const OpenEdge*>& edges,
                                                                   std::size_t place) const {
  constexpr double kClear = 0x1p-10;  // far more than w changes by itself from just before a place to just behind it
  const double clear = kClear + rule_.rough_doubt();
  std::vector<Vec3> points;
  for (const OpenEdge* open : edges) points.push_back(open->edge.point(before(open->hits, place)));
  const std::vector<double> w = rule_.winding_numbers(points);
  std::vector<Sides> sides;
  std::vector<std::size_t> doubtful;
  points.clear();
  for (std::size_t n = 0; n < edges.size(); ++n) {
    const double jump = edges[n]->hits[place].jump;
    const double value = jump != 0.0 ? rule_.from_threshold(w[n] + jump) : 0.0;
    sides.push_back({rule_.holds_for(w[n]), value > 0.0});
    if (std::abs(value) > clear) continue;
    doubtful.push_back(n);
    points.push_back(edges[n]->edge.point(behind(edges[n]->hits, place)));
  }
  const std::vector<std::uint8_t> holds_behind = rule_.holds_at(points);
  for (std::size_t i = 0; i < doubtful.size(); ++i) sides[doubtful[i]].behind = holds_behind[i] != 0;
  return sides;
}

// Whether the edge leaves the set at this place, or just before or behind it. Next to an end the rule is what it is at
// the end, whatever rounding makes of the probe.
bool EdgePointFinder::decides(const OpenEdge& open, std::size_t place, const Sides& sides) {
  const double here = open.hits[place].at, last = place > 0 ? open.hits[place - 1].at : 0.0;
  const bool is_last = place + 1 == open.hits.size();
  if (!sides.before && here != 0.0) {
    brackets_.push_back({open.edge, last, here});
    return true;
  }
  if (!sides.behind || (is_last && (rule_.is_closed() || here == 1.0))) {
    set_hit(open.edge, open.hits[place]);
    return true;
  }
  if (is_last) brackets_.push_back({open.edge, here, 1.0});
  return is_last;
}

void EdgePointFinder::set_roots() {
  parallel_for(brackets_.size(), kBracketsPerTask, [&](std::size_t begin, std::size_t end) {
    for (const Bracket& bracket : std::span(brackets_).subspan(begin, end - begin)) {
      points_[bracket.edge.number] = {bracket.edge.point(within(bracket.root)), kHole};
    }
  });
}

}  // namespace

std::vector<EdgePoint> edge_points(const TriangleMesh& mesh, const RuleAlong& rule, const SurfaceCells& cells,
                                   const CellTriangles& triangles, double margin) {
  return EdgePointFinder(mesh, rule, cells, triangles, margin).find();
}

}  // namespace raycone
