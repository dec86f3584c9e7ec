#include "core/sampling/point_sampler.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/exact/exact_determinant.h"
#include "core/exact/long_vec3.h"
#include "core/exact/scale.h"
#include "core/machine/threads.h"
#include "core/sampling/random.h"

namespace raycone {
namespace {

constexpr std::size_t kPointsPerTask = 4096;

std::uint64_t count_of(const SampleGroup& group) {
  return std::visit([](const auto& one) { return one.count; }, group);
}

// Whether no coordinate has bits below 2^-453, so that products of differences have none below 2^-906.
bool has_no_tiny_bits(const Vec3& p) {
  return std::ranges::all_of(std::array{p.x, p.y, p.z}, [](double x) { return x == 0.0 || std::abs(x) > 0x1p-400; });
}

// Twice the area along each axis, each part rounded to 53 bits or more: with exponents for those of any triangle.
LongVec3 area_vector(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 rounded = rounded_cross_of_differences(b, c, a);
  const double largest = largest_coordinate(rounded);
  if (largest > 0x1p-900 && largest < 0x1p1000) return {rounded.x, rounded.y, rounded.z};
  if (largest == 0.0 && has_no_tiny_bits(a) && has_no_tiny_bits(b) && has_no_tiny_bits(c)) return {0, 0, 0};
  const QuadVec3 v = cross_of_differences(b, c, a);
  return {static_cast<long double>(v.x), static_cast<long double>(v.y), static_cast<long double>(v.z)};
}

long double exact_doubled_area(const Vec3& a, const Vec3& b, const Vec3& c) { return norm(area_vector(a, b, c)); }

// Of a triangle with an area, whatever its shape and size.
Vec3 exact_unit_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  const LongVec3 v = area_vector(a, b, c);
  const long double size = norm(v);
  return {static_cast<double>(v.x / size), static_cast<double>(v.y / size), static_cast<double>(v.z / size)};
}

// Twice the area within 1e-9 of itself, whatever the shape and size; 0 if and only if it is 0.
long double doubled_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  constexpr double kTiny = 0x1p-450, kHuge = 0x1p450;  // the square roots of what squares need not to leave the range
  constexpr double kThinnest = 0x1p-20;  // sine of the angle: the product is off by 8 u of the sides' lengths
  const Vec3 ab = b - a, ac = c - a;
  const double product = norm(cross(ab, ac)), lengths = norm(ab) * norm(ac);
  const bool in_range = norm(ab) > kTiny && norm(ac) > kTiny && product > kTiny && lengths < kHuge;
  return in_range && product > kThinnest * lengths ? product : exact_doubled_area(a, b, c);
}

// In a unit that brings the whole into [1, 2], so that a random number below 1 times the whole is less than it; 0 where
// there is none.
std::vector<double> areas_up_to(const TriangleMesh& mesh) {
  std::vector<long double> sums;  // 64 bits, and exponents for any area
  sums.reserve(mesh.triangles.size());
  long double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    sum += doubled_area(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
    sums.push_back(sum);
  }
  const long double unit = std::scalbn(1.0L, sum > 0 ? -std::ilogb(sum) : 0);
  std::vector<double> areas;
  areas.reserve(sums.size());
  for (const long double s : sums) areas.push_back(static_cast<double>(unit * s));
  return areas;
}

// The step of an area among as many as there are triangles. Monotone.
std::size_t step_of(double area, const std::vector<double>& areas) {
  return static_cast<std::size_t>(area / areas.back() * static_cast<double>(areas.size()));
}

std::vector<std::uint32_t> first_beyond_steps(const std::vector<double>& areas) {
  std::vector<std::uint32_t> first(areas.size() + 1, 0);
  if (areas.empty() || areas.back() <= 0.0) return first;
  std::size_t step = 0;
  for (std::uint32_t n = 0; n < areas.size(); ++n) {
    // All areas of the steps before that of areas[n] are less.
    for (const std::size_t end = std::min(step_of(areas[n], areas), areas.size()); step < end; ++step)
      first[step + 1] = n;
  }
  return first;
}

bool any_needs_area(const std::vector<SampleGroup>& groups) {
  return std::ranges::any_of(groups,
                             [](const SampleGroup& group) { return !std::holds_alternative<UniformSamples>(group); });
}

double diagonal_of(const TriangleMesh& mesh, const Box& box) {
  const int exponent = largest_exponent(mesh);
  const PowerOfTwo to_unit(-exponent), to_world(exponent);
  return to_world(norm(to_unit(box.upper) - to_unit(box.lower)));
}

}  // namespace

