#include "core/point_sampler.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/random.h"
#include "core/scale.h"
#include "core/threads.h"

namespace raycone {
namespace {

constexpr std::size_t kPointsPerTask = 4096;

std::uint64_t count_of(const SampleGroup& group) {
  return std::visit([](const auto& one) { return one.count; }, group);
}

double length(const Vec3& v) { return std::sqrt(dot(v, v)); }

// In units of 4^exponent, with the exponent of the largest coordinate: they do not overflow.
std::vector<double> areas_up_to(const TriangleMesh& mesh) {
  const PowerOfTwo to_unit(-largest_exponent(mesh));
  std::vector<double> areas;
  areas.reserve(mesh.triangles.size());
  double sum = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = to_unit(mesh.vertices[t[0]]);
    sum += 0.5 * length(cross(to_unit(mesh.vertices[t[1]]) - a, to_unit(mesh.vertices[t[2]]) - a));
    areas.push_back(sum);
  }
  return areas;
}

double diagonal_of(const TriangleMesh& mesh) {
  const int exponent = largest_exponent(mesh);
  const PowerOfTwo to_unit(-exponent), to_world(exponent);
  const Box box = bounding_box(mesh);
  return to_world(length(to_unit(box.upper) - to_unit(box.lower)));
}

}  // namespace

PointSampler::PointSampler(const TriangleMesh& mesh, const Box& box, std::vector<SampleGroup> groups,
                           std::uint64_t seed)
    : mesh_(mesh),
      box_(box),
      diagonal_(diagonal_of(mesh)),
      groups_(std::move(groups)),
      seed_(seed),
      areas_(areas_up_to(mesh)) {
  for (const SampleGroup& group : groups_) size_ += count_of(group);
}

Vec3 PointSampler::on_surface(Random& random) const {
  const double area = random.uniform() * areas_.back();
  const auto found = std::upper_bound(areas_.begin(), areas_.end(), area);
  const Triangle& t = mesh_.triangles[static_cast<std::size_t>(found - areas_.begin())];
  const double from_a = std::sqrt(random.uniform()), toward_c = random.uniform();
  return (1 - from_a) * mesh_.vertices[t[0]] + (from_a * (1 - toward_c)) * mesh_.vertices[t[1]] +
         (from_a * toward_c) * mesh_.vertices[t[2]];
}

Vec3 PointSampler::point(std::uint64_t number) const {
  Random random(seed_, number);
  std::size_t group = 0;
  for (; number >= count_of(groups_[group]); ++group) number -= count_of(groups_[group]);
  Vec3 p;
  if (const auto* const near = std::get_if<NearSamples>(&groups_[group])) {
    p = on_surface(random);
    for (int axis = 0; axis < 3; ++axis) p[axis] += near->sigma * diagonal_ * random.normal();
  } else {
    for (int axis = 0; axis < 3; ++axis) {
      p[axis] = box_.lower[axis] + random.uniform() * (box_.upper[axis] - box_.lower[axis]);
    }
  }
  return p;
}

void PointSampler::draw(std::uint64_t first, std::span<Vec3> points) const {
  parallel_for(points.size(), kPointsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) points[n] = point(first + n);
  });
}

}  // namespace raycone
