// Factors of triangles in SIMD lanes, one per sample: what kernels share. Included once per SIMD level.
#if defined(RAYCONE_CORE_BOUNDARY_TRIANGLE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYCONE_CORE_BOUNDARY_TRIANGLE_LANES_INL_H_
#undef RAYCONE_CORE_BOUNDARY_TRIANGLE_LANES_INL_H_
#else
#define RAYCONE_CORE_BOUNDARY_TRIANGLE_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "core/boundary/edge_factor.h"
#include "core/boundary/product_lanes-inl.h"
#include "core/boundary/solid_angle_kernel.h"
#include "core/crossings/crossings.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

// Im z_T = n . a. The normal's components, those of a, and their products are each rounded once, the sum twice: 5 u of
// the absolute terms, u = 2^-53, plus what stands for underflow.
constexpr double kPlaneSideFilter = 5.0 * 0x1p-53 * (1.0 + 0x1p-40);
constexpr double kPlaneSideUnderflow = 0x1p-1000;

// Re z_T, four terms of at most |a||b||c|, is off by less than 50 u of that. Next to the triangle, where |z_T| is below
// these shares of |a||b||c| and of the absolute terms of Im z_T, the argument could be off by more than 2^-41; for
// rough factors by more than kRoughness times that.
template <Care kCare>
inline constexpr double kCareless = kCare == Care::kRough ? kRoughness : 1.0;
template <Care kCare>
inline constexpr double kNearTriangle = 0x1p-6 / kCareless<kCare>;
template <Care kCare>
inline constexpr double kNearCorner = 0x1p-8 / kCareless<kCare>;

// What y and z contribute: to |a|^2, |b|^2, |c|^2, to the products of two of them, to n . a, and to its absolute terms.
template <class Real>
struct ProjectedTriangle {
  Real aa, bb, cc, ab, bc, ca, side, terms;
};

// What y and z contribute to a few triangles, of samples with a ray each.
class TrianglesOfRays {
 public:
  static constexpr std::size_t kTriangles = 32;

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
  LaneMask trusted;
};

// a, b, c: norms of the corners; ab, bc, ca: their products.
struct CornerLanes {
  Lanes a, b, c, ab, bc, ca;
};

// im: n . a; terms: the sum of the magnitudes of its three terms.
template <Care kCare>
HWY_INLINE TriangleFactors factors_of(const SolidTriangle& t, const CornerLanes& p, Lanes im, Lanes terms) {
  const Lanes all = hn::Mul(hn::Mul(p.a, p.b), p.c);
  const Lanes re = hn::Add(hn::Add(all, hn::Mul(p.ab, p.c)), hn::Add(hn::Mul(p.bc, p.a), hn::Mul(p.ca, p.b)));
  const Lanes doubt = hn::Add(hn::Mul(hn::Set(d, kPlaneSideFilter), terms), hn::Set(d, kPlaneSideUnderflow));
  const Lanes magnitude = hn::Add(hn::Abs(re), hn::Abs(im));
  const Lanes near =
      hn::Max(hn::Mul(hn::Set(d, kNearTriangle<kCare>), all), hn::Mul(hn::Set(d, kNearCorner<kCare>), terms));
  // Which side of the triangle's plane the query is on matters only where the argument may be near +-pi.
  const auto sided = hn::Or(hn::Gt(hn::Abs(im), doubt), hn::Gt(re, hn::Zero(d)));
  const auto trusted = hn::And(sided, hn::Gt(magnitude, hn::Max(near, hn::Set(d, kSmallestFactor))));
  return {re, hn::Mul(im, hn::Set(d, t.orientation)), trusted};  // not where anything is NaN
}

HWY_INLINE TriangleFactors factors_of(const SolidTriangle& t, const ProjectedTriangle<Lanes>& p, Lanes x) {
  const Lanes ax = hn::Sub(hn::Set(d, t.a.x), x), bx = hn::Sub(hn::Set(d, t.b.x), x);
  const Lanes cx = hn::Sub(hn::Set(d, t.c.x), x);
  const auto norm = [](Lanes v, Lanes square) { return hn::Sqrt(hn::Add(hn::Mul(v, v), square)); };
  const auto product = [](Lanes v, Lanes w, Lanes rest) { return hn::Add(hn::Mul(v, w), rest); };
  const Lanes nx = hn::Mul(hn::Set(d, t.normal.x), ax);
  return factors_of<Care::kFull>(t,
                                 {norm(ax, p.aa), norm(bx, p.bb), norm(cx, p.cc), product(ax, bx, p.ab),
                                  product(bx, cx, p.bc), product(cx, ax, p.ca)},
                                 hn::Add(nx, p.side), hn::Add(hn::Abs(nx), p.terms));
}

