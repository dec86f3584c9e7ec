// A plane sweep from left to right over the points where corners are (Shamos and Hoey, "Geometric intersection
// problems", 1976, and Hertel and Mehlhorn, "Fast triangulation of the plane with respect to simple polygons", 1985).
//
// Edges end where they meet a corner, and what of them lies on one line and between the same points is one edge that
// remembers how often the polygon runs along it. The edges that the sweep line meets divide it into gaps; the number of
// times that the polygon winds around a gap's points must be 0 (outside) or 1 (inside).
//
// Each gap inside has a chain of points, from the left end of the edge below to the left end of the edge above: left of
// the chain all is cut already. Chains turn left nowhere, seen upwards, so that a point to the right of one sees its
// latest point, and from there on all edges that are turned to it.
//
// Why what is cut this way covers the polygon once: docs/method.md, "Polygons".
#include "core/mesh/polygon_cut.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <numeric>
#include <set>
#include <utility>

#include "core/exact/projection.h"

namespace raycone {
namespace {

using PointIndex = std::uint32_t;  // its number in the order of the sweep
constexpr std::uint32_t kNoCorner = 0xFFFFFFFF;

// What of the polygon runs along a line, from a point that is known to `end`, further right.
struct Run {
  PointIndex end;
  PointIndex first;    // leftmost point of all runs that overlap on the line; kNoCorner: an edge of the polygon, whole
  std::int64_t count;  // how often to the right, less to the left
  std::uint32_t next = kNoCorner;  // in a list of runs that start at one point
};

struct Chain {
  std::uint32_t bottom = kNoCorner, top = kNoCorner, latest = kNoCorner;  // links
};

struct Link {
  PointIndex point;
  std::uint32_t below = kNoCorner, above = kNoCorner;
};

struct Gap {
  bool inside = false;
  Chain chain;  // where inside
};

// An edge that the sweep line meets.
struct SweepEdge {
  PointIndex left, right;
  PointIndex first;  // as of a run
  std::int64_t count;
  mutable Gap above;  // no part of the order of edges
};

class PolygonCut {
 public:
  PolygonCut(std::span<const Vec3> corners, const Vec3& direction) : corners_(corners), direction_(direction) {}

  // False where the polygon is not simple.
  bool cut() {
    if (!find_points()) return false;
    for (PointIndex p = 0; p < corner_at_.size(); ++p)
      if (!visit(p)) return false;
    return true;
  }

  [[nodiscard]] std::vector<std::array<std::uint32_t, 3>> take() { return std::move(triangles_); }

 private:
  struct Below {
    using is_transparent = void;
    const PolygonCut* polygon;
    bool operator()(const SweepEdge& a, const SweepEdge& b) const {
      if (a.left == b.left) return polygon->turn(a.left, a.right, b.right) > 0;
      return a.left < b.left ? polygon->side(a, b.left) > 0 : polygon->side(b, a.left) < 0;
    }
    bool operator()(const SweepEdge& a, PointIndex p) const { return polygon->side(a, p) > 0; }
  };
  using Edges = std::set<SweepEdge, Below>;
  using At = Edges::iterator;

  // --- Geometry -----------------------------------------------------------------------------------------------------

  [[nodiscard]] const Vec3& at(PointIndex p) const { return corners_[corner_at_[p]]; }

  [[nodiscard]] int turn(PointIndex a, PointIndex b, PointIndex c) const {
    if (a == b || b == c || c == a) return 0;
    return raycone::turn(direction_, at(a), at(b), at(c));
  }

  // Of two runs from a point: 1 where the second is above the first. Those of one group need no exact number to tell.
  [[nodiscard]] int turn(PointIndex from, const Run& a, const Run& b) const {
    return a.first == b.first && a.first != kNoCorner ? 0 : turn(from, a.end, b.end);
  }

  // 1 where the point is above the edge, 0 where it is on its line.
  [[nodiscard]] int side(const SweepEdge& edge, PointIndex p) const { return turn(edge.left, edge.right, p); }

  // --- Points -------------------------------------------------------------------------------------------------------

