#include "core/surface/surface_measures.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/distance/distance.h"
#include "core/machine/threads.h"
#include "core/mesh/components.h"
#include "core/mesh/triangle_runs.h"
#include "core/surface/edge_crossing.h"
#include "core/surface/surface.h"

namespace raycone {
namespace {

double area_of_triangle(const TriangleMesh& mesh, const Triangle& t) {
  const Vec3& a = mesh.vertices[t[0]];
  return safe_norm(cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a)) / 2.0;
}

// The distance of a point from some point of a triangle: that below it, or the nearest by its barycentric coordinates.
// Off by a few roundings of the coordinates.
double distance_at_most(const TriangleMesh& mesh, std::uint32_t triangle, const Vec3& p) {
  const Triangle& t = mesh.triangles[triangle];
  const Vec3 &a = mesh.vertices[t[0]], u = mesh.vertices[t[1]] - a, v = mesh.vertices[t[2]] - a, from = p - a;
  const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), pu = dot(from, u), pv = dot(from, v);
  const double determinant = uu * vv - uv * uv;
  double second = determinant > 0.0 ? std::clamp((vv * pu - uv * pv) / determinant, 0.0, 1.0) : 0.0;
  double third = determinant > 0.0 ? std::clamp((uu * pv - uv * pu) / determinant, 0.0, 1.0) : 0.0;
  const double sum = std::max(second + third, 1.0);
  second /= sum;
  third /= sum;
  return safe_norm(from - second * u - third * v);
}

// Of each vertex from the sources of its faces, at most; -1 where it has none. `enough`: no need to look for less.
std::vector<double> distances_from_sources(const SurfaceMesh& surface, const TriangleMesh& mesh, double enough) {
  constexpr std::size_t kFacesPerTask = 1024;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<double> distances(surface.mesh.vertices.size(), kInfinity);
  parallel_for(surface.mesh.triangles.size(), kFacesPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (surface.sources[i] == kHole) continue;
      for (const std::uint32_t corner : surface.mesh.triangles[i]) {
        const std::atomic_ref least(distances[corner]);
        double known = least.load(std::memory_order_relaxed);
        if (known <= enough) continue;
        const double here =
            distance_at_most(mesh, static_cast<std::uint32_t>(surface.sources[i]), surface.mesh.vertices[corner]);
        while (here < known && !least.compare_exchange_weak(known, here, std::memory_order_relaxed)) {
        }
      }
    }
  });
  std::ranges::replace(distances, kInfinity, -1.0);
  return distances;
}

// Vertices are looked at by decreasing distance from their sources, which is theirs from the mesh nearly always: few
// need a search.
double largest_distance(const SurfaceMesh& surface, const TriangleMesh& mesh, const Lattice& lattice) {
  // Far more than what either distance rounds, and little beside the margin by which points may be off.
  constexpr double kRoundings = 64 * 0x1p-53, kRounding = 1.0 + 1e-9;
  // The lattice is around the surface.
  const double rounding = kRoundings * std::max(largest_coordinate(bounding_box(mesh)), largest_coordinate(lattice));
  const std::vector<double> at_most = distances_from_sources(surface, mesh, rounding);
  std::vector<std::uint32_t> waiting;
  for (std::uint32_t v = 0; v < at_most.size(); ++v) {
    if (at_most[v] >= 0.0) waiting.push_back(v);
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
    largest = std::max(largest, std::ranges::max(distances));
    waiting.erase(next, waiting.end());
    std::erase_if(waiting, [&](std::uint32_t v) { return at_most[v] * kRounding + rounding <= largest; });
  }
  return largest;
}

// The centres of parts of triangles, all about as large, and what area each of them stands for.
struct AreaSamples {
  std::vector<Vec3> points;
  std::vector<double> areas;  // in squares of sample_step()
  std::vector<std::uint32_t> triangles;
};

constexpr double kMostRows = 180.0;  // of a triangle: each is a small part then
constexpr double kPerStep = 1.4;     // rows, and parts of a row: two of them to a square of a step

double parts_of(double length, double step) { return std::clamp(std::ceil(kPerStep * length / step), 1.0, kMostRows); }