PointSampler::PointSampler(const TriangleMesh& mesh, const Box& box, std::vector<SampleGroup> groups,
                           std::uint64_t seed)
    : mesh_(any_needs_area(groups) ? mesh : TriangleMesh()),
      box_(box),
      box_of_mesh_(bounding_box(mesh)),
      diagonal_(diagonal_of(mesh, box_of_mesh_)),
      groups_(std::move(groups)),
      seed_(seed),
      areas_(any_needs_area(groups_) ? areas_up_to(mesh) : std::vector<double>()),
      first_beyond_(first_beyond_steps(areas_)) {
  for (const SampleGroup& group : groups_) size_ += count_of(group);
}

bool PointSampler::is_finite() const {
  return std::ranges::all_of(groups_, [&](const SampleGroup& group) {
    if (std::holds_alternative<SurfaceSamples>(group)) return true;
    const auto* const near = std::get_if<NearSamples>(&group);
    const Box& box = near != nullptr ? box_of_mesh_ : box_;
    const double reach = near != nullptr ? Random::kLargestNormal * noise_of(*near) : 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double lower = box.lower[axis] - reach, upper = box.upper[axis] + reach;
      if (!std::isfinite(lower) || !std::isfinite(upper)) return false;
      if (near == nullptr && !std::isfinite(upper - lower)) return false;
    }
    return true;
  });
}

// In world units. The diagonal of the largest meshes is not a double, which must not matter to points that stay.
double PointSampler::noise_of(const NearSamples& near) const {
  return near.sigma == 0.0 ? 0.0 : near.sigma * diagonal_;
}

PointSampler::Drawn PointSampler::on_surface(Random& random) const {
  const double area = random.uniform() * areas_.back();
  const std::size_t face = triangle_at(area);
  const Triangle& t = mesh_.triangles[face];
  const Vec3 &a = mesh_.vertices[t[0]], &b = mesh_.vertices[t[1]], &c = mesh_.vertices[t[2]];
  const double from_a = std::sqrt(random.uniform()), toward_c = random.uniform();
  Vec3 p = (1 - from_a) * a + (from_a * (1 - toward_c)) * b + (from_a * toward_c) * c;
  // Rounding leads out of the triangle, but not out of its box: faces across an axis hold their points exactly.
  for (int axis = 0; axis < 3; ++axis) {
    const auto [least, most] = std::minmax({a[axis], b[axis], c[axis]});
    p[axis] = std::clamp(p[axis], least, most);
  }
  return {p, static_cast<std::int64_t>(face)};
}

// The first one up to which there is more area. Steps with many triangles take a search.
std::size_t PointSampler::triangle_at(double area) const {
  constexpr std::size_t kFew = 8;
  std::size_t n = first_beyond_[std::min(step_of(area, areas_), areas_.size())];
  for (std::size_t tried = 0; tried < kFew; ++tried, ++n) {
    if (areas_[n] > area) return n;
  }
  const auto begin = areas_.begin() + static_cast<std::ptrdiff_t>(n);
  return static_cast<std::size_t>(std::upper_bound(begin, areas_.end(), area) - areas_.begin());
}

PointSampler::Drawn PointSampler::drawn(std::uint64_t number) const {
  Random random(seed_, number);
  std::size_t group = 0;
  for (; number >= count_of(groups_[group]); ++group) number -= count_of(groups_[group]);
  if (std::holds_alternative<SurfaceSamples>(groups_[group])) return on_surface(random);
  Vec3 p;
  if (const auto* const near = std::get_if<NearSamples>(&groups_[group])) {
    p = on_surface(random).point;
    const double noise = noise_of(*near);
    for (int axis = 0; axis < 3; ++axis) p[axis] += noise * random.normal();
  } else {
    for (int axis = 0; axis < 3; ++axis) {
      const double place = box_.lower[axis] + random.uniform() * (box_.upper[axis] - box_.lower[axis]);
      p[axis] = std::min(place, box_.upper[axis]);  // beyond which rounding may lead
    }
  }
  return {p};
}

void PointSampler::draw(std::uint64_t first, std::span<Vec3> points) const {
  parallel_for_each(points.size(), kPointsPerTask, [&](std::size_t n) { points[n] = drawn(first + n).point; });
}

void PointSampler::draw(std::uint64_t first, std::span<Vec3> points, std::span<std::int64_t> faces) const {
  parallel_for_each(points.size(), kPointsPerTask, [&](std::size_t n) {
    const Drawn one = drawn(first + n);
    points[n] = one.point;
    faces[n] = one.face;
  });
}

void PointSampler::set_normals(std::span<const std::int64_t> faces, std::span<Vec3> normals) const {
  parallel_for_each(faces.size(), kPointsPerTask, [&](std::size_t n) {
    if (faces[n] < 0) {
      normals[n] = {};
      return;
    }
    const Triangle& t = mesh_.triangles[static_cast<std::size_t>(faces[n])];
    normals[n] = exact_unit_normal(mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]]);
  });
}

}  // namespace raycone