  // Numbers the points and notes the polygon's edges where they start. False where two of them project to one.
  bool find_points() {
    const SweepOrder order(direction_);
    std::vector<std::uint32_t> sorted(corners_.size());
    std::iota(sorted.begin(), sorted.end(), 0U);
    std::sort(sorted.begin(), sorted.end(), [&](std::uint32_t a, std::uint32_t b) {
      const int sign = corners_[a] == corners_[b] ? 0 : order(corners_[a], corners_[b]);
      return sign != 0 ? sign < 0 : a < b;
    });
    std::vector<PointIndex> point_of(corners_.size());
    corner_at_.reserve(corners_.size());
    for (const std::uint32_t corner : sorted) {
      if (corner_at_.empty() || corners_[corner_at_.back()] != corners_[corner]) {
        if (!corner_at_.empty() && order(corners_[corner_at_.back()], corners_[corner]) == 0) return false;
        corner_at_.push_back(corner);
      }
      point_of[corner] = static_cast<PointIndex>(corner_at_.size() - 1);
    }
    starting_.assign(corner_at_.size(), kNoCorner);
    ends_.assign(corner_at_.size(), 0);
    runs_.reserve(corners_.size());
    triangles_.reserve(corners_.size());
    for (std::size_t i = 0; i < point_of.size(); ++i) {
      const PointIndex a = point_of[i], b = point_of[i + 1 < point_of.size() ? i + 1 : 0];
      if (a != b) add_run(std::min(a, b), {std::max(a, b), kNoCorner, a < b ? 1 : -1});
    }
    return true;
  }

  void add_run(PointIndex start, Run run) {
    run.next = starting_[start];
    if (unused_ == kNoCorner) {
      starting_[start] = static_cast<std::uint32_t>(runs_.size());
      runs_.push_back(run);
    } else {
      starting_[start] = unused_;
      unused_ = runs_[unused_].next;
      runs_[starting_[start]] = run;
    }
  }

  // Moves the runs that start at a point to leaving_.
  void take_runs(PointIndex p) {
    for (std::uint32_t i = starting_[p]; i != kNoCorner;) {
      leaving_.push_back(runs_[i]);
      runs_[i].next = unused_;
      unused_ = i;
      i = leaving_.back().next;
    }
  }

  // --- Sweep --------------------------------------------------------------------------------------------------------

  // False where edges cross before p but not at a corner, or p borders on a gap that is wound around otherwise than 0
  // or 1 times.
  bool visit(PointIndex p) {
    At edge = edges_.lower_bound(p);
    const At begin = edge;
    Gap low = edge == edges_.begin() ? Gap{} : std::prev(edge)->above, high = low;
    leaving_.clear();
    for (; edge != edges_.end() && side(*edge, p) == 0; ++edge) {
      if (edge != begin && high.inside && !close(high.chain, p)) return false;
      high = edge->above;
      add_flat(edge->first, edge->left, p, -edge->count);
      if (edge->right != p) leaving_.push_back({edge->right, edge->first, edge->count});
      --ends_[edge->right];
    }
    // Edges that have crossed are in a wrong order, and the first of them that a point lies on, or between, shows it.
    if (ends_[p] != 0 || (edge != edges_.end() && side(*edge, p) > 0)) return false;
    if (edge == begin && low.inside) split(low.chain, high.chain);
    if (low.inside) add_above(low.chain, p);
    if (high.inside) add_below(high.chain, p);
    edges_.erase(begin, edge);
    take_runs(p);
    return leave(p, edge, low, high);
  }

  // Inserts the edges that start at p, between the gaps `low` and `high`. What they are wound around by fits together
  // unless edges have crossed.
  bool leave(PointIndex p, At next, Gap low, const Gap& high) {
    if (leaving_.empty() && low.inside != high.inside) return false;
    if (leaving_.empty() && low.inside) low.chain = joined(low.chain, high.chain);
    if (next != edges_.begin()) std::prev(next)->above = low;
    sort_leaving(p);
    bool inside = low.inside;
    for (std::size_t i = 0, end = 0; i < leaving_.size(); i = end) {
      end = i + 1;
      while (end < leaving_.size() && turn(p, leaving_[end - 1], leaving_[end]) == 0) ++end;
      SweepEdge edge = merge(p, i, end);
      const std::int64_t winding = edge.count + (inside ? 1 : 0);
      if (winding != 0 && winding != 1) return false;
      inside = winding == 1;
      if (end == leaving_.size() && inside != high.inside) return false;
      if (end == leaving_.size())
        edge.above = high;
      else if (inside)
        edge.above = {true, single(p)};
      edges_.insert(next, edge);
      ++ends_[edge.right];
    }
    return true;
  }

  // Upwards by direction, from p on one line outwards.
  void sort_leaving(PointIndex p) {
    if (leaving_.size() < 2) return;
    std::sort(leaving_.begin(), leaving_.end(), [&](const Run& a, const Run& b) {
      const int sign = turn(p, a, b);
      return sign != 0 ? sign > 0 : a.end < b.end;
    });
  }

