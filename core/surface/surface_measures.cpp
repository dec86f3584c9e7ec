#include "core/surface/surface_measures.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/cells/unit_normal.h"
#include "core/distance/distance.h"
#include "core/exact/scale.h"
#include "core/machine/threads.h"
#include "core/mesh/components.h"
#include "core/surface/surface.h"

namespace raycone {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The distance of a point from some point of a triangle: that below it, or the nearest by its barycentric coordinates.
// Off by a few roundings of the coordinates, but 0 for a corner. Infinite where differences overflow.
double distance_at_most(const TriangleMesh& mesh, std::uint32_t triangle, const Vec3& p) {
  const Triangle& t = mesh.triangles[triangle];
  const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  if (p == a || p == b || p == c) return 0.0;
  const double size = largest_coordinate(box_of(b - a, c - a, p - a));
  if (!std::isfinite(size)) return kInfinity;
  const PowerOfTwo back(std::ilogb(size)), in_scale(-back.exponent());  // products of four lengths overflow otherwise
  const Vec3 u = in_scale(b - a), v = in_scale(c - a), from = in_scale(p - a);
  const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), pu = dot(from, u), pv = dot(from, v);
  const double determinant = uu * vv - uv * uv;
  double second = determinant > 0.0 ? std::clamp((vv * pu - uv * pv) / determinant, 0.0, 1.0) : 0.0;
  double third = determinant > 0.0 ? std::clamp((uu * pv - uv * pu) / determinant, 0.0, 1.0) : 0.0;
  const double sum = std::max(second + third, 1.0);
  second /= sum;
  third /= sum;
  return back(safe_norm(from - second * u - third * v));
}

// Of each vertex from the sources of its faces, at most; 0 where it has none.
std::vector<double> distances_from_sources(const SurfaceMesh& surface, const TriangleMesh& mesh) {
  constexpr std::size_t kFacesPerTask = 1024;
  constexpr double kNone = -1.0;
  std::vector<double> distances(surface.mesh.vertices.size(), kNone);
  parallel_for_each(surface.mesh.triangles.size(), kFacesPerTask, [&](std::size_t i) {
    if (surface.sources[i] == kHole) return;
    for (const std::uint32_t corner : surface.mesh.triangles[i]) {
      const std::atomic_ref least(distances[corner]);
      double known = least.load(std::memory_order_relaxed);
      if (known == 0.0) continue;
      const double here =
          distance_at_most(mesh, static_cast<std::uint32_t>(surface.sources[i]), surface.mesh.vertices[corner]);
      while ((known == kNone || here < known) && !least.compare_exchange_weak(known, here, std::memory_order_relaxed)) {
      }
    }
  });
  std::ranges::replace(distances, kNone, 0.0);
  return distances;
}

// Vertices are looked at by decreasing distance from their sources, which is theirs from the mesh nearly always: few
// need a search.
double largest_distance(const SurfaceMesh& surface, const TriangleMesh& mesh, const Lattice& lattice) {
  // Far more than what either distance rounds, and little beside the margin by which points may be off.
  constexpr double kRoundings = 64 * 0x1p-53, kRounding = 1.0 + 1e-9;
  // The lattice is around the surface.
  const double rounding = kRoundings * std::max(largest_coordinate(bounding_box(mesh)), largest_coordinate(lattice));
  const double near_rounding = kRoundings * largest_coordinate(lattice);
  const std::vector<double> at_most = distances_from_sources(surface, mesh);
  std::vector<std::uint32_t> waiting;
  for (std::uint32_t v = 0; v < at_most.size(); ++v) {
    if (at_most[v] > 0.0) waiting.push_back(v);
  }
  if (waiting.empty()) return 0.0;
  const DistanceEvaluator evaluator(mesh);
  double largest = 0.0;
  for (std::size_t round = 1024; !waiting.empty(); round *= 4) {
    const std::size_t count = std::min(round, waiting.size());
    const auto next = waiting.end() - static_cast<std::ptrdiff_t>(count);
    std::ranges::nth_element(waiting, next, {}, [&](std::uint32_t v) { return at_most[v]; });
    std::vector<Vec3> points;
    for (auto v = next; v != waiting.end(); ++v) points.push_back(surface.mesh.vertices[*v]);
    std::vector<double> distances(count);
    evaluator.evaluate(points, distances);
    for (std::size_t n = 0; n < count; ++n) {
      const double from_source = at_most[next[static_cast<std::ptrdiff_t>(n)]];
      // What is far from the lattice costs the evaluator digits there.
      largest = std::max(largest, from_source + near_rounding < distances[n] ? from_source : distances[n]);
    }
    waiting.erase(next, waiting.end());
    std::erase_if(waiting, [&](std::uint32_t v) { return at_most[v] * kRounding + rounding <= largest; });
  }
  return largest;
}

