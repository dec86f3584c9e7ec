#include "core/cone_kernel.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "core/angle.h"
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

constexpr std::size_t kEdgesPerBlock = 8;  // multiplied before anybody looks whether all went well
// An edge is taken with care where |P|^2 of an end is beyond these bounds. Within them s_a s_b is at least 2^-100, so a
// factor that is not near its edge is above 2^-108, and the product of a block cannot underflow.
constexpr double kSmallestSquare = 0x1p-50;
constexpr double kLargestSquare = 0x1p800;
// Factors within these bounds can be multiplied kEdgesPerBlock times onto a number near 1.
constexpr double kSmallestFactor = 0x1p-120;
constexpr double kLargestFactor = 0x1p120;
constexpr double kLargestProduct = 0x1p1000;

// The products of some samples while they are in registers. Where Im Z changes its sign bit, the argument has passed 0
// or +-pi; `passages` counts +1 for factors with Im >= 0 and -1 for the others. Together with the sign of Im Z that
// gives the turns: see set_turns().
struct Product {
  Lanes re, im, passages;
};

// |P|^2, NaN where it is too small or large.
HWY_INLINE Lanes square_of(Lanes y, Lanes z) {
  const Lanes square = hn::Add(hn::Mul(y, y), hn::Mul(z, z));
  const auto ordinary =
      hn::And(hn::Gt(square, hn::Set(d, kSmallestSquare)), hn::Lt(square, hn::Set(d, kLargestSquare)));
  return hn::IfThenElse(ordinary, square, hn::NaN(d));
}

// What the projections along the rays say about an edge: P_a . P_b, and D times the orientation, NaN where the sign of
// D is in doubt; and that sign as +-1, the direction in which the factor turns.
struct ProjectedEdge {
  Lanes re, im, direction;
};

// The projection of a vertex.
struct Projected {
  Lanes y, z;
  Lanes square;  // square_of(y, z)
};

// The edge determinant as in predicates.h: from the nearer end, and trusted beyond its error. (dy, dz) is the edge.
HWY_INLINE ProjectedEdge project(const Projected& a, const Projected& b, Lanes dy, Lanes dz, Lanes orientation) {
  const auto a_is_nearer = hn::Le(a.square, b.square);
  const Lanes left = hn::Mul(hn::IfThenElse(a_is_nearer, a.y, b.y), dz);
  const Lanes right = hn::Mul(hn::IfThenElse(a_is_nearer, a.z, b.z), dy);
  const Lanes determinant = hn::Sub(left, right);
  const Lanes doubt =
      hn::Add(hn::Mul(hn::Set(d, kSideFilter), hn::Add(hn::Abs(left), hn::Abs(right))), hn::Set(d, kSideUnderflow));
  const auto sure = hn::Gt(hn::Abs(determinant), doubt);
  const Lanes im = hn::Mul(determinant, orientation);
  return {hn::Add(hn::Mul(a.y, b.y), hn::Mul(a.z, b.z)), hn::IfThenElse(sure, im, hn::NaN(d)),
          hn::CopySignToAbs(hn::Set(d, 1.0), im)};
}

// Steps that are taken together, sample by sample: edge n leads from vertex n to vertex n + 1. What is kept of them for
// a few samples fits the first-level cache.
constexpr std::size_t kEdgesPerChunk = 64;
using Column = std::array<double, kEdgesPerChunk + 8>;  // room for one vertex more, and for lanes beyond the last one

struct Chunk {
  Column x, y, z;
  Column dy, dz;       // of edges
  Column orientation;  // of edges: +1, -1 if reversed, 0 where there is none
  std::size_t edges;

  Chunk(const Vec3& from, std::span<const ChainStep> steps)
      : x{}, y{}, z{}, dy{}, dz{}, orientation{}, edges(steps.size()) {
    set_vertex(0, from);
    for (std::size_t n = 0; n < edges; ++n) {
      set_vertex(n + 1, steps[n].to);
      dy[n] = y[n + 1] - y[n];
      dz[n] = z[n + 1] - z[n];
      if (steps[n].joined) orientation[n] = steps[n].reversed ? -1.0 : 1.0;
    }
  }
  void set_vertex(std::size_t n, const Vec3& v) {
    x[n] = v.x;
    y[n] = v.y;
    z[n] = v.z;
  }
  [[nodiscard]] Vec3 vertex(std::size_t n) const { return {x[n], y[n], z[n]}; }
};

