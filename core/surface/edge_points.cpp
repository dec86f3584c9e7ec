#include "core/surface/edge_points.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <mutex>
#include <optional>

#include "core/machine/first_touch.h"
#include "core/machine/threads.h"
#include "core/surface/edge_crossing.h"
#include "core/surface/edge_roots.h"

namespace raycone {
namespace {

// Hits that are nearer to each other, as fractions of an edge, are one: of triangles that share an edge.
constexpr double kSameHit = 0x1p-40;

// An edge of which more has to be known than where it meets triangles.
struct OpenEdge {
  MixedEdge edge;
  std::vector<SegmentHit> hits;  // one for each place
  std::size_t first_probe = 0;   // of those that each hit has
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
    find_hits();
    rule_.is_closed() ? decide_closed() : decide_open();
    find_roots(brackets_, [&](const std::vector<Vec3>& places) { return rule_.near(places); });
    for (const Bracket& bracket : brackets_) {
      points_[bracket.edge.number] = {bracket.edge.point(within(bracket.root)), kHole};
    }
    return std::move(points_);
  }

 private:
  void find_hits();
  void decide_closed();
  void decide_open();
  void decide(const OpenEdge& open);

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
  struct Sides {
    bool before, behind;  // whether the rule holds there
  };
  std::vector<Sides> sides_;  // of each hit of the edge at hand
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

void EdgePointFinder::find_hits() {
  std::mutex mutex;
  parallel_for(cells_.cells().size(), 1024, [&](std::size_t begin, std::size_t end) {
    std::vector<SegmentHit> hits;
    std::vector<OpenEdge> open;
    HitFinder finder(mesh_);
    for (auto n = static_cast<std::uint32_t>(begin); n < end; ++n) {
      const SurfaceCell& cell = cells_.cells()[n];
      const bool from_inside = cell.is_inside(0);
      finder.enter(cells_.corner(cell, 0), triangles_.of(n));
      cells_.for_each_edge(cell, [&](const MixedEdge& edge) {
        finder.find(from_inside ? edge.outside : edge.inside, from_inside, hits);
        keep_places(hits);
        // A closed mesh changes w nowhere else.
        if (rule_.is_closed() && hits.size() == 1) {
          set_hit(edge, hits.front());
        } else {
          open.push_back({edge, hits});
        }
      });
    }
    const std::scoped_lock lock(mutex);
    std::ranges::move(open, std::back_inserter(open_));
  });
  std::ranges::sort(open_, {}, [](const OpenEdge& open) { return open.edge.number; });
}

// Between places, where w of a closed mesh is constant; the last one is not asked for.
double behind_in_closed(const std::vector<SegmentHit>& hits, std::size_t i) {
  const double here = hits[i].at, next = i + 1 < hits.size() ? hits[i + 1].at : 1.0;
  return here + (next - here) / 2;
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

void EdgePointFinder::decide_closed() {
  std::vector<Vec3> points;
  for (OpenEdge& open : open_) {
    open.first_probe = points.size();
    for (std::size_t i = 0; i < open.hits.size(); ++i)
      points.push_back(open.edge.point(behind_in_closed(open.hits, i)));
  }
  const std::vector<double> values = rule_.at(points);
  for (const OpenEdge& open : open_) {
    sides_.clear();
    for (std::size_t i = 0; i < open.hits.size(); ++i) sides_.push_back({true, values[open.first_probe + i] >= 0.0});
    decide(open);
  }
}

// What is behind a place follows from what is before it where one triangle makes the difference, and leaves the rule in
// no doubt.
void EdgePointFinder::decide_open() {
  constexpr double kClear = 0x1p-10;  // far more than w changes by itself from just before a place to just behind it
  std::vector<Vec3> points;
  for (OpenEdge& open : open_) {
    open.first_probe = points.size();
    for (std::size_t i = 0; i < open.hits.size(); ++i) points.push_back(open.edge.point(before(open.hits, i)));
  }
  const std::vector<double> w = rule_.winding_numbers(points);
  const auto clear_behind = [&](const OpenEdge& open, std::size_t i) -> std::optional<bool> {
    const int jump = open.hits[i].jump;
    const double value = jump != 0 ? rule_.from_threshold(w[open.first_probe + i] + jump) : 0.0;
    return std::abs(value) > kClear ? std::optional(value > 0.0) : std::nullopt;
  };
  points.clear();
  for (const OpenEdge& open : open_) {
    for (std::size_t i = 0; i < open.hits.size(); ++i) {
      if (!clear_behind(open, i)) points.push_back(open.edge.point(behind(open.hits, i)));
    }
  }
  const std::vector<double> values_behind = rule_.at(points);
  std::size_t next = 0;
  for (const OpenEdge& open : open_) {
    sides_.clear();
    for (std::size_t i = 0; i < open.hits.size(); ++i) {
      const std::optional<bool> clear = clear_behind(open, i);
      const bool is_behind = clear ? *clear : values_behind[next++] >= 0.0;
      sides_.push_back({rule_.from_threshold(w[open.first_probe + i]) >= 0.0, is_behind});
    }
    decide(open);
  }
}

// Next to an end the rule is what it is there, whatever rounding makes of the probe.
void EdgePointFinder::decide(const OpenEdge& open) {
  double inside_until = 0.0;
  for (std::size_t i = 0; i < open.hits.size(); ++i) {
    const double here = open.hits[i].at;
    const bool is_last = i + 1 == open.hits.size();
    if (!sides_[i].before && here != 0.0) {
      brackets_.push_back({open.edge, inside_until, here});
      return;
    }
    if (!sides_[i].behind || (is_last && (rule_.is_closed() || here == 1.0))) {
      set_hit(open.edge, open.hits[i]);
      return;
    }
    inside_until = here;
  }
  brackets_.push_back({open.edge, inside_until, 1.0});
}

}  // namespace

std::vector<EdgePoint> edge_points(const TriangleMesh& mesh, const WindingNumberEvaluator& evaluator, const Rule& rule,
                                   const SurfaceCells& cells, const CellTriangles& triangles,
                                   const SurfaceMargins& margins) {
  return EdgePointFinder(mesh, RuleAlong(evaluator, rule), cells, triangles, margins.inner).find();
}

}  // namespace raycone