// In rows along the shortest side, so that needles have as few as their area asks for.
void add_samples(AreaSamples& samples, const TriangleMesh& mesh, std::uint32_t triangle, double step) {
  const Triangle& t = mesh.triangles[triangle];
  const auto side = [&](std::size_t n) { return mesh.vertices[t[(n + 2) % 3]] - mesh.vertices[t[(n + 1) % 3]]; };
  const std::array lengths{safe_norm(side(0)), safe_norm(side(1)), safe_norm(side(2))};
  const auto apex = static_cast<std::size_t>(std::ranges::min_element(lengths) - lengths.begin());
  const Vec3 &a = mesh.vertices[t[apex]], along = side((apex + 2) % 3), across = side(apex);
  const double area = safe_norm(cross((1.0 / step) * along, (1.0 / step) * across)) / 2.0;
  const double rows = parts_of(std::ranges::max(lengths), step), in_last_row = parts_of(lengths[apex], step);
  for (double row = 0.0; row < rows; row += 1.0) {
    const double from = row / rows, to = (row + 1.0) / rows, part = to * to - from * from;
    const double centre = (to * to * to - from * from * from) * 2.0 / 3.0 / part;
    const double count = std::ceil(to * in_last_row);
    for (double n = 0.5; n < count; n += 1.0) {
      samples.points.push_back(a + centre * (along + (n / count) * across));
      samples.areas.push_back(area * part / count);
      samples.triangles.push_back(triangle);
    }
  }
}

// That many or fewer, found in far less time than they are.
double most_samples(const TriangleMesh& mesh, std::uint32_t triangle, double step) {
  constexpr double kLonger = 2.0;  // at most, a side than its extent along an axis: above the square root of 3
  const Box box = box_of_triangle(mesh, triangle);
  const double rows = parts_of(kLonger * largest_coordinate(box.upper - box.lower), step);
  return rows * rows;
}

double sample_step(const Lattice& lattice) { return 0.5 * safe_norm(lattice.spacing); }

// Whether a surface between the nodes of a lattice is near to a point, as the nodes tell: it passes between any two
// neighbours of which just one is inside.
class NearByNodes {
 public:
  explicit NearByNodes(const NodeSet& inside) : inside_(inside) {
    // What numbers of cells round is less than a margin.
    constexpr double kLess = 0x1p-20, kMargins = 4.0;
    const double part = 1.0 - kLess - kMargins * surface_margin(inside.lattice(), false);
    const double most = part * safe_norm(inside.lattice().spacing);
    most_square_ = most * most;
  }

  // True only where there is a point of the surface nearer than a cell's diagonal. Nodes that are so near are joined by
  // edges of the lattice that are, too, by way of the nearest one: so if they are of both kinds, such an edge is mixed.
  [[nodiscard]] bool is_near(const Vec3& p) const {
    const Lattice& lattice = inside_.lattice();
    std::array<std::int64_t, 3> cell;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const double index = lattice.steps_from_first(axis, p[axis]);
      if (!(index >= 0.0 && index < static_cast<double>(lattice.counts[a] - 1))) return false;
      cell[a] = static_cast<std::int64_t>(index);
    }
    if (has_all_near(p, cell) && is_mixed(cell)) return true;
    return are_mixed(p, cell, 0, 1) || are_mixed(p, cell, -1, 2);
  }

 private:
  [[nodiscard]] double off(const Vec3& p, int axis, std::int64_t node) const {
    const Lattice& lattice = inside_.lattice();
    const double to = p[axis] - lattice.coordinate(axis, lattice.index_min[static_cast<std::size_t>(axis)] + node);
    return to * to;
  }

  // All corners of the cell, as those of most cells are.
  [[nodiscard]] bool has_all_near(const Vec3& p, const std::array<std::int64_t, 3>& cell) const {
    const auto most = [&](int axis) {
      const std::int64_t node = cell[static_cast<std::size_t>(axis)];
      return std::max(off(p, axis, node), off(p, axis, node + 1));
    };
    return most(1) + most(2) + most(0) < most_square_;
  }

  // Whether the cell has corners of both kinds.
  [[nodiscard]] bool is_mixed(const std::array<std::int64_t, 3>& cell) const {
    const auto [i, j, k] = cell;
    unsigned inside = 0;
    for (const std::int64_t z : {k, k + 1}) {
      for (const std::int64_t y : {j, j + 1})
        inside += (inside_.holds(i, y, z) ? 1U : 0U) + (inside_.holds(i + 1, y, z) ? 1U : 0U);
    }
    return inside != 0 && inside != 8;
  }

  // Whether nodes from `first` to `last`, as seen from the cell's lowest one, that are near are of both kinds.
  [[nodiscard]] bool are_mixed(const Vec3& p, const std::array<std::int64_t, 3>& cell, std::int64_t first,
                               std::int64_t last) const {
    const Lattice& lattice = inside_.lattice();
    const auto begin = [&](std::size_t axis) { return std::max<std::int64_t>(cell[axis] + first, 0); };
    const auto end = [&](std::size_t axis) { return std::min(cell[axis] + last, lattice.counts[axis] - 1) + 1; };
    bool any = false, all = true;
    for (std::int64_t k = begin(2); k < end(2); ++k) {
      for (std::int64_t j = begin(1); j < end(1); ++j) {
        const double off_row = off(p, 1, j) + off(p, 2, k);
        for (std::int64_t i = begin(0); i < end(0); ++i) {
          if (!(off_row + off(p, 0, i) < most_square_)) continue;
          const bool holds = inside_.holds(i, j, k);
          any = any || holds;
          all = all && holds;
          if (any && !all) return true;
        }
      }
    }
    return false;
  }

  const NodeSet& inside_;
  double most_square_;
};