EdgeSide side_of(const Chunk& chunk, std::size_t n, const Vec3& q) {
  return edge_side(chunk.vertex(n), chunk.vertex(n + 1), q);
}

// One value per vertex of a chunk and lane.
using LaneColumn = std::array<double, (kEdgesPerChunk + 1) * 8>;
HWY_INLINE void store(Lanes value, LaneColumn& column, std::size_t n) {
  hn::Store(value, d, &column[n * hn::Lanes(d)]);
}
HWY_INLINE Lanes load(const LaneColumn& column, std::size_t n) { return hn::Load(d, &column[n * hn::Lanes(d)]); }

// The projections of a chunk along the one ray that all samples share: the lanes can be vertices and edges.
class OneRay {
 public:
  OneRay(const Chunk& chunk, const SampleTile& samples) : chunk_(chunk), y_{}, z_{}, square_{} {
    for (std::size_t n = 0; n <= chunk.edges; n += hn::Lanes(d)) {
      const Lanes y = hn::Sub(hn::LoadU(d, &chunk.y[n]), hn::Set(d, samples.y[0]));
      const Lanes z = hn::Sub(hn::LoadU(d, &chunk.z[n]), hn::Set(d, samples.z[0]));
      hn::StoreU(y, d, &y_[n]);
      hn::StoreU(z, d, &z_[n]);
      hn::StoreU(square_of(y, z), d, &square_[n]);
    }
    for (std::size_t n = 0; n < chunk.edges; n += hn::Lanes(d)) {
      const ProjectedEdge edge = project(projected(n), projected(n + 1), hn::LoadU(d, &chunk.dy[n]),
                                         hn::LoadU(d, &chunk.dz[n]), hn::LoadU(d, &chunk.orientation[n]));
      hn::StoreU(edge.re, d, &re_[n]);
      hn::StoreU(edge.im, d, &im_[n]);
      hn::StoreU(edge.direction, d, &direction_[n]);
    }
    for (std::size_t n = 0; n < chunk.edges; ++n) {
      if (chunk.orientation[n] != 0.0 && std::isnan(im_[n]))
        sides_[n] = side_of(chunk, n, {samples.x[0], samples.y[0], samples.z[0]});
    }
  }

  // What a group of samples has seen of the vertices, beyond what all see.
  struct Seen {};
  // |P|^2 of vertex n for the samples from i on.
  [[nodiscard]] Lanes look(std::size_t n, std::size_t, Seen&) const { return hn::Set(d, square_[n]); }
  // Edge n for the samples that have seen its ends.
  [[nodiscard]] ProjectedEdge edge(std::size_t n, const Seen&) const {
    return {hn::Set(d, re_[n]), hn::Set(d, im_[n]), hn::Set(d, direction_[n])};
  }
  // That of edge n, exact.
  [[nodiscard]] EdgeSide side(std::size_t n, const Vec3& q) const {
    return std::isnan(im_[n]) ? sides_[n] : side_of(chunk_, n, q);
  }

 private:
  [[nodiscard]] Projected projected(std::size_t n) const {
    return {hn::LoadU(d, &y_[n]), hn::LoadU(d, &z_[n]), hn::LoadU(d, &square_[n])};
  }

  const Chunk& chunk_;
  Column y_, z_, square_;
  Column re_, im_, direction_;
  std::array<EdgeSide, kEdgesPerChunk> sides_;  // where Im z is NaN
};

// The same for samples with a ray each.
class RayOfEach {
 public:
  RayOfEach(const Chunk& chunk, const SampleTile& samples) : chunk_(chunk), samples_(samples) {}

  struct Seen {
    alignas(64) LaneColumn y, z, square;
    [[nodiscard]] Projected vertex(std::size_t n) const { return {load(y, n), load(z, n), load(square, n)}; }
  };
  [[nodiscard]] Lanes look(std::size_t n, std::size_t i, Seen& seen) const {
    const Lanes y = hn::Sub(hn::Set(d, chunk_.y[n]), hn::Load(d, &samples_.y[i]));
    const Lanes z = hn::Sub(hn::Set(d, chunk_.z[n]), hn::Load(d, &samples_.z[i]));
    const Lanes square = square_of(y, z);
    store(y, seen.y, n);
    store(z, seen.z, n);
    store(square, seen.square, n);
    return square;
  }
  [[nodiscard]] ProjectedEdge edge(std::size_t n, const Seen& seen) const {
    return project(seen.vertex(n), seen.vertex(n + 1), hn::Set(d, chunk_.dy[n]), hn::Set(d, chunk_.dz[n]),
                   hn::Set(d, chunk_.orientation[n]));
  }
  [[nodiscard]] EdgeSide side(std::size_t n, const Vec3& q) const { return side_of(chunk_, n, q); }

