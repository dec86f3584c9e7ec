#include "core/cone_kernel.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "core/edge_factor.h"
#include "core/near_edge.h"
#include "core/predicates.h"

// Highway compiles what is between its markers once per SIMD level.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/cone_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Doubles = hn::CappedTag<double, 8>;
using Lanes = hn::Vec<Doubles>;
constexpr Doubles d;

// |P|^2 outside these bounds may have lost bits to underflow, or overflow in products.
constexpr double kSmallestSquare = 0x1p-800;
constexpr double kLargestSquare = 0x1p800;
// Factors within these bounds can be multiplied kFactorsPerScaling times onto a number near 1.
constexpr double kSmallestFactor = 0x1p-120;
constexpr double kLargestFactor = 0x1p120;
constexpr int kFactorsPerScaling = 8;

// The projections P = y + i z of a vertex, one per sample, or one for all where the samples share a ray.
struct OfEachSample {
  static constexpr bool kShared = false;
  alignas(64) Tile y_, z_;

  void look(const Vec3& v, const SampleTile& samples) {
    for (std::size_t i = 0; i < samples.count; i += hn::Lanes(d)) {
      hn::Store(hn::Sub(hn::Set(d, v.y), hn::Load(d, &samples.y[i])), d, &y_[i]);
      hn::Store(hn::Sub(hn::Set(d, v.z), hn::Load(d, &samples.z[i])), d, &z_[i]);
    }
  }
  [[nodiscard]] Lanes y(std::size_t i) const { return hn::Load(d, &y_[i]); }
  [[nodiscard]] Lanes z(std::size_t i) const { return hn::Load(d, &z_[i]); }
};

struct OfOneRay {
  static constexpr bool kShared = true;
  double y_ = 0.0, z_ = 0.0;

  void look(const Vec3& v, const SampleTile& samples) {
    y_ = v.y - samples.y[0];
    z_ = v.z - samples.z[0];
  }
  [[nodiscard]] Lanes y(std::size_t) const { return hn::Set(d, y_); }
  [[nodiscard]] Lanes z(std::size_t) const { return hn::Set(d, z_); }
};

// Calls body(i, projected(i)) for each group of lanes, from sample i on; where projections are shared, projected() once
// for all.
template <class Projection, class Projected, class Body>
HWY_INLINE void for_lanes(const SampleTile& samples, const Projected& projected, const Body& body) {
  if constexpr (Projection::kShared) {
    const auto of_all = projected(0);
    for (std::size_t i = 0; i < samples.count; i += hn::Lanes(d)) body(i, of_all);
  } else {
    for (std::size_t i = 0; i < samples.count; i += hn::Lanes(d)) body(i, projected(i));
  }
}

// A vertex seen from the samples: P, and s = |p| - p_x, both times t > 0, which does not change the argument of z. For
// p_x > 0, where s = |P|^2 / (|p| + p_x), t is the denominator, which saves the division. s is NaN where |P|^2 is out
// of bounds.
template <class Projection>
struct Corner {
  Vec3 vertex;
  Projection p;
  alignas(64) Tile s;
  alignas(64) Tile t;

  void look(const Vec3& v, const SampleTile& samples) {
    vertex = v;
    p.look(v, samples);
    const auto squared = [&](std::size_t i) { return hn::Add(hn::Mul(p.y(i), p.y(i)), hn::Mul(p.z(i), p.z(i))); };
    for_lanes<Projection>(samples, squared, [&](std::size_t i, Lanes square) {
      const Lanes px = hn::Sub(hn::Set(d, v.x), hn::Load(d, &samples.x[i]));
      const Lanes norm = hn::Sqrt(hn::Add(hn::Mul(px, px), square));
      const Lanes sum = hn::Add(norm, hn::Abs(px));
      const auto ahead = hn::Gt(px, hn::Zero(d));
      const auto ordinary =
          hn::And(hn::Gt(square, hn::Set(d, kSmallestSquare)), hn::Lt(square, hn::Set(d, kLargestSquare)));
      hn::Store(hn::IfThenElse(ordinary, hn::IfThenElse(ahead, square, sum), hn::NaN(d)), d, &s[i]);
      hn::Store(hn::IfThenElse(ahead, sum, hn::Set(d, 1.0)), d, &t[i]);
    });
  }
};

// Where a sign bit is set in `bits`, `value`; else 0.
HWY_INLINE Lanes if_sign_bit(Lanes bits, Lanes value) {
  const hn::RebindToSigned<Doubles> integers;
  return hn::And(hn::BitCast(d, hn::BroadcastSignBit(hn::BitCast(integers, bits))), value);
}