// Finds out which of the points that are dropped the lattice should have seen: of many at a time, so that neighbours
// among them share what it takes.
class MissedSamples {
 public:
  // `visit`: told the area and the triangle of each, in their order.
  using Visit = std::function<void(double area, std::uint32_t triangle)>;
  MissedSamples(const TriangleMesh& mesh, const RuleAlong& rule, const DroppedSamples& samples, Visit visit)
      : mesh_(mesh), rule_(rule), inside_(samples.inside()), thickness_(samples.thickness()), visit_(std::move(visit)) {
    step_ = surface_margin(inside_.lattice(), CoordinatePrecision::kDouble) * inside_.lattice().least_spacing();
  }

  // Where many are asked about, those that follow on a triangle are asked about together, ever more of them.
  void add(const AreaSamples& samples, const std::vector<bool>& dropped) {
    constexpr std::size_t kAtOnce = std::size_t{1} << 16;
    for (std::size_t n = 0; n < dropped.size(); ++n) {
      if (!dropped[n] || !(samples.areas[n] > 0.0)) continue;
      const std::optional<bool> within = is_within(samples.points[n]);
      if (!within) continue;
      if (thickness_ > 0.0) {
        if (!*within) visit_(samples.areas[n], samples.triangles[n]);
      } else {
        ask(samples.points[n], samples.areas[n], samples.triangles[n]);
      }
    }
    if (asked_.size() >= kAtOnce) finish();
  }

  // Visits those that wait. Comes last, too.
  void finish() {
    const std::vector<std::uint8_t> holds = rule_.holds_at(sides_);
    for (std::size_t i = 0; i < asked_.size(); ++i) {
      if (holds[2 * i] != holds[2 * i + 1]) visit_(asked_[i].area, asked_[i].triangle);
    }
    asked_.clear();
    sides_.clear();
  }

 private:
  struct Asked {
    double area;
    std::uint32_t triangle;
  };

  void ask(const Vec3& p, double area, std::uint32_t triangle) {
    constexpr std::size_t kMany = std::size_t{1} << 17;
    const std::size_t together = std::size_t{1} << std::min(asked_ever_ / kMany, std::size_t{48});
    if (!asked_.empty() && asked_.back().triangle == triangle && in_last_ < together) {
      asked_.back().area += area;
      ++in_last_;
      return;
    }
    in_last_ = 1;
    ++asked_ever_;
    const Triangle& t = mesh_.triangles[triangle];
    const Vec3 normal = unit_normal(mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]]);
    asked_.push_back({area, triangle});
    sides_.insert(sides_.end(), {p - step_ * normal, p + step_ * normal});
  }

  // Whether the nearest node is in the set; nothing outside of the lattice.
  [[nodiscard]] std::optional<bool> is_within(const Vec3& p) const {
    const Lattice& lattice = inside_.lattice();
    LatticeIndex node;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const double index = std::round(lattice.steps_from_first(axis, p[axis]));
      if (!(index >= 0.0 && index <= static_cast<double>(lattice.counts[a] - 1))) return std::nullopt;
      node[a] = static_cast<std::int64_t>(index);
    }
    return inside_.holds(node[0], node[1], node[2]);
  }

  const TriangleMesh& mesh_;
  const RuleAlong& rule_;
  const NodeSet& inside_;
  double thickness_, step_ = 0.0;
  Visit visit_;
  std::vector<Asked> asked_;
  std::size_t asked_ever_ = 0, in_last_ = 0;  // points that were asked about, and how many stand for the last one
  std::vector<Vec3> sides_;                   // two of each: before its triangle and behind it
};

}  // namespace

