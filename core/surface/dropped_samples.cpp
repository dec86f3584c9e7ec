#include "core/surface/dropped_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/cells/plane_tolerance.h"
#include "core/machine/threads.h"
#include "core/mesh/components.h"
#include "core/mesh/triangle_runs.h"

namespace raycone {
namespace {

constexpr double kMostParts = 180.0 * 180.0;  // of a triangle, rows times parts of a row: each is a small part then
constexpr double kOnSurface = 0x1p-9;         // voxels: more than planes of one surface are off each other
constexpr double kOffContour = 0.25;          // of a cell's diagonal: creases within a cell may be cut off by so much
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
};

double farthest_kept(const TriangleMesh& mesh, const Lattice& lattice, SurfaceFaces faces,
                     CoordinatePrecision precision) {
  const double off_contour = kOffContour * safe_norm(lattice.spacing);
  if (faces == SurfaceFaces::kOfContour) return off_contour;
  constexpr double kTolerances = 2.0;  // two planes may each be off by one
  constexpr double kSingle = 0x1p-22;  // of a coordinate: more than it is off in single precision
  const double rounding = precision == CoordinatePrecision::kSingle ? kSingle * largest_coordinate(lattice) : 0.0;
  const double off = std::max(kOnSurface * lattice.least_spacing(), kTolerances * plane_tolerance(mesh, lattice));
  return std::min(std::max(off, rounding), off_contour);
}

// Samples that follow on each other, none of a triangle that is held.
struct DroppedSamples::Group {
  Part* part;
  std::size_t begin, end;
  Vec3 middle;
  double radius = 0.0;  // none is farther from the middle
  bool is_far = false;  // all are dropped
};

DroppedSamples::DroppedSamples(const SurfaceMesh& surface, const NodeSet& inside, double thickness, double farthest,
                               std::vector<bool> held)
    : surface_(surface),
      inside_(inside),
      held_(std::move(held)),
      thickness_(thickness),
      step_(0.5 * safe_norm(inside.lattice().spacing)),
      farthest_(farthest),
      on_surface_(std::min(farthest, kOnSurface * inside.lattice().least_spacing())) {}

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
    parallel_for_each(parts.size(), [&](std::size_t n) { take_samples(mesh, parts[n]); });
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

std::vector<DroppedSamples::Group> DroppedSamples::groups_of(std::span<Part> parts) const {
  constexpr std::size_t kMost = 16;
  std::vector<Group> groups;
  for (Part& part : parts) {
    const AreaSamples& samples = part.samples;
    for (std::size_t begin = 0, end = 0; begin < samples.points.size(); begin = end) {
      end = begin + 1;
      if (is_held(samples.triangles[begin])) continue;
      while (end < samples.points.size() && end - begin < kMost && !is_held(samples.triangles[end])) ++end;
      Group group{&part, begin, end, samples.points[begin + (end - begin) / 2]};
      for (std::size_t n = begin; n < end; ++n) {
        group.radius = std::max(group.radius, safe_norm(samples.points[n] - group.middle));
      }
      groups.push_back(group);
    }
  }
  return groups;
}

std::vector<double> DroppedSamples::distances_of(std::span<const Vec3> points, double limit) {
  std::vector<double> distances(points.size());
  if (points.empty()) return distances;
  if (!distance_) distance_.emplace(surface_.mesh);
  distance_->evaluate(points, distances, limit);
  return distances;
}

// Most samples that follow on each other are near each other, and where much is dropped, they are far from the surface
// together.
void DroppedSamples::decide(std::span<Part> parts) {
  constexpr double kWide = 32.0;  // steps: wider groups are hardly ever far
  std::vector<Group> groups = groups_of(parts);
  std::vector<Vec3> points;
  for (const Group& group : groups) points.push_back(group.middle);
  const std::vector<double> of_middles = distances_of(points, kWide * step_ + farthest_);
  points.clear();
  for (std::size_t n = 0; n < groups.size(); ++n) {
    Group& group = groups[n];
    group.is_far = group.radius < kWide * step_ && of_middles[n] > group.radius + farthest_;
    if (group.is_far) continue;
    for (std::size_t i = group.begin; i < group.end; ++i) points.push_back(group.part->samples.points[i]);
  }
  const std::vector<double> distances = distances_of(points, farthest_);
  auto distance = distances.cbegin();
  for (const Group& group : groups) {
    for (std::size_t i = group.begin; i < group.end; ++i) {
      const double most = is_of_lost(group.part->samples.triangles[i]) ? on_surface_ : farthest_;
      group.part->dropped[i] = group.is_far || *distance++ > most;
    }
  }
}

}  // namespace raycone