// Multiplies (re, im) onto Z; if both Im had one sign bit and the product's has the other, the argument has passed
// +-pi: rounding can neither create nor lose a turn (docs/method.md).
HWY_INLINE void multiply(ProductTile& z, std::size_t i, Lanes re, Lanes im) {
  const Lanes z_re = hn::Load(d, &z.re[i]), z_im = hn::Load(d, &z.im[i]);
  const Lanes product_re = hn::Sub(hn::Mul(z_re, re), hn::Mul(z_im, im));
  const Lanes product_im = hn::Add(hn::Mul(z_re, im), hn::Mul(z_im, re));
  const Lanes passed = hn::AndNot(hn::Xor(z_im, im), hn::Xor(z_im, product_im));
  const Lanes turn = if_sign_bit(passed, hn::CopySign(hn::Set(d, 1.0), z_im));
  hn::Store(hn::Add(hn::Load(d, &z.turns[i]), turn), d, &z.turns[i]);
  hn::Store(product_re, d, &z.re[i]);
  hn::Store(product_im, d, &z.im[i]);
}

// The same for one sample.
void multiply_one(ProductTile& z, std::size_t i, double re, double im) {
  const double product_re = z.re[i] * re - z.im[i] * im, product_im = z.re[i] * im + z.im[i] * re;
  const bool before = std::signbit(z.im[i]), factor = std::signbit(im), after = std::signbit(product_im);
  if (before == factor && after != before) z.turns[i] += before ? -1.0 : 1.0;
  z.re[i] = product_re;
  z.im[i] = product_im;
}

// Samples [i, i + lanes), of which those whose bit is not set in `trusted` take the careful way.
HWY_NOINLINE void multiply_carefully(ProductTile& z, std::size_t i, std::uint64_t trusted, Lanes re, Lanes im,
                                     const Vec3& a, const Vec3& b, bool reversed, const SampleTile& samples) {
  alignas(64) std::array<double, 8> res, ims;
  hn::Store(re, d, res.data());
  hn::Store(im, d, ims.data());
  for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
    const std::size_t sample = i + lane;
    if ((trusted >> lane) & 1U) {
      multiply_one(z, sample, res[lane], ims[lane]);
    } else if (const auto f = edge_factor(a, b, reversed, {samples.x[sample], samples.y[sample], samples.z[sample]})) {
      multiply_one(z, sample, f->re, f->im);
    }
  }
}

// What the projections of an edge say: P_a . P_b, and D times the orientation, whose sign is sure or not.
struct ProjectedEdge {
  Lanes re, im;
  hn::Mask<Doubles> side_is_sure;
};

// The edge determinant as in predicates.h: from the nearer end, and trusted beyond its error.
HWY_INLINE ProjectedEdge project(Lanes ay, Lanes az, Lanes by, Lanes bz, Lanes dy, Lanes dz, Lanes orientation) {
  const auto a_is_nearer = hn::Le(hn::Add(hn::Abs(ay), hn::Abs(az)), hn::Add(hn::Abs(by), hn::Abs(bz)));
  const Lanes left = hn::Mul(hn::IfThenElse(a_is_nearer, ay, by), dz);
  const Lanes right = hn::Mul(hn::IfThenElse(a_is_nearer, az, bz), dy);
  const Lanes determinant = hn::Sub(left, right);
  const Lanes doubt =
      hn::Add(hn::Mul(hn::Set(d, kSideFilter), hn::Add(hn::Abs(left), hn::Abs(right))), hn::Set(d, kSideUnderflow));
  return {hn::Add(hn::Mul(ay, by), hn::Mul(az, bz)), hn::Mul(determinant, orientation),
          hn::Gt(hn::Abs(determinant), doubt)};
}

template <class Projection>
void multiply_edge(ProductTile& product, const Corner<Projection>& a, const Corner<Projection>& b, bool reversed,
                   const SampleTile& samples) {
  const auto projected = [&](std::size_t i) {
    return project(a.p.y(i), a.p.z(i), b.p.y(i), b.p.z(i), hn::Set(d, b.vertex.y - a.vertex.y),
                   hn::Set(d, b.vertex.z - a.vertex.z), hn::Set(d, reversed ? -1.0 : 1.0));
  };
  for_lanes<Projection>(samples, projected, [&](std::size_t i, const ProjectedEdge& edge) {
    const Lanes product_of_s = hn::Mul(hn::Load(d, &a.s[i]), hn::Load(d, &b.s[i]));
    const Lanes product_of_t = hn::Mul(hn::Load(d, &a.t[i]), hn::Load(d, &b.t[i]));
    const Lanes re = hn::Add(product_of_s, hn::Mul(product_of_t, edge.re));
    const Lanes im = hn::Mul(product_of_t, edge.im);
    const Lanes magnitude = hn::Add(hn::Abs(re), hn::Abs(im));
    const auto not_near = hn::Gt(magnitude, hn::Mul(hn::Set(d, kNearEdge), product_of_s));
    const auto in_range =
        hn::And(hn::Gt(magnitude, hn::Set(d, kSmallestFactor)), hn::Lt(magnitude, hn::Set(d, kLargestFactor)));
    const auto trusted = hn::And(edge.side_is_sure, hn::And(not_near, in_range));  // false for NaN
    if (HWY_LIKELY(hn::AllTrue(d, trusted))) {
      multiply(product, i, re, im);
    } else {
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(d, trusted, bits);
      multiply_carefully(product, i, bits[0], re, im, a.vertex, b.vertex, reversed, samples);
    }
  });
}

