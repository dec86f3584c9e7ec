#include "core/far/far_kernel.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <limits>
#include <span>

// Highway compiles what is between its markers once per SIMD level.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/far/far_kernel.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/far/chunk_lanes-inl.h"
#include "core/machine/simd_kernel.h"
#include "core/machine/vector_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

// multipole_step(n, m) in the order of multipole_index(n, m).
constexpr std::array<double, kMultipoleTerms> kSteps = [] {
  std::array<double, kMultipoleTerms> steps{};
  for (int m = 0; m <= kMultipoleOrder; ++m) {
    for (int n = m; n <= kMultipoleOrder; ++n) steps[multipole_index(n, m)] = multipole_step(n, m);
  }
  return steps;
}();

HWY_INLINE VectorLanes points_at(const SampleTile& samples, std::size_t i) {
  return {hn::Load(d, &samples.x[i]), hn::Load(d, &samples.y[i]), hn::Load(d, &samples.z[i])};
}

HWY_INLINE VectorLanes seen_from(const Vec3& centre, const VectorLanes& q) { return minus(q, in_all_lanes(centre)); }

HWY_INLINE Lanes square_of(const VectorLanes& r) { return dot(r, r); }

constexpr std::array<double, kMultipoleOrder + 1> kDegrees = [] {
  std::array<double, kMultipoleOrder + 1> degrees{};
  for (std::size_t n = 0; n < degrees.size(); ++n) degrees[n] = static_cast<double>(n);
  return degrees;
}();

// The sum of coefficient b_n^m over n.
struct OrderSum {
  Lanes re = hn::Zero(d), im = hn::Zero(d), before = hn::Zero(d), b = hn::Set(d, 1.0);
  const double* coefficient;
  std::size_t to_next;  // degree's coefficient
  const double* step;

  HWY_INLINE OrderSum(const double* coefficients, int m)
      : coefficient(coefficients + 2 * coefficient_index(m, m)),
        to_next(2 * static_cast<std::size_t>(m + 1)),
        step(&kSteps[multipole_index(m, m)]) {}

  // The term of degree n, where the lane's own degree is not less.
  HWY_INLINE void add(int n, Lanes degrees, Lanes wz, Lanes inverse) {
    const auto used = hn::Ge(degrees, hn::Set(d, kDegrees[static_cast<unsigned>(n)]));
    add_used(hn::IfThenElseZero(used, b), wz, inverse);
  }
  HWY_INLINE void add(Lanes wz, Lanes inverse) { add_used(b, wz, inverse); }

 private:
  HWY_INLINE void add_used(Lanes used, Lanes wz, Lanes inverse) {
    re = hn::Add(re, hn::Mul(hn::Set(d, coefficient[0]), used));
    im = hn::Add(im, hn::Mul(hn::Set(d, coefficient[1]), used));
    const Lanes next = hn::Sub(hn::Mul(wz, b), hn::Mul(hn::Set(d, *step), hn::Mul(inverse, before)));
    before = b;
    b = next;
    coefficient += to_next;
    to_next += 2;
    ++step;
  }
};

// Where the lanes cut an expansion off: behind degree `all` at least, `most` at most, each behind its own of `degrees`.
struct Degrees {
  int all, most;
  Lanes each;  // of no meaning where all = most
};

// The sum over m, from the highest order down: each time what is there times (x + iy) / r^2, and the order's sum.
struct Expansion {
  const double* coefficients;
  const Degrees& degrees;
  Lanes wx, wy, wz, inverse;
  Lanes re, im;

  [[nodiscard]] HWY_INLINE OrderSum order(int m) const { return {coefficients, m}; }

  // Orders that follow one another, from the highest down to m. Their sums are made together, so that the processor has
  // more to do than to wait for a recurrence.
  template <class... Orders>
  HWY_INLINE void add_orders(int m, Orders... orders) {
    const int all_begun = m + static_cast<int>(sizeof...(orders)) - 1;  // degree
    int first = all_begun;
    (add_terms(orders, first--, all_begun), ...);
    int n = all_begun;
    for (; n <= degrees.all; ++n) (orders.add(wz, inverse), ...);
    for (; n <= degrees.most; ++n) (orders.add(n, degrees.each, wz, inverse), ...);
    (add(orders), ...);
  }

 private:
  // Of degrees [n, end).
  HWY_INLINE void add_terms(OrderSum& order, int n, int end) const {
    for (; n < end; ++n) {
      if (n <= degrees.all) {
        order.add(wz, inverse);
      } else {
        order.add(n, degrees.each, wz, inverse);
      }
    }
  }

  HWY_INLINE void add(const OrderSum& order) {
    const Lanes next_re = hn::Add(hn::Sub(hn::Mul(re, wx), hn::Mul(im, wy)), order.re);
    im = hn::Add(hn::Add(hn::Mul(re, wy), hn::Mul(im, wx)), order.im);
    re = next_re;
  }
};