// Finds out which points of triangles are dropped: farther from the surface than a cell's diagonal and the thickness.
class DroppedSamples {
 public:
  DroppedSamples(const SurfaceMesh& surface, const NodeSet& inside, double thickness)
      : surface_(surface),
        near_(inside),
        step_(sample_step(inside.lattice())),
        most_(safe_norm(inside.lattice().spacing) + thickness) {}

  // Calls visit(samples, is_dropped) for the points of some triangles of the mesh at a time, in their order.
  template <class Visit>
  void for_each(const TriangleMesh& mesh, const Visit& visit) {
    constexpr std::size_t kPartsAtOnce = 64;
    for (std::size_t next = 0; next < mesh.triangles.size();) {
      std::vector<Part> parts;
      while (parts.size() < kPartsAtOnce && next < mesh.triangles.size()) {
        parts.push_back(part_from(mesh, next));
        next = parts.back().end;
      }
      parallel_for_each(parts.size(), [&](std::size_t n) { take_samples(mesh, parts[n]); });
      decide(parts);
      for (const Part& part : parts) visit(part.samples, part.dropped);
    }
  }

 private:
  // Of some triangles.
  struct Part {
    std::size_t begin, end;
    AreaSamples samples{};
    std::vector<bool> dropped{};
    std::vector<std::size_t> doubtful{};  // samples
  };

  // As many triangles as a task has enough to do with.
  [[nodiscard]] Part part_from(const TriangleMesh& mesh, std::size_t begin) const {
    constexpr double kEnough = 4096.0;
    Part part{begin, begin};
    for (double samples = 0.0; part.end < mesh.triangles.size() && samples < kEnough; ++part.end) {
      samples += most_samples(mesh, static_cast<std::uint32_t>(part.end), step_);
    }
    return part;
  }

  void take_samples(const TriangleMesh& mesh, Part& part) const {
    for (std::size_t i = part.begin; i < part.end; ++i) {
      add_samples(part.samples, mesh, static_cast<std::uint32_t>(i), step_);
    }
    part.dropped.resize(part.samples.points.size(), false);
    for (std::size_t n = 0; n < part.samples.points.size(); ++n) {
      if (!near_.is_near(part.samples.points[n])) part.doubtful.push_back(n);
    }
  }

  void decide(std::vector<Part>& parts) {
    std::vector<Vec3> points;
    for (const Part& part : parts) {
      for (const std::size_t n : part.doubtful) points.push_back(part.samples.points[n]);
    }
    if (points.empty()) return;
    if (!distance_) distance_.emplace(surface_.mesh);
    std::vector<double> distances(points.size());
    distance_->evaluate(points, distances, most_);
    auto distance = distances.cbegin();
    for (Part& part : parts) {
      for (const std::size_t n : part.doubtful) part.dropped[n] = *distance++ > most_;
    }
  }