double hole_area(const SurfaceMesh& surface) {
  double area = 0.0;
  for (std::size_t i = 0; i < surface.mesh.triangles.size(); ++i) {
    if (surface.sources[i] == kHole) area += area_of_triangle(surface.mesh, surface.mesh.triangles[i]);
  }
  return area;
}

std::vector<bool> held_triangles(const SurfaceMesh& surface, const TriangleMesh& mesh) {
  constexpr double kAll = 1.0 - 0x1p-20;  // rounding of vertices moves sides of faces
  std::vector<double> areas(mesh.triangles.size(), 0.0);
  for (std::size_t face = 0; face < surface.sources.size(); ++face) {
    if (surface.sources[face] == kHole) continue;
    areas[static_cast<std::size_t>(surface.sources[face])] +=
        area_of_triangle(surface.mesh, surface.mesh.triangles[face]);
  }
  std::vector<bool> held(areas.size());
  for (std::size_t n = 0; n < areas.size(); ++n) {
    held[n] = areas[n] >= kAll * area_of_triangle(mesh, mesh.triangles[n]);
  }
  return held;
}

SurfaceMeasures measure_surface(const SurfaceMesh& surface, const TriangleMesh& mesh, const Lattice& lattice) {
  SurfaceMeasures measures;
  measures.components = components_of(surface.mesh).count;
  measures.max_distance = largest_distance(surface, mesh, lattice);
  measures.hole_area = hole_area(surface);
  return measures;
}

DroppedArea dropped_area(const TriangleMesh& mesh, DroppedSamples& dropped) {
  DroppedArea result;
  if (dropped.holds_all()) return result;
  double area = 0.0;  // in squares of a step
  dropped.for_each(mesh, [&](const AreaSamples& samples, const std::vector<bool>& is_dropped) {
    for (std::size_t n = 0; n < is_dropped.size(); ++n) area += is_dropped[n] ? samples.areas[n] : 0.0;
    result.samples += static_cast<std::uint64_t>(std::ranges::count(is_dropped, true));
  });
  result.area = area * dropped.step() * dropped.step();
  result.is_some = area > 0.0;
  return result;
}

ThinParts thin_parts(const TriangleMesh& mesh, const RuleAlong& rule, DroppedSamples& dropped) {
  const Components components = components_of(mesh);
  std::vector<bool> is_left(components.count, false), is_missed(components.count, false);
  const auto component_of = [&](std::uint32_t triangle) { return components.of_vertex[mesh.triangles[triangle][0]]; };
  ThinParts thin;
  double whole = 0.0;
  MissedSamples missed(mesh, rule, dropped, [&](double area, std::uint32_t triangle) {
    thin.area += area;
    is_missed[component_of(triangle)] = true;
  });
  dropped.for_each(mesh, [&](const AreaSamples& samples, const std::vector<bool>& is_dropped) {
    for (std::size_t n = 0; n < is_dropped.size(); ++n) {
      whole += samples.areas[n];
      if (!is_dropped[n]) is_left[component_of(samples.triangles[n])] = true;
    }
    missed.add(samples, is_dropped);
  });
  missed.finish();
  for (std::size_t c = 0; c < components.count; ++c) thin.lost += is_missed[c] && !is_left[c] ? 1 : 0;
  if (whole > 0.0) thin.of_all = thin.area / whole;
  thin.area *= dropped.step() * dropped.step();
  return thin;
}

}  // namespace raycone