 private:
  const Chunk& chunk_;
  const SampleTile& samples_;
};

// The vertices of a chunk seen from a group of samples: s = |p| - p_x as fractions s / t, t > 0. For p_x > 0, where
// s = |P|^2 / (|p| + p_x), that saves the division. NaN where |P|^2 is.
template <class Rays>
struct Corners {
  alignas(64) LaneColumn s, t;
  typename Rays::Seen seen;

  // Vertex n from the samples from i on.
  void look(const Chunk& chunk, const Rays& rays, const SampleTile& samples, std::size_t n, std::size_t i) {
    const Lanes square = rays.look(n, i, seen);
    const Lanes px = hn::Sub(hn::Set(d, chunk.x[n]), hn::Load(d, &samples.x[i]));
    const Lanes sum = hn::Add(hn::Sqrt(hn::Add(hn::Mul(px, px), square)), hn::Abs(px));
    store(hn::IfNegativeThenElse(px, sum, square), s, n);
    store(hn::IfNegativeThenElse(px, hn::Set(d, 1.0), sum), t, n);
  }
};

// The factor z_ab t_a t_b of an edge, whose argument is that of z_ab.
struct Factor {
  Lanes re, im;
  Lanes direction;  // the sign of im as +-1
  Lanes product_of_s;
};

template <class Rays>
HWY_INLINE Factor factor_of(const Rays& rays, const Corners<Rays>& corners, std::size_t n) {
  const ProjectedEdge edge = rays.edge(n, corners.seen);
  const Lanes product_of_s = hn::Mul(load(corners.s, n), load(corners.s, n + 1));
  const Lanes product_of_t = hn::Mul(load(corners.t, n), load(corners.t, n + 1));
  return {hn::Add(product_of_s, hn::Mul(product_of_t, edge.re)), hn::Mul(product_of_t, edge.im), edge.direction,
          product_of_s};
}

HWY_INLINE Lanes magnitude(const Factor& f) { return hn::Add(hn::Abs(f.re), hn::Abs(f.im)); }

// Not near the edge; false where anything is NaN.
HWY_INLINE hn::Mask<Doubles> is_not_near(const Factor& f) {
  return hn::Gt(magnitude(f), hn::Mul(hn::Set(d, kNearEdge), f.product_of_s));
}

HWY_INLINE Product times(const Product& z, const Factor& f) {
  const Lanes re = hn::Sub(hn::Mul(z.re, f.re), hn::Mul(z.im, f.im));
  const Lanes im = hn::Add(hn::Mul(z.re, f.im), hn::Mul(z.im, f.re));
  return {re, im, hn::Add(z.passages, hn::IfNegativeThenElse(hn::Xor(z.im, im), f.direction, hn::Zero(d)))};
}

// Without the power of two, which is exact.
HWY_INLINE Product scaled(const Product& z) {
  const hn::RebindToUnsigned<Doubles> bits;
  const auto largest = hn::BitCast(bits, hn::Max(hn::Abs(z.re), hn::Abs(z.im)));
  const auto exponent = hn::And(largest, hn::Set(bits, 0x7FF0000000000000U));
  const Lanes inverse = hn::BitCast(d, hn::Sub(hn::Set(bits, std::uint64_t{2046} << 52), exponent));
  return {hn::Mul(z.re, inverse), hn::Mul(z.im, inverse), z.passages};
}

HWY_INLINE Product load(const ProductTile& products, std::size_t i) {
  return {hn::Load(d, &products.re[i]), hn::Load(d, &products.im[i]), hn::Load(d, &products.turns[i])};
}

HWY_INLINE void store(const Product& z, ProductTile& products, std::size_t i) {
  hn::Store(z.re, d, &products.re[i]);
  hn::Store(z.im, d, &products.im[i]);
  hn::Store(z.passages, d, &products.turns[i]);
}