  const SurfaceMesh& surface_;
  NearByNodes near_;
  double step_, most_;
  std::optional<DistanceEvaluator> distance_;  // of the surface: most need it for no sample
};

// Finds out which of the points that are dropped the lattice should have seen: of many at a time, so that neighbours
// among them share what it takes.
class MissedSamples {
 public:
  // `visit`: told the area and the triangle of each, in their order.
  using Visit = std::function<void(double area, std::uint32_t triangle)>;
  MissedSamples(const TriangleMesh& mesh, const RuleAlong& rule, const NodeSet& inside, double thickness, Visit visit)
      : mesh_(mesh), rule_(rule), inside_(inside), thickness_(thickness), visit_(std::move(visit)) {
    step_ = surface_margin(inside.lattice(), false) * inside.lattice().least_spacing();
  }

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
    const Triangle& t = mesh_.triangles[triangle];
    const Vec3 normal = unit_normal(mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]]);
    asked_.push_back({area, triangle});
    sides_.insert(sides_.end(), {p - step_ * normal, p + step_ * normal});
  }

  // Whether the nearest node is in the set; nothing outside of the lattice.
  [[nodiscard]] std::optional<bool> is_within(const Vec3& p) const {
    const Lattice& lattice = inside_.lattice();
    std::array<std::int64_t, 3> node;
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
  std::vector<Vec3> sides_;  // two of each: before its triangle and behind it
};

}  // namespace

SurfaceMeasures measure_surface(const SurfaceMesh& surface, const TriangleMesh& mesh, const NodeSet& inside,
                                double thickness) {
  SurfaceMeasures measures;
  measures.components = components_of(surface.mesh).count;
  measures.max_distance = largest_distance(surface, mesh, inside.lattice());
  for (std::size_t i = 0; i < surface.mesh.triangles.size(); ++i) {
    if (surface.sources[i] == kHole) measures.hole_area += area_of_triangle(surface.mesh, surface.mesh.triangles[i]);
  }
  double dropped_area = 0.0;  // in squares of sample_step()
  const auto add = [&](const AreaSamples& samples, const std::vector<bool>& dropped) {
    for (std::size_t n = 0; n < dropped.size(); ++n) dropped_area += dropped[n] ? samples.areas[n] : 0.0;
    measures.dropped_samples += static_cast<std::uint64_t>(std::ranges::count(dropped, true));
  };
  DroppedSamples(surface, inside, thickness).for_each(mesh, add);
  const double step = sample_step(inside.lattice());
  measures.dropped_area = dropped_area * step * step;
  measures.drops = dropped_area > 0.0;
  return measures;
}

ThinParts thin_parts(const SurfaceMesh& surface, const TriangleMesh& mesh, const RuleAlong& rule, const NodeSet& inside,
                     double thickness) {
  const Components components = components_of(mesh);
  std::vector<bool> is_left(components.count, false), is_missed(components.count, false);
  const auto component_of = [&](std::uint32_t triangle) { return components.of_vertex[mesh.triangles[triangle][0]]; };
  ThinParts thin;
  double whole = 0.0;
  MissedSamples missed(mesh, rule, inside, thickness, [&](double area, std::uint32_t triangle) {
    thin.area += area;
    is_missed[component_of(triangle)] = true;
  });
  const auto add = [&](const AreaSamples& samples, const std::vector<bool>& dropped) {
    for (std::size_t n = 0; n < dropped.size(); ++n) {
      whole += samples.areas[n];
      if (!dropped[n]) is_left[component_of(samples.triangles[n])] = true;
    }
    missed.add(samples, dropped);
  };
  DroppedSamples(surface, inside, thickness).for_each(mesh, add);
  missed.finish();
  for (std::size_t c = 0; c < components.count; ++c) thin.lost += is_missed[c] && !is_left[c] ? 1 : 0;
  const double step = sample_step(inside.lattice());
  if (whole > 0.0) thin.of_all = thin.area / whole;
  thin.area *= step * step;
  return thin;
}

}  // namespace raycone