// Triangles [begin, end), and the samples from i on whose products are multiplied by their factors.
struct TriangleBlock {
  std::span<const SolidTriangle> triangles;
  std::size_t begin, end;
  const SampleTile& samples;
  std::size_t i;
};

// Of triangle n of the block, which is that of the rays.
template <class Rays>
HWY_INLINE TriangleFactors factors_at(const Rays& rays, const TriangleBlock& block, std::size_t n) {
  return factors_of(block.triangles[n], rays.projected(n, block.i), hn::Load(d, &block.samples.x[block.i]));
}

// Multiplies by the triangle's factor as its crossing of the ray and the factors of its three edges give it, with every
// exactness rule.
void multiply_by_edges(ProductTile& products, std::size_t i, const SolidTriangle& t, const Vec3& q) {
  products.passages[i] += 2 * triangle_crossing(t.a, t.b, t.c, q).sigma * t.orientation;  // a turn is two passages
  for (const auto& [from, to] : {std::pair(&t.a, &t.b), std::pair(&t.b, &t.c), std::pair(&t.c, &t.a)}) {
    const auto f = edge_factor(*from, *to, q, edge_side(*from, *to, q));
    if (f) multiply_one(products, i, f->re, -t.orientation * f->im);
  }
}

// What multiply_block() does, factor by factor, for the samples whose bit in `trusted` is not set. The block is
// passed by value: a reference would force multiply_block() to keep it in memory, not in registers.
template <class Rays>
HWY_NOINLINE void multiply_carefully(ProductTile& products, const TriangleBlock block, Rays& rays,
                                     std::uint64_t trusted) {
  const SampleTile& samples = block.samples;
  for (std::size_t n = block.begin; n < block.end; ++n) {
    const TriangleFactors factors = factors_at(rays, block, n);
    const Lanes magnitude = hn::Add(hn::Abs(factors.re), hn::Abs(factors.im));
    const std::uint64_t plain = bits_of(hn::And(factors.trusted, hn::Lt(magnitude, hn::Set(d, kLargestFactor))));
    alignas(64) std::array<double, 8> re, im;
    hn::Store(factors.re, d, re.data());
    hn::Store(factors.im, d, im.data());
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
      const std::size_t sample = block.i + lane;
      if ((trusted >> lane) & 1U) continue;
      if ((plain >> lane) & 1U) {
        multiply_one(products, sample, re[lane], im[lane]);
      } else {
        multiply_by_edges(products, sample, block.triangles[n], samples.query(sample));
      }
    }
  }
}

// Stores z, the products of those samples that are `active` times the factors of the block: of the lanes that are
// trusted and sound. Multiplies the others factor by factor.
template <class Rays>
HWY_INLINE void finish_block(ProductTile& products, const TriangleBlock& block, Rays& rays, LaneMask active,
                             const ProductLanes& z, LaneMask trusted) {
  trusted = hn::And(trusted, is_sound(z));
  const auto done = hn::Or(trusted, hn::Not(active));
  if (HWY_LIKELY(hn::AllTrue(d, done))) {
    const ProductLanes before = load(products, block.i);
    store(scaled({hn::IfThenElse(active, z.re, before.re), hn::IfThenElse(active, z.im, before.im),
                  hn::IfThenElse(active, z.passages, before.passages)}),
          products, block.i);
  } else {
    multiply_carefully(products, block, rays, bits_of(done));
    store_trusted(z, trusted, products, block.i);
  }
}

// Multiplies the factors of a block onto the products of those of its samples that are `active`. `kCertain`: it is
// known beforehand that all factors are trusted.
template <bool kCertain = false, class Rays>
HWY_INLINE void multiply_block(ProductTile& products, const TriangleBlock& block, Rays& rays, LaneMask active) {
  ProductLanes z = load(products, block.i);
  auto trusted = active;
  for (std::size_t n = block.begin; n < block.end; ++n) {
    const TriangleFactors factors = factors_at(rays, block, n);
    if constexpr (!kCertain) trusted = hn::And(trusted, factors.trusted);
    z = times(z, factors.re, factors.im, hn::CopySignToAbs(hn::Set(d, 1.0), factors.im));
  }
  finish_block(products, block, rays, active, z, trusted);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#endif