HWY_INLINE Lanes multipole(const SourceNode& node, const double* coefficients, const Degrees& degrees,
                           const VectorLanes& r) {
  const Lanes scale = hn::Set(d, 1 / node.unit);
  const VectorLanes s = times(scale, r);
  // So many units away that products may overflow, the node adds nothing that counts.
  constexpr double kFarthest = 0x1p1000;
  const Lanes square = square_of(s);
  const auto visible = hn::Lt(square, hn::Set(d, kFarthest));
  const Lanes inverse = hn::IfThenElseZero(visible, hn::Div(hn::Set(d, 1.0), square));
  const auto inverted = [&](Lanes v) { return hn::IfThenElseZero(visible, hn::Mul(v, inverse)); };
  Expansion sum{coefficients, degrees, inverted(s.x), inverted(s.y), inverted(s.z), inverse, hn::Zero(d), hn::Zero(d)};
  // As many together as there are registers for. What they leave over is of the highest orders, the shortest ones.
  constexpr int kTogether = HWY_TARGET <= HWY_AVX3 ? 4 : 2;
  int m = degrees.most;
  for (; (m + 1) % kTogether != 0; --m) sum.add_orders(m, sum.order(m));
  if constexpr (kTogether == 4) {
    for (; m >= 0; m -= 4) sum.add_orders(m - 3, sum.order(m), sum.order(m - 1), sum.order(m - 2), sum.order(m - 3));
  } else {
    for (; m >= 0; m -= 2) sum.add_orders(m - 1, sum.order(m), sum.order(m - 1));
  }
  return hn::Mul(sum.re, hn::Sqrt(inverse));
}

// The degrees that serve lanes as far away as `square` says, none above the node's order.
HWY_INLINE Degrees degrees_at(const SourceNode& node, Lanes square) {
  const auto degree_at = [&](double distance, int p) {
    while (p > 1 && distance >= node.square_of_distance[static_cast<std::size_t>(p - 1)]) --p;
    return p;
  };
  const double nearest = hn::GetLane(hn::MinOfLanes(d, square)), farthest = hn::GetLane(hn::MaxOfLanes(d, square));
  const int most = degree_at(nearest, node.order), all = degree_at(farthest, most);
  Lanes each = hn::Set(d, kDegrees[static_cast<unsigned>(all)]);
  for (int k = all; k < most; ++k) {
    const auto served = hn::Ge(square, hn::Set(d, node.square_of_distance[static_cast<std::size_t>(k)]));
    each = hn::Add(each, hn::IfThenElse(served, hn::Zero(d), hn::Set(d, 1.0)));
  }
  return {all, most, each};
}

// Samples that take a node as far, moved together: they leave few lanes idle then.
struct FarSamples {
  std::array<std::uint8_t, kTile> places;  // in the tile
  std::size_t count = 0;

  HWY_INLINE void add(LaneMask lanes, std::size_t first) {
    for (std::uint32_t bits = bits_of(lanes); bits != 0; bits &= bits - 1) {
      places[count++] = static_cast<std::uint8_t>(first + static_cast<std::size_t>(std::countr_zero(bits)));
    }
  }

  // Those from `first` on, the last one repeated where there are none left.
  [[nodiscard]] HWY_INLINE VectorLanes points(const SampleTile& samples, std::size_t first) const {
    alignas(64) std::array<double, hn::MaxLanes(d)> x, y, z;
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
      const std::size_t i = places[std::min(first + lane, count - 1)];
      x[lane] = samples.x[i];
      y[lane] = samples.y[i];
      z[lane] = samples.z[i];
    }
    return {hn::Load(d, x.data()), hn::Load(d, y.data()), hn::Load(d, z.data())};
  }

  HWY_INLINE void add_to(Tile& sums, std::size_t first, Lanes values) const {
    alignas(64) std::array<double, hn::MaxLanes(d)> each;
    hn::Store(values, d, each.data());
    const std::size_t end = std::min(first + hn::Lanes(d), count);
    for (std::size_t n = first; n < end; ++n) sums[places[n]] += each[n - first];
  }
};

// Samples on their way through the tree. One that has taken a node as far is out until the node is over.
struct Walk {
  const SourceTree& tree;
  const SampleTile& samples;
  FarTile& result;
  alignas(64) Tile until;  // infinite behind the last sample

  // Lanes from sample i on that have not taken a node above node k.
  [[nodiscard]] HWY_INLINE LaneMask open(std::size_t i, std::size_t k) const {
    return hn::Ge(hn::Set(d, static_cast<double>(k)), hn::Load(d, &until[i]));
  }

