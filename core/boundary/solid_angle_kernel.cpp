#include "core/boundary/solid_angle_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>

// Highway compiles what is between its markers once per SIMD level.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/boundary/solid_angle_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/boundary/triangle_lanes-inl.h"
#include "core/machine/simd_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

// Along the one ray that all samples share, for a few triangles at a time.
class TrianglesOfOneRay {
 public:
  static constexpr std::size_t kTriangles = TrianglesOfRays::kTriangles;

  TrianglesOfOneRay(std::span<const SolidTriangle> triangles, const SampleTile& samples) {
    for (std::size_t n = 0; n < triangles.size(); ++n)
      projected_[n] = project(triangles[n], samples.y[0], samples.z[0]);
  }
  [[nodiscard]] ProjectedTriangle<Lanes> projected(std::size_t n, std::size_t) const {
    const ProjectedTriangle<double>& p = projected_[n];
    return {hn::Set(d, p.aa), hn::Set(d, p.bb), hn::Set(d, p.cc),   hn::Set(d, p.ab),
            hn::Set(d, p.bc), hn::Set(d, p.ca), hn::Set(d, p.side), hn::Set(d, p.terms)};
  }

 private:
  static ProjectedTriangle<double> project(const SolidTriangle& t, double qy, double qz) {
    const double ay = t.a.y - qy, az = t.a.z - qz, by = t.b.y - qy, bz = t.b.z - qz, cy = t.c.y - qy, cz = t.c.z - qz;
    const double ny = t.normal.y * ay, nz = t.normal.z * az;
    return {ay * ay + az * az, by * by + bz * bz, cy * cy + cz * cz, ay * by + az * bz,
            by * cy + bz * cz, cy * ay + cz * az, ny + nz,           std::abs(ny) + std::abs(nz)};
  }

  std::array<ProjectedTriangle<double>, kTriangles> projected_;
};

template <class Rays>
void multiply_all(std::span<const SolidTriangle> all, const SampleTile& samples, ProductTile& products) {
  set_ones(products);
  for (std::size_t first = 0; first < all.size(); first += Rays::kTriangles) {
    const auto triangles = all.subspan(first, std::min(Rays::kTriangles, all.size() - first));
    const Rays rays(triangles, samples);
    const auto all_lanes = hn::FirstN(d, hn::Lanes(d));
    for (std::size_t i = 0; i < samples.count; i += hn::Lanes(d)) {
      for (std::size_t begin = 0; begin < triangles.size(); begin += kFactorsPerBlock) {
        const std::size_t end = std::min(begin + kFactorsPerBlock, triangles.size());
        multiply_block(products, TriangleBlock{triangles, begin, end, samples, i}, rays, all_lanes);
      }
    }
  }
  set_arguments(products, samples.count);
}

void multiply_triangles_here(std::span<const SolidTriangle> triangles, const SampleTile& samples,
                             ProductTile& products) {
  if (samples.share_a_ray()) {
    multiply_all<TrianglesOfOneRay>(triangles, samples, products);
  } else {
    multiply_all<TrianglesOfRays>(triangles, samples, products);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raycone {

SolidAngleKernel solid_angle_kernel(SimdLevel level) { return RAYCONE_AT_LEVEL(level, multiply_triangles_here); }

}  // namespace raycone
#endif
