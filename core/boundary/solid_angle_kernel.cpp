#include "core/boundary/solid_angle_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/boundary/edge_factor.h"
#include "core/crossings/crossings.h"

// Highway compiles what is between its markers once per SIMD level.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/boundary/solid_angle_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/boundary/product_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

// Im z_T = n . a. The normal's components, those of a, and their products are each rounded once, the sum twice: 5 u of
// the absolute terms, u = 2^-53, plus what stands for underflow.
constexpr double kPlaneSideFilter = 5.0 * 0x1p-53 * (1.0 + 0x1p-40);
constexpr double kPlaneSideUnderflow = 0x1p-1000;

// Re z_T, four terms of at most |a||b||c|, is off by less than 50 u of that. Next to the triangle, where |z_T| is below
// these shares of |a||b||c| and of the absolute terms of Im z_T, the argument could be off by more than 2^-41.
constexpr double kNearTriangle = 0x1p-6;
constexpr double kNearCorner = 0x1p-8;

// What y and z contribute: to |a|^2, |b|^2, |c|^2, to the products of two of them, to n . a, and to its absolute terms.
template <class Real>
struct ProjectedTriangle {
  Real aa, bb, cc, ab, bc, ca, side, terms;
};

// Along the one ray that all samples share, for a few triangles at a time.
class TrianglesOfOneRay {
 public:
  static constexpr std::size_t kTriangles = 32;

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

// The same for samples with a ray each.
class TrianglesOfRays {
 public:
  static constexpr std::size_t kTriangles = TrianglesOfOneRay::kTriangles;

  TrianglesOfRays(std::span<const SolidTriangle> triangles, const SampleTile& samples)
      : triangles_(triangles), samples_(samples) {}
  [[nodiscard]] ProjectedTriangle<Lanes> projected(std::size_t n, std::size_t i) const {
    const SolidTriangle& t = triangles_[n];
    const Lanes qy = hn::Load(d, &samples_.y[i]), qz = hn::Load(d, &samples_.z[i]);
    const auto from = [](double v, Lanes q) { return hn::Sub(hn::Set(d, v), q); };
    const Lanes ay = from(t.a.y, qy), az = from(t.a.z, qz);
    const Lanes by = from(t.b.y, qy), bz = from(t.b.z, qz);
    const Lanes cy = from(t.c.y, qy), cz = from(t.c.z, qz);
    const Lanes ny = hn::Mul(hn::Set(d, t.normal.y), ay), nz = hn::Mul(hn::Set(d, t.normal.z), az);
    const auto dot = [](Lanes y, Lanes z, Lanes v, Lanes w) { return hn::Add(hn::Mul(y, v), hn::Mul(z, w)); };
    return {dot(ay, az, ay, az), dot(by, bz, by, bz), dot(cy, cz, cy, cz), dot(ay, az, by, bz),
            dot(by, bz, cy, cz), dot(cy, cz, ay, az), hn::Add(ny, nz),     hn::Add(hn::Abs(ny), hn::Abs(nz))};
  }