// One sample's product times re + i im.
void multiply_one(ProductTile& z, std::size_t i, double re, double im) {
  const double before = z.im[i];
  const double product_re = z.re[i] * re - before * im, product_im = z.re[i] * im + before * re;
  if (std::signbit(before) != std::signbit(product_im)) z.turns[i] += std::signbit(im) ? -1.0 : 1.0;
  z.re[i] = product_re;
  z.im[i] = product_im;
}

// A few edges of a chunk.
struct Block {
  std::size_t begin, end;
};

// What multiply_block() does, factor by factor, for those of the samples from i on whose bit in `trusted` is not set.
template <class Rays>
HWY_NOINLINE void multiply_carefully(ProductTile& products, const Chunk& chunk, const Rays& rays,
                                     const SampleTile& samples, std::size_t i, const Corners<Rays>& corners,
                                     const Block& block, std::uint64_t trusted) {
  for (std::size_t n = block.begin; n < block.end; ++n) {
    if (chunk.orientation[n] == 0.0) continue;
    const Factor factor = factor_of(rays, corners, n);
    const auto in_range = hn::And(hn::Gt(magnitude(factor), hn::Set(d, kSmallestFactor)),
                                  hn::Lt(magnitude(factor), hn::Set(d, kLargestFactor)));
    alignas(64) std::array<double, 8> re, im;
    hn::Store(factor.re, d, re.data());
    hn::Store(factor.im, d, im.data());
    std::uint8_t plain[8] = {};
    hn::StoreMaskBits(d, hn::And(is_not_near(factor), in_range), plain);
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
      const Vec3 q{samples.x[i + lane], samples.y[i + lane], samples.z[i + lane]};
      if ((trusted >> lane) & 1U) continue;
      if ((plain[0] >> lane) & 1U) {
        multiply_one(products, i + lane, re[lane], im[lane]);
      } else if (const auto f = edge_factor(chunk.vertex(n), chunk.vertex(n + 1), chunk.orientation[n] < 0.0, q,
                                            rays.side(n, q))) {
        multiply_one(products, i + lane, f->re, f->im);
      }
    }
  }
}

// Multiplies the factors of a block onto the products of the samples from i on, and looks at its vertices from the
// samples at `next`: their square roots fill the time that products wait for one another.
template <class Rays>
HWY_INLINE void multiply_block(ProductTile& products, const Chunk& chunk, const Rays& rays, const SampleTile& samples,
                               std::size_t i, const Corners<Rays>& corners, std::size_t next,
                               Corners<Rays>& next_corners, const Block& block) {
  Product z = load(products, i);
  auto trusted = hn::Eq(z.re, z.re);  // all
  for (std::size_t n = block.begin; n < block.end; ++n) {
    next_corners.look(chunk, rays, samples, n + 1, next);
    if (chunk.orientation[n] == 0.0) continue;
    const Factor factor = factor_of(rays, corners, n);
    trusted = hn::And(trusted, is_not_near(factor));
    z = times(z, factor);
  }
  // Factors too large show as a product that is large, infinite or NaN.
  trusted = hn::And(trusted, hn::Lt(hn::Add(hn::Abs(z.re), hn::Abs(z.im)), hn::Set(d, kLargestProduct)));
  if (HWY_LIKELY(hn::AllTrue(d, trusted))) {
    store(scaled(z), products, i);
  } else {
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, trusted, bits);
    multiply_carefully(products, chunk, rays, samples, i, corners, block, bits[0]);
    const Product careful = load(products, i);
    store(scaled({hn::IfThenElse(trusted, z.re, careful.re), hn::IfThenElse(trusted, z.im, careful.im),
                  hn::IfThenElse(trusted, z.passages, careful.passages)}),
          products, i);
  }
}

template <class Rays>
void multiply_chunk(ProductTile& products, const Chunk& chunk, const SampleTile& samples) {
  const Rays rays(chunk, samples);
  std::array<Corners<Rays>, 2> corners;  // of the samples at hand and of the next ones, in turns
  for (std::size_t n = 0; n <= chunk.edges; ++n) corners[0].look(chunk, rays, samples, n, 0);
  std::size_t here = 0;
  for (std::size_t i = 0; i < samples.count; i += hn::Lanes(d)) {
    const std::size_t next = i + hn::Lanes(d) < samples.count ? i + hn::Lanes(d) : i;
    corners[1 - here].look(chunk, rays, samples, 0, next);
    for (std::size_t begin = 0; begin < chunk.edges; begin += kEdgesPerBlock) {
      multiply_block(products, chunk, rays, samples, i, corners[here], next, corners[1 - here],
                     {begin, std::min(begin + kEdgesPerBlock, chunk.edges)});
    }
    here = 1 - here;
  }
}

