#include "core/far/far_field.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/boundary/caps.h"
#include "core/boundary/solid_angles.h"
#include "core/crossings/crossings.h"

namespace raycone {

// What a sample costs hardly grows with the number of sources, but with that of digits: of caps, which are a surface,
// in proportion, of soups, which may fill space, with its square. Fitted to measurements of five meshes and soups.
bool far_field_pays(FarSources sources, std::size_t triangles, std::size_t exterior_edges, double samples,
                    double tolerance) {
  // Samples per source. At 50^3 samples, a mesh of 10 556 edges would lose a quarter; at 80^3 it wins one.
  constexpr double kPreparation = 80000;
  const double digits = std::max(2.0, -std::log10(tolerance));
  const bool soup = sources == FarSources::kTriangles;
  const double least = soup ? 120 * digits * digits : 400 * digits;
  const auto count = static_cast<double>(soup ? triangles : exterior_edges);
  return samples * (count - least) > kPreparation * count;
}

FarField::FarField(const TriangleMesh& mesh, const Boundary& boundary, FarSources sources, double tolerance,
                   SimdLevel level)
    : boundary_(boundary), sources_(sources), kernel_(far_kernel(level)) {
  if (sources == FarSources::kCaps) {
    caps_ = all_caps(boundary);
    if (!caps_.triangles.empty()) cap_grid_.emplace(caps_);
  }
  SolidFaces faces = solid_faces(sources == FarSources::kCaps ? caps_ : mesh);
  faces_repeat_ = faces.has_repeated_faces;
  doubt_ =
      std::min(tolerance + doubt_of_factors(3 * static_cast<double>(faces.triangles.size())), Boundary::kMostDoubt);
  tree_.emplace(std::move(faces.triangles), tolerance);
}

std::int64_t FarField::cap_crossings(const Vec3& q) const {
  if (!cap_grid_) return 0;
  std::int64_t doubtful = 0;
  const int sure = cap_grid_->crossings(q, [&](std::uint32_t triangle) {
    const Triangle& t = caps_.triangles[triangle];
    const Vec3 &a = caps_.vertices[t[0]], &b = caps_.vertices[t[1]], &c = caps_.vertices[t[2]];
    const TriangleCrossing crossing = triangle_crossing(a, b, c, {q.y, q.z, {&q.x, 1}}, nullptr);
    if (crossing.crossed > 0) doubtful += crossing.sigma;
  });
  return sure + doubtful;
}

void FarField::winding_numbers(SampleTile& samples, std::span<const std::int64_t> crossings,
                               std::span<double> w) const {
  samples.fill_up();
  FarTile result;
  kernel_.sum(*tree_, samples, result);
  for (std::size_t i = 0; i < samples.count; ++i) {
    std::int64_t whole = result.near.turns(i);
    if (sources_ == FarSources::kCaps) whole += crossings[i] - cap_crossings(samples.query(i));
    w[i] = static_cast<double>(whole) + (result.near.argument[i] + result.far[i]);
  }
  near_terms_.fetch_add(result.near_terms, std::memory_order_relaxed);
  far_terms_.fetch_add(result.far_terms, std::memory_order_relaxed);
}

}  // namespace raycone