  // The edge from p to the nearest end of the runs [begin, end) of leaving_, which lie on one line. What is beyond
  // waits there, each point of it once, so that many long runs on one line do not take quadratic time.
  SweepEdge merge(PointIndex p, std::size_t begin, std::size_t end) {
    PointIndex first = p;
    for (std::size_t i = begin; i < end; ++i) first = std::min(first, leaving_[i].first);
    std::int64_t count = 0, whole = 0;
    for (std::size_t i = end; i-- > begin;) {
      const Run& run = leaving_[i];
      count += run.count;
      if (run.first == kNoCorner) whole += run.count;
      const PointIndex before = i > begin ? leaving_[i - 1].end : p;
      if (before == run.end) continue;
      add_flat(first, p, run.end, whole);
      whole = 0;
      if (i > begin) add_run(before, {run.end, first, count});
    }
    return {p, leaving_[begin].end, first, count, {}};
  }

  // --- Chains -------------------------------------------------------------------------------------------------------

  std::uint32_t link(PointIndex p) {
    links_.push_back({p});
    return static_cast<std::uint32_t>(links_.size() - 1);
  }

  Chain single(PointIndex p) {
    const std::uint32_t only = link(p);
    return {only, only, only};
  }

  void connect(std::uint32_t below, std::uint32_t above) {
    links_[below].above = above;
    links_[above].below = below;
  }

  // Divides a chain, which both start with, at its latest point, which both keep.
  void split(Chain& low, Chain& high) {
    const std::uint32_t copy = link(links_[low.latest].point), above = links_[low.latest].above;
    if (above != kNoCorner) connect(copy, above);
    high = {copy, above != kNoCorner ? low.top : copy, copy};
    links_[low.latest].above = kNoCorner;
    low.top = low.latest;
  }

  // Of two chains of which one ends where the other starts.
  Chain joined(const Chain& low, const Chain& high) {
    connect(low.top, links_[high.bottom].above);
    return {low.bottom, high.top, low.top};
  }

  // Cuts off what p sees, next to the edge above.
  void add_above(Chain& chain, PointIndex p) {
    while (links_[chain.top].below != kNoCorner && cut_off(links_[chain.top].below, p, chain.top))
      chain.top = links_[chain.top].below;
    chain.latest = link(p);
    connect(chain.top, chain.latest);
    chain.top = chain.latest;
  }

  // Likewise, next to the edge below.
  void add_below(Chain& chain, PointIndex p) {
    while (links_[chain.bottom].above != kNoCorner && cut_off(chain.bottom, p, links_[chain.bottom].above))
      chain.bottom = links_[chain.bottom].above;
    chain.latest = link(p);
    connect(chain.latest, chain.bottom);
    chain.bottom = chain.latest;
  }

  // Where both edges end at p. False where a triangle is turned over.
  bool close(const Chain& chain, PointIndex p) {
    for (std::uint32_t i = chain.bottom; i != chain.top; i = links_[i].above) {
      const PointIndex low = links_[i].point, high = links_[links_[i].above].point;
      if (turn(low, p, high) < 0) return false;
      add_triangle(low, p, high);
    }
    return true;
  }

  bool cut_off(std::uint32_t low, PointIndex p, std::uint32_t high) {
    if (turn(links_[low].point, p, links_[high].point) <= 0) return false;
    add_triangle(links_[low].point, p, links_[high].point);
    return true;
  }

  // --- Triangles ----------------------------------------------------------------------------------------------------

  void add_triangle(PointIndex a, PointIndex b, PointIndex c) {
    triangles_.push_back({corner_at_[a], corner_at_[b], corner_at_[c]});
  }

  // `count` times the triangle of three points on a line, or that turned over: over all runs on the line, of the whole
  // edges less the edges that the sweep makes of them, these sum to their difference.
  void add_flat(PointIndex a, PointIndex b, PointIndex c, std::int64_t count) {
    if (a == b || b == c || c == a) return;
    for (; count > 0; --count) add_triangle(a, b, c);
    for (; count < 0; ++count) add_triangle(a, c, b);
  }

  std::span<const Vec3> corners_;
  Vec3 direction_;
  std::vector<std::uint32_t> corner_at_;  // one of those at each point
  std::vector<std::uint32_t> starting_;   // of each point, the first in the list of its runs
  std::vector<std::uint32_t> ends_;       // of each point, how many of edges_ end there
  std::vector<Run> runs_;
  std::uint32_t unused_ = kNoCorner;  // likewise, of those that can be used again
  std::vector<Run> leaving_;          // of the point that is visited
  std::vector<Link> links_;
  Edges edges_{Below{this}};
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

}  // namespace

std::optional<std::vector<std::array<std::uint32_t, 3>>> cut_polygon(std::span<const Vec3> corners,
                                                                     const Vec3& direction) {
  if (corners.size() >= std::size_t{1} << 29) return std::nullopt;  // links have 32 bits, of less than 6 a corner
  PolygonCut polygon(corners, direction);
  return polygon.cut() ? std::optional(polygon.take()) : std::nullopt;
}

}  // namespace raycone
