#include "core/surface/dropped_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/machine/threads.h"
#include "core/mesh/components.h"
#include "core/mesh/triangle_runs.h"
#include "core/surface/surface.h"

namespace raycone {
namespace {

constexpr double kMostParts = 180.0 * 180.0;  // of a triangle, rows times parts of a row: each is a small part then
constexpr double kOnSurface = 0x1p-9;         // voxels: more than planes of one surface are off each other
constexpr std::size_t kMostRemembered = std::size_t{1} << 27;  // samples, a bit each
constexpr double kPerStep = 1.4;  // rows, and parts of a row: two of them to a square of a step

double parts_of(double length, double step) { return std::clamp(std::ceil(kPerStep * length / step), 1.0, kMostParts); }

// One for all of it.
void add_sample(AreaSamples& samples, const TriangleMesh& mesh, std::uint32_t triangle, double step) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const Vec3 &first = mesh.vertices[a], &second = mesh.vertices[b], &third = mesh.vertices[c];
  samples.points.push_back((1.0 / 3.0) * (first + second + third));
  samples.areas.push_back(safe_norm(cross((1.0 / step) * (second - first), (1.0 / step) * (third - first))) / 2.0);
  samples.triangles.push_back(triangle);
}

// That many or fewer, found in far less time than they are.
double most_samples(const TriangleMesh& mesh, std::uint32_t triangle, double step) {
  constexpr double kLonger = 2.0;  // at most, a side than its extent along an axis: above the square root of 3
  const Box box = box_of_triangle(mesh, triangle);
  const double rows = parts_of(kLonger * largest_coordinate(box.upper - box.lower), step);
  return std::min(rows * rows, kMostParts);
}

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

}  // namespace

// In rows along the shortest side, so that needles have as few as their area asks for.
void add_samples(AreaSamples& samples, const TriangleMesh& mesh, std::uint32_t triangle, double step) {
  const Triangle& t = mesh.triangles[triangle];
  const auto side = [&](std::size_t n) { return mesh.vertices[t[(n + 2) % 3]] - mesh.vertices[t[(n + 1) % 3]]; };
  const std::array lengths{safe_norm(side(0)), safe_norm(side(1)), safe_norm(side(2))};
  const auto apex = static_cast<std::size_t>(std::ranges::min_element(lengths) - lengths.begin());
  const Vec3 &a = mesh.vertices[t[apex]], along = side((apex + 2) % 3), across = side(apex);
  const double area = safe_norm(cross((1.0 / step) * along, (1.0 / step) * across)) / 2.0;
  const double in_last_row = std::min(parts_of(lengths[apex], step), std::sqrt(kMostParts));
  const double rows = std::min(parts_of(std::ranges::max(lengths), step), std::floor(kMostParts / in_last_row));
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

// Of some triangles.
struct DroppedSamples::Part {
  std::size_t begin, end;
  AreaSamples samples{};
  std::vector<bool> dropped{};
  std::vector<std::size_t> doubtful{};  // samples
};

DroppedSamples::DroppedSamples(const SurfaceMesh& surface, const NodeSet& inside, double thickness,
                               std::vector<bool> held)
    : surface_(surface),
      inside_(inside),
      held_(std::move(held)),
      thickness_(thickness),
      step_(0.5 * safe_norm(inside.lattice().spacing)),
      most_(safe_norm(inside.lattice().spacing) + thickness),
      on_surface_(kOnSurface * inside.lattice().least_spacing()) {}

bool DroppedSamples::holds_all() const {
  return !held_.empty() && std::ranges::all_of(held_, [](bool is_held) { return is_held; });
}

void DroppedSamples::for_each(const TriangleMesh& mesh, const Visit& visit) {
  constexpr std::size_t kPartsAtOnce = 64;
  if (!(thickness_ > 0.0) && !is_decided_) find_lost_components(mesh);
  std::size_t sample = 0;
  for (std::size_t next = 0; next < mesh.triangles.size();) {
    std::vector<Part> parts;
    while (parts.size() < kPartsAtOnce && next < mesh.triangles.size()) {
      parts.push_back(part_from(mesh, next));
      next = parts.back().end;
    }
    parallel_for_each(parts.size(), [&](std::size_t n) {
      take_samples(mesh, parts[n]);
      if (!is_decided_) find_doubtful(parts[n]);
    });
    if (is_decided_) {
      for (Part& part : parts) {
        for (std::size_t n = 0; n < part.dropped.size(); ++n) part.dropped[n] = dropped_[sample++];
      }
    } else {
      decide(parts);
      remember(parts);
    }
    for (const Part& part : parts) visit(part.samples, part.dropped);
  }
  is_decided_ = dropped_.size() <= kMostRemembered;
}

// Until they are too many.
void DroppedSamples::remember(std::span<const Part> parts) {
  for (const Part& part : parts) {
    if (dropped_.size() > kMostRemembered) return;
    dropped_.insert(dropped_.end(), part.dropped.begin(), part.dropped.end());
  }
}

void DroppedSamples::find_lost_components(const TriangleMesh& mesh) {
  const Components components = components_of(mesh);
  const auto component_of = [&](std::size_t triangle) { return components.of_vertex[mesh.triangles[triangle][0]]; };
  std::vector<bool> has_face(components.count, false);
  for (const std::int32_t source : surface_.sources) {
    if (source != kHole) has_face[component_of(static_cast<std::size_t>(source))] = true;
  }
  is_of_lost_.resize(mesh.triangles.size());
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) is_of_lost_[n] = !has_face[component_of(n)];
}

// As many triangles as a task has enough to do with.
DroppedSamples::Part DroppedSamples::part_from(const TriangleMesh& mesh, std::size_t begin) const {
  constexpr double kEnough = 4096.0;
  Part part{begin, begin};
  for (double samples = 0.0; part.end < mesh.triangles.size() && samples < kEnough; ++part.end) {
    samples += is_held(part.end) ? 1.0 : most_samples(mesh, static_cast<std::uint32_t>(part.end), step_);
  }
  return part;
}

void DroppedSamples::take_samples(const TriangleMesh& mesh, Part& part) const {
  for (std::size_t i = part.begin; i < part.end; ++i) {
    const auto triangle = static_cast<std::uint32_t>(i);
    if (is_held(i)) {
      add_sample(part.samples, mesh, triangle, step_);
    } else {
      add_samples(part.samples, mesh, triangle, step_);
    }
  }
  part.dropped.resize(part.samples.points.size(), false);
}

void DroppedSamples::find_doubtful(Part& part) const {
  const NearByNodes nodes(inside_);
  for (std::size_t n = 0; n < part.samples.points.size(); ++n) {
    if (is_held(part.samples.triangles[n])) continue;
    if (is_of_lost(part.samples.triangles[n]) || !nodes.is_near(part.samples.points[n])) part.doubtful.push_back(n);
  }
}

void DroppedSamples::decide(std::span<Part> parts) {
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
    for (const std::size_t n : part.doubtful)
      part.dropped[n] = *distance++ > (is_of_lost(part.samples.triangles[n]) ? on_surface_ : most_);
  }
}

}  // namespace raycone