 private:
  std::span<const SolidTriangle> triangles_;
  const SampleTile& samples_;
};

// Lanes of z_T = |a||b||c| + (a . b)|c| + (b . c)|a| + (c . a)|b| + i n . a.
struct TriangleFactors {
  Lanes re, im;
  hn::Mask<Doubles> trusted;
};

HWY_INLINE TriangleFactors factors_of(const SolidTriangle& t, const ProjectedTriangle<Lanes>& p, Lanes x) {
  const Lanes ax = hn::Sub(hn::Set(d, t.a.x), x), bx = hn::Sub(hn::Set(d, t.b.x), x);
  const Lanes cx = hn::Sub(hn::Set(d, t.c.x), x);
  const auto norm = [](Lanes v, Lanes square) { return hn::Sqrt(hn::Add(hn::Mul(v, v), square)); };
  const Lanes a = norm(ax, p.aa), b = norm(bx, p.bb), c = norm(cx, p.cc);
  const auto product = [](Lanes v, Lanes w, Lanes rest, Lanes norm_of_third) {
    return hn::Mul(hn::Add(hn::Mul(v, w), rest), norm_of_third);
  };
  const Lanes all = hn::Mul(hn::Mul(a, b), c);
  const Lanes re =
      hn::Add(hn::Add(all, product(ax, bx, p.ab, c)), hn::Add(product(bx, cx, p.bc, a), product(cx, ax, p.ca, b)));
  const Lanes nx = hn::Mul(hn::Set(d, t.normal.x), ax);
  const Lanes im = hn::Add(nx, p.side), terms = hn::Add(hn::Abs(nx), p.terms);
  const Lanes doubt = hn::Add(hn::Mul(hn::Set(d, kPlaneSideFilter), terms), hn::Set(d, kPlaneSideUnderflow));
  const Lanes magnitude = hn::Add(hn::Abs(re), hn::Abs(im));
  const Lanes near = hn::Max(hn::Mul(hn::Set(d, kNearTriangle), all), hn::Mul(hn::Set(d, kNearCorner), terms));
  const auto trusted =
      hn::And(hn::Gt(hn::Abs(im), doubt), hn::Gt(magnitude, hn::Max(near, hn::Set(d, kSmallestFactor))));
  return {re, hn::Mul(im, hn::Set(d, t.orientation)), trusted};  // not where anything is NaN
}

// Multiplies by the triangle's factor as its crossing of the ray and the factors of its three edges give it, with every
// exactness rule.
void multiply_by_edges(ProductTile& products, std::size_t i, const SolidTriangle& t, const Vec3& q) {
  const TriangleCrossing crossing = triangle_crossing(t.a, t.b, t.c, {q.y, q.z, {&q.x, 1}}, nullptr);
  if (crossing.crossed > 0) products.passages[i] += 2 * crossing.sigma * t.orientation;  // a turn is two passages
  for (const auto& [from, to] : {std::pair(&t.a, &t.b), std::pair(&t.b, &t.c), std::pair(&t.c, &t.a)}) {
    const auto f = edge_factor(*from, *to, t.orientation < 0.0, q, edge_side(*from, *to, q));
    if (f) multiply_one(products, i, f->re, -f->im);
  }
}

// What multiply_block() does, factor by factor, for those of the samples from i on whose bit in `trusted` is not set.
template <class Rays>
HWY_NOINLINE void multiply_carefully(ProductTile& products, std::span<const SolidTriangle> triangles, const Rays& rays,
                                     const SampleTile& samples, std::size_t i, std::size_t begin, std::size_t end,
                                     std::uint64_t trusted) {
  for (std::size_t n = begin; n < end; ++n) {
    const TriangleFactors factors = factors_of(triangles[n], rays.projected(n, i), hn::Load(d, &samples.x[i]));
    const Lanes magnitude = hn::Add(hn::Abs(factors.re), hn::Abs(factors.im));
    const std::uint64_t plain = bits_of(hn::And(factors.trusted, hn::Lt(magnitude, hn::Set(d, kLargestFactor))));
    alignas(64) std::array<double, 8> re, im;
    hn::Store(factors.re, d, re.data());
    hn::Store(factors.im, d, im.data());
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
      const std::size_t sample = i + lane;
      if ((trusted >> lane) & 1U) continue;
      if ((plain >> lane) & 1U) {
        multiply_one(products, sample, re[lane], im[lane]);
      } else {
        multiply_by_edges(products, sample, triangles[n], {samples.x[sample], samples.y[sample], samples.z[sample]});
      }
    }
  }
}

// Multiplies the factors of triangles [begin, end) onto the products of the samples from i on.
template <class Rays>
HWY_INLINE void multiply_block(ProductTile& products, std::span<const SolidTriangle> triangles, const Rays& rays,
                               const SampleTile& samples, std::size_t i, std::size_t begin, std::size_t end) {
  const Lanes x = hn::Load(d, &samples.x[i]);
  ProductLanes z = load(products, i);
  auto trusted = hn::Eq(z.re, z.re);  // all
  for (std::size_t n = begin; n < end; ++n) {
    const TriangleFactors factors = factors_of(triangles[n], rays.projected(n, i), x);
    trusted = hn::And(trusted, factors.trusted);
    z = times(z, factors.re, factors.im, hn::CopySignToAbs(hn::Set(d, 1.0), factors.im));
  }
  trusted = hn::And(trusted, is_sound(z));
  if (HWY_LIKELY(hn::AllTrue(d, trusted))) {
    store(scaled(z), products, i);
  } else {
    multiply_carefully(products, triangles, rays, samples, i, begin, end, bits_of(trusted));
    store_trusted(z, trusted, products, i);
  }
}

template <class Rays>
void multiply_all(std::span<const SolidTriangle> all, const SampleTile& samples, ProductTile& products) {
  set_ones(products);
  for (std::size_t first = 0; first < all.size(); first += Rays::kTriangles) {
    const auto triangles = all.subspan(first, std::min(Rays::kTriangles, all.size() - first));
    const Rays rays(triangles, samples);
    for (std::size_t i = 0; i < samples.count; i += hn::Lanes(d)) {
      for (std::size_t begin = 0; begin < triangles.size(); begin += kFactorsPerBlock) {
        multiply_block(products, triangles, rays, samples, i, begin,
                       std::min(begin + kFactorsPerBlock, triangles.size()));
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

SolidAngleKernel solid_angle_kernel([[maybe_unused]] SimdLevel level) {
#if HWY_ARCH_X86
  const SimdLevel available = available_level(level);
  if (available == SimdLevel::kAvx512) return HWY_CHOOSE_AVX3(multiply_triangles_here);
  if (available == SimdLevel::kAvx2) return HWY_CHOOSE_AVX2(multiply_triangles_here);
  if (available == SimdLevel::kSse4) return HWY_CHOOSE_SSE4(multiply_triangles_here);
#endif
  return &HWY_STATIC_DISPATCH(multiply_triangles_here);
}

}  // namespace raycone
#endif
