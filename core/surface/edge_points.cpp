#include "core/surface/edge_points.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <mutex>
#include <span>

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
  std::size_t first_probe = 0;
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
    decide_open_edges();
    find_roots(brackets_, [&](const std::vector<Vec3>& places) { return rule_.near(places); });
    for (const Bracket& bracket : brackets_) {
      points_[bracket.edge.number] = {bracket.edge.point(within(bracket.middle())), kHole};
    }
    return std::move(points_);
  }

 private:
  void find_hits();
  void decide_open_edges();
  void decide(const OpenEdge& open, std::span<const double> probes);

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
  const auto same = [](const SegmentHit& a, const SegmentHit& b) { return b.at - a.at <= kSameHit; };
  hits.erase(std::unique(hits.begin(), hits.end(), same), hits.end());
}

void EdgePointFinder::find_hits() {
  std::mutex mutex;
  parallel_for(cells_.cells().size(), 1024, [&](std::size_t begin, std::size_t end) {
    std::vector<SegmentHit> hits;
    std::vector<OpenEdge> open;
    HitFinder finder(mesh_);
    for (auto n = static_cast<std::uint32_t>(begin); n < end; ++n) {
      const SurfaceCell& cell = cells_.cells()[n];
      const Vec3 low = cells_.corner(cell, 0);
      finder.enter(low, triangles_.of(n));
      for (unsigned direction = 1; direction < kuhn::kCorners; ++direction) {
        if ((cell.mixed_directions() >> direction & 1U) == 0) continue;
        const Vec3 high = cells_.corner(cell, direction);
        const MixedEdge edge{cell.is_inside(0) ? low : high, cell.is_inside(0) ? high : low, cell.edge(direction)};
        finder.find(high, cell.is_inside(0), hits);
        keep_places(hits);
        // A closed mesh changes w nowhere else.
        if (rule_.is_closed() && hits.size() == 1) {
          set_hit(edge, hits.front());
        } else {
          open.push_back({edge, hits});
        }
      }
    }
    const std::scoped_lock lock(mutex);
    std::ranges::move(open, std::back_inserter(open_));
  });
  std::ranges::sort(open_, {}, [](const OpenEdge& open) { return open.edge.number; });
}

// Just before and just behind each place, or between places where w is constant there.
std::vector<double> probes_of(const OpenEdge& open, bool closed) {
  constexpr double kStep = 0x1p-24;
  std::vector<double> probes;
  for (std::size_t i = 0; i < open.hits.size(); ++i) {
    const double before = i > 0 ? open.hits[i - 1].at : 0.0, here = open.hits[i].at;
    const double behind = i + 1 < open.hits.size() ? open.hits[i + 1].at : 1.0;
    if (!closed) probes.push_back(here - std::min(kStep, (here - before) / 4));
    probes.push_back(closed ? here + (behind - here) / 2 : here + std::min(kStep, (behind - here) / 4));
  }
  return probes;
}

void EdgePointFinder::decide_open_edges() {
  std::vector<Vec3> points;
  for (OpenEdge& open : open_) {
    open.first_probe = points.size();
    for (const double probe : probes_of(open, rule_.is_closed())) points.push_back(open.edge.point(probe));
  }
  const std::vector<double> values = rule_.at(points);
  for (std::size_t i = 0; i < open_.size(); ++i) {
    const std::size_t end = i + 1 < open_.size() ? open_[i + 1].first_probe : values.size();
    decide(open_[i], std::span(values).subspan(open_[i].first_probe, end - open_[i].first_probe));
  }
}

void EdgePointFinder::decide(const OpenEdge& open, std::span<const double> probes) {
  const std::size_t probes_per_hit = rule_.is_closed() ? 1 : 2;
  double inside_until = 0.0;
  for (std::size_t i = 0; i < open.hits.size(); ++i) {
    const double here = open.hits[i].at;
    const bool last = i + 1 == open.hits.size();
    // Next to an end the rule is what it is there, whatever rounding makes of the probe.
    const bool before = rule_.is_closed() || here == 0.0 || probes[probes_per_hit * i] >= 0.0;
    const bool behind = !(last && (rule_.is_closed() || here == 1.0)) && probes[probes_per_hit * (i + 1) - 1] >= 0.0;
    if (!before) {
      brackets_.push_back({open.edge, inside_until, here});
      return;
    }
    if (!behind) {
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