// Takes the power of two out of the products, which is exact.
void scale(ProductTile& z, std::size_t count) {
  const hn::RebindToUnsigned<Doubles> bits;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const Lanes re = hn::Load(d, &z.re[i]), im = hn::Load(d, &z.im[i]);
    const auto magnitude = hn::BitCast(bits, hn::Max(hn::Abs(re), hn::Abs(im)));
    const auto exponent = hn::And(magnitude, hn::Set(bits, 0x7FF0000000000000U));
    const Lanes inverse = hn::BitCast(d, hn::Sub(hn::Set(bits, std::uint64_t{2046} << 52), exponent));
    hn::Store(hn::Mul(re, inverse), d, &z.re[i]);
    hn::Store(hn::Mul(im, inverse), d, &z.im[i]);
  }
}

template <class Projection>
void multiply_all(std::span<const ChainStep> steps, const SampleTile& samples, ProductTile& products) {
  products.re.fill(1.0);
  products.im.fill(0.0);
  products.turns.fill(0.0);
  std::array<Corner<Projection>, 2> corners;  // of the edge at hand, in turns
  std::size_t here = 0;
  int factors = 0;
  for (const ChainStep& step : steps) {
    here = 1 - here;
    corners[here].look(step.to, samples);
    if (!step.joined) continue;
    multiply_edge(products, corners[1 - here], corners[here], step.reversed, samples);
    if (++factors % kFactorsPerScaling == 0) scale(products, samples.count);
  }
}

void multiply_chains_here(std::span<const ChainStep> steps, const SampleTile& samples, ProductTile& products) {
  if (samples.share_a_ray()) {
    multiply_all<OfOneRay>(steps, samples, products);
  } else {
    multiply_all<OfEachSample>(steps, samples, products);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raycone {
namespace {

using Kernel = std::remove_pointer_t<ConeKernel>;

// Null where the processor or the compiler lacks the level. Highway would choose it too, but its library, where it is
// linked, measures the clock whenever the program starts, for as long as all the rest of a small run takes.
Kernel* kernel_of([[maybe_unused]] SimdLevel level) {
#if HWY_ARCH_X86
  const bool sse4 =
      __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("pclmul") && __builtin_cpu_supports("aes");
  const bool avx2 = sse4 && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                    __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
  const bool avx512 = avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
  if (level == SimdLevel::kAvx512) return avx512 ? HWY_CHOOSE_AVX3(multiply_chains_here) : nullptr;
  if (level == SimdLevel::kAvx2) return avx2 ? HWY_CHOOSE_AVX2(multiply_chains_here) : nullptr;
  if (level == SimdLevel::kSse4) return sse4 ? HWY_CHOOSE_SSE4(multiply_chains_here) : nullptr;
#endif
  return nullptr;
}

Kernel* best_kernel() {
  for (const SimdLevel level : {SimdLevel::kAvx512, SimdLevel::kAvx2, SimdLevel::kSse4}) {
    if (Kernel* const kernel = kernel_of(level)) return kernel;
  }
  return &HWY_STATIC_DISPATCH(multiply_chains_here);
}

}  // namespace

void SampleTile::add(const Vec3& q) {
  x[count] = q.x;
  y[count] = q.y;
  z[count] = q.z;
  ++count;
}

void SampleTile::fill_up() {
  for (std::size_t i = count; i % 8 != 0; ++i) {
    x[i] = x[count - 1];
    y[i] = y[count - 1];
    z[i] = z[count - 1];
  }
}

bool SampleTile::share_a_ray() const {
  return std::all_of(y.begin(), y.begin() + count, [&](double value) { return value == y[0]; }) &&
         std::all_of(z.begin(), z.begin() + count, [&](double value) { return value == z[0]; });
}

bool is_available(SimdLevel level) { return level == SimdLevel::kBest || kernel_of(level) != nullptr; }

ConeKernel cone_kernel(SimdLevel level) {
  return level == SimdLevel::kBest || !kernel_of(level) ? best_kernel() : kernel_of(level);
}

}  // namespace raycone
#endif