  // Those of degrees [first, last] of an expansion: of a large tree they are in no cache.
  static HWY_INLINE void fetch(const double* coefficients, int first, int last) {
    constexpr std::size_t kLine = 8;  // numbers
    const std::size_t end = 2 * coefficient_index(last + 1, 0);
    for (std::size_t n = 2 * coefficient_index(first, 0); n < end; n += kLine) hwy::Prefetch(coefficients + n);
  }

  // Takes node k where it is far enough; whether it is too near for any sample.
  HWY_INLINE bool take(std::size_t k) {
    const SourceNode& node = tree.nodes()[k];
    const double* const coefficients = tree.coefficients() + node.first_coefficient;
    // Four in five nodes that are looked at are taken: memory is asked for them before that is known.
    constexpr int kOften = 8;  // degree
    const int often = std::min(node.order, kOften);
    fetch(coefficients, 0, often);
    hwy::Prefetch(&node + 1);
    const Lanes least = hn::Set(d, node.square_of_distance[static_cast<std::size_t>(node.order)]);
    const Lanes next = hn::Set(d, static_cast<double>(node.next));
    FarSamples far;
    bool near = false;
    for (std::size_t i = 0; i < samples.count; i += hn::Lanes(d)) {
      const auto entered = open(i, k);
      if (hn::AllFalse(d, entered)) continue;
      const auto accepted = hn::And(entered, hn::Ge(square_of(seen_from(node.centre, points_at(samples, i))), least));
      near |= !hn::AllTrue(d, hn::Or(accepted, hn::Not(entered)));
      if (hn::AllFalse(d, accepted)) continue;
      hn::Store(hn::IfThenElse(accepted, next, hn::Load(d, &until[i])), d, &until[i]);
      far.add(accepted, i);
    }
    for (std::size_t n = 0; n < far.count; n += hn::Lanes(d)) {
      const VectorLanes r = seen_from(node.centre, far.points(samples, n));
      const Degrees degrees = degrees_at(node, square_of(r));
      if (n == 0) fetch(coefficients, often + 1, degrees.most);
      far.add_to(result.far, n, multipole(node, coefficients, degrees, r));
    }
    result.far_terms += far.count;
    return near;
  }

  HWY_INLINE void multiply_own(std::size_t k) {
    const SourceNode& node = tree.nodes()[k];
    for (std::size_t i = 0; i < samples.count; i += hn::Lanes(d)) {
      const auto near = open(i, k);
      if (hn::AllFalse(d, near)) continue;
      const Lanes square = square_of(seen_from(node.centre, points_at(samples, i)));
      const bool small = hn::AllTrue(d, hn::Ge(square, hn::Set(d, node.square_of_small)));
      for (std::size_t n = node.first_chunk; n < node.last_chunk; ++n) {
        const SharedCorners::Chunk chunk = tree.corners().chunk(n);
        TrianglesOfChunk<Care::kFull> views(chunk, samples);
        multiply_chunk(result.near, chunk, views, samples, i, near, small ? Looks::kSmall : Looks::kLarge);
      }
      result.near_terms += (node.own_end - node.begin) * hn::CountTrue(d, near);
    }
  }
};

// Node by node for all samples: neighbours in space need much the same nodes, which come from memory once.
void sum_here(const SourceTree& tree, const SampleTile& samples, FarTile& result) {
  set_ones(result.near);
  result.far.fill(0.0);
  Walk walk{tree, samples, result, {}};
  for (std::size_t i = samples.count; i < kTile; ++i) walk.until[i] = std::numeric_limits<double>::infinity();
  const std::span<const SourceNode> nodes = tree.nodes();
  for (std::size_t k = 0; k < nodes.size();) {
    const bool near = walk.take(k);
    if (near && nodes[k].first_chunk < nodes[k].last_chunk) walk.multiply_own(k);
    k = near ? k + 1 : nodes[k].next;
  }
  set_arguments(result.near, samples.count);
}

void add_multipole_here(const SourceTree& tree, std::uint32_t number, int p, const SampleTile& samples, Tile& values) {
  const SourceNode& node = tree.nodes()[number];
  const double* coefficients = tree.coefficients() + node.first_coefficient;
  for (std::size_t i = 0; i < samples.count; i += hn::Lanes(d)) {
    const Lanes value =
        multipole(node, coefficients, {p, p, hn::Zero(d)}, seen_from(node.centre, points_at(samples, i)));
    hn::Store(hn::Add(hn::Load(d, &values[i]), value), d, &values[i]);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raycone {

FarKernel far_kernel(SimdLevel level) {
  return {RAYCONE_AT_LEVEL(level, sum_here), RAYCONE_AT_LEVEL(level, add_multipole_here)};
}

}  // namespace raycone
#endif