// Passages of the positive and the negative real axis, with a sign each, become turns, which are those of the negative
// axis from above (+1) and from below (-1). A, B: passages from above to below with Im f >= 0 and Im f < 0; C, D: from
// below to above with Im f < 0 and Im f >= 0. The turns are A - C, and passages = A + D - B - C, and A + B - C - D is 1
// where the product ends below, else 0. Rounding can neither create nor lose a turn (docs/method.md).
void set_turns(ProductTile& products, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    products.turns[i] = (products.turns[i] + (std::signbit(products.im[i]) ? 1.0 : 0.0)) / 2;
  }
}

// atan(t) / (2 pi) for t in [0, 1]. This and the next one: operation by operation what core/angle.cpp does for one.
HWY_INLINE Lanes arc_tangent_in_turns(Lanes t) {
  static constexpr auto kTable = [] {
    std::array<double, kArcTangentsInTurns.size()> table{};
    std::copy(kArcTangentsInTurns.begin(), kArcTangentsInTurns.end(), table.begin());
    return table;
  }();
  const hn::RebindToSigned<Doubles> integers;
  const Lanes k = hn::Round(hn::Mul(hn::Set(d, 8.0), t));
  const Lanes c = hn::Mul(k, hn::Set(d, 0.125));
  const Lanes rest = hn::Div(hn::Sub(t, c), hn::Add(hn::Set(d, 1.0), hn::Mul(t, c)));
  const Lanes s = hn::Mul(rest, rest);
  Lanes tail = hn::Zero(d);
  for (int power = 17; power >= 3; power -= 2) {
    tail = hn::Mul(s, hn::Add(hn::Set(d, (power % 4 == 1 ? 1.0 : -1.0) / power), tail));
  }
  const Lanes radians = hn::Add(rest, hn::Mul(rest, tail));
  return hn::Add(hn::GatherIndex(d, kTable.data(), hn::ConvertTo(integers, k)),
                 hn::Mul(hn::Set(d, static_cast<double>(kTurnsPerRadian)), radians));
}

HWY_INLINE Lanes argument_in_turns_of(Lanes re, Lanes im) {
  const Lanes x = hn::Abs(re), y = hn::Abs(im);
  const auto flat = hn::Le(y, x);
  const Lanes octant = arc_tangent_in_turns(hn::Div(hn::IfThenElse(flat, y, x), hn::IfThenElse(flat, x, y)));
  const Lanes quadrant = hn::IfThenElse(flat, octant, hn::Sub(hn::Set(d, 0.25), octant));
  return hn::CopySign(hn::IfNegativeThenElse(re, hn::Sub(hn::Set(d, 0.5), quadrant), quadrant), im);
}

void set_arguments(ProductTile& products, std::size_t count) {
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    hn::Store(argument_in_turns_of(hn::Load(d, &products.re[i]), hn::Load(d, &products.im[i])), d,
              &products.argument[i]);
  }
}

template <class Rays>
void multiply_all(std::span<const ChainStep> steps, const SampleTile& samples, ProductTile& products) {
  products.re.fill(1.0);
  products.im.fill(0.0);
  products.turns.fill(0.0);
  for (std::size_t begin = 0; begin < steps.size(); begin += kEdgesPerChunk) {
    const Vec3& from = steps[begin > 0 ? begin - 1 : 0].to;
    const Chunk chunk(from, steps.subspan(begin, std::min(kEdgesPerChunk, steps.size() - begin)));
    multiply_chunk<Rays>(products, chunk, samples);
  }
  set_turns(products, samples.count);
  set_arguments(products, samples.count);
}

void multiply_chains_here(std::span<const ChainStep> steps, const SampleTile& samples, ProductTile& products) {
  if (samples.share_a_ray()) {
    multiply_all<OneRay>(steps, samples, products);
  } else {
    multiply_all<RayOfEach>(steps, samples, products);
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
