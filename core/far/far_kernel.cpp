#include "core/far/far_kernel.h"

#include <array>
#include <cstddef>

// Highway compiles what is between its markers once per SIMD level.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/far/far_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/far/chunk_lanes-inl.h"

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

struct LanesOfPoints {
  Lanes x, y, z;
};

HWY_INLINE LanesOfPoints points_at(const SampleTile& samples, std::size_t i) {
  return {hn::Load(d, &samples.x[i]), hn::Load(d, &samples.y[i]), hn::Load(d, &samples.z[i])};
}

HWY_INLINE LanesOfPoints seen_from(const Vec3& centre, const LanesOfPoints& q) {
  return {hn::Sub(q.x, hn::Set(d, centre.x)), hn::Sub(q.y, hn::Set(d, centre.y)), hn::Sub(q.z, hn::Set(d, centre.z))};
}

HWY_INLINE Lanes square_of(const LanesOfPoints& r) {
  return hn::Add(hn::Add(hn::Mul(r.x, r.x), hn::Mul(r.y, r.y)), hn::Mul(r.z, r.z));
}

constexpr std::array<double, kMultipoleOrder + 1> kDegrees = [] {
  std::array<double, kMultipoleOrder + 1> degrees{};
  for (std::size_t n = 0; n < degrees.size(); ++n) degrees[n] = static_cast<double>(n);
  return degrees;
}();

// The sum of coefficient b_n^m over n.
struct OrderSum {
  Lanes re = hn::Zero(d), im = hn::Zero(d), before = hn::Zero(d), b = hn::Set(d, 1.0);
  const double* coefficient;
  const double* step;

  HWY_INLINE OrderSum(const SourceNode& node, const double* coefficients, int m)
      : coefficient(coefficients + 2 * multipole_index(m, m, node.order)), step(&kSteps[multipole_index(m, m)]) {}

  template <bool kMixed>
  HWY_INLINE void add(int n, Lanes degrees, Lanes wz, Lanes inverse) {
    Lanes used = b;
    if constexpr (kMixed) used = hn::IfThenElseZero(hn::Ge(degrees, hn::Set(d, kDegrees[static_cast<unsigned>(n)])), b);
    re = hn::Add(re, hn::Mul(hn::Set(d, coefficient[0]), used));
    im = hn::Add(im, hn::Mul(hn::Set(d, coefficient[1]), used));
    const Lanes next = hn::Sub(hn::Mul(wz, b), hn::Mul(hn::Set(d, *step), hn::Mul(inverse, before)));
    before = b;
    b = next;
    coefficient += 2;
    ++step;
  }
};

// The expansion cut off behind degree p; where kMixed, behind the lane's own degree, which p is the largest of. The
// same bits either way.
template <bool kMixed>
HWY_INLINE Lanes multipole(const SourceNode& node, const double* coefficients, int p, Lanes degrees,
                           const LanesOfPoints& r) {
  const Lanes scale = hn::Set(d, 1 / node.unit);
  const LanesOfPoints s{hn::Mul(r.x, scale), hn::Mul(r.y, scale), hn::Mul(r.z, scale)};
  const Lanes inverse = hn::Div(hn::Set(d, 1.0), square_of(s));
  const Lanes wx = hn::Mul(s.x, inverse), wy = hn::Mul(s.y, inverse), wz = hn::Mul(s.z, inverse);
  Lanes re = hn::Zero(d), im = hn::Zero(d);
  const auto add_order = [&](const OrderSum& order) {  // times (x + iy) / r^2, plus it
    const Lanes next_re = hn::Add(hn::Sub(hn::Mul(re, wx), hn::Mul(im, wy)), order.re);
    im = hn::Add(hn::Add(hn::Mul(re, wy), hn::Mul(im, wx)), order.im);
    re = next_re;
  };
  // Two orders at a time, so that the processor has more to do than to wait for a recurrence.
  int m = p;
  for (; m >= 1; m -= 2) {
    OrderSum upper(node, coefficients, m), lower(node, coefficients, m - 1);
    lower.template add<kMixed>(m - 1, degrees, wz, inverse);
    for (int n = m; n <= p; ++n) {
      upper.template add<kMixed>(n, degrees, wz, inverse);
      lower.template add<kMixed>(n, degrees, wz, inverse);
    }
    add_order(upper);
    add_order(lower);
  }
  if (m == 0) {
    OrderSum last(node, coefficients, 0);
    for (int n = 0; n <= p; ++n) last.template add<kMixed>(n, degrees, wz, inverse);
    add_order(last);
  }
  return hn::Mul(re, hn::Sqrt(inverse));
}

// The expansion at lanes that are far enough for one of its degrees, each cut off as early as its distance allows.
HWY_INLINE Lanes multipole_at(const SourceNode& node, const double* coefficients, hn::Mask<Doubles> accepted,
                              Lanes square, const LanesOfPoints& r) {
  const auto needs = [&](int p) {  // lanes that degrees up to p do not serve
    return hn::And(accepted, hn::Lt(square, hn::Set(d, node.square_of_distance[static_cast<std::size_t>(p)])));
  };
  int p = node.order;
  while (hn::AllFalse(d, needs(p - 1))) --p;
  const auto all = needs(p - 1);
  if (hn::CountTrue(d, all) == hn::CountTrue(d, accepted)) {
    return multipole<false>(node, coefficients, p, hn::Zero(d), r);
  }
  Lanes degrees = hn::Set(d, 1.0);
  for (int k = 1; k < p; ++k) degrees = hn::Add(degrees, hn::IfThenElseZero(needs(k), hn::Set(d, 1.0)));
  return multipole<true>(node, coefficients, p, degrees, r);
}

// Walks the tree with the lanes from sample i on. A lane that has taken a node as far is out until the node is over.
void sum_group(const SourceTree& tree, const SampleTile& samples, std::size_t i, FarTile& result) {
  const std::span<const SourceNode> nodes = tree.nodes();
  const double* coefficients = tree.coefficients().data();
  const LanesOfPoints q = points_at(samples, i);
  const auto counted = hn::FirstN(d, samples.count - i);
  Lanes far = hn::Zero(d), until = hn::Zero(d);
  for (std::size_t k = 0; k < nodes.size();) {
    const SourceNode& node = nodes[k];
    auto near = hn::Ge(hn::Set(d, static_cast<double>(k)), until);
    const LanesOfPoints r = seen_from(node.centre, q);
    const Lanes square = square_of(r);
    const double least = node.square_of_distance[static_cast<std::size_t>(node.order)];
    const auto accepted = hn::And(near, hn::Ge(square, hn::Set(d, least)));
    if (!hn::AllFalse(d, accepted)) {
      const Lanes value = multipole_at(node, coefficients + node.first_coefficient, accepted, square, r);
      far = hn::IfThenElse(accepted, hn::Add(far, value), far);
      until = hn::IfThenElse(accepted, hn::Set(d, static_cast<double>(node.next)), until);
      near = hn::AndNot(accepted, near);
      result.far_terms += hn::CountTrue(d, hn::And(accepted, counted));
      if (hn::AllFalse(d, near)) {
        k = node.next;
        continue;
      }
    }
    for (std::size_t chunk = node.first_chunk; chunk < node.last_chunk; ++chunk) {
      multiply_chunk(result.near, tree.corners().chunk(chunk), samples, i, near);
    }
    result.near_terms += (node.own_end - node.begin) * hn::CountTrue(d, hn::And(near, counted));
    ++k;
  }
  hn::Store(far, d, &result.far[i]);
}

void sum_here(const SourceTree& tree, const SampleTile& samples, FarTile& result) {
  set_ones(result.near);
  for (std::size_t i = 0; i < samples.count; i += hn::Lanes(d)) sum_group(tree, samples, i, result);
  set_arguments(result.near, samples.count);
}

void add_multipole_here(const SourceTree& tree, std::uint32_t number, int p, const SampleTile& samples, Tile& values) {
  const SourceNode& node = tree.nodes()[number];
  const double* coefficients = tree.coefficients().data() + node.first_coefficient;
  for (std::size_t i = 0; i < samples.count; i += hn::Lanes(d)) {
    const LanesOfPoints r = seen_from(node.centre, points_at(samples, i));
    const Lanes value = multipole<false>(node, coefficients, p, hn::Zero(d), r);
    hn::Store(hn::Add(hn::Load(d, &values[i]), value), d, &values[i]);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raycone {

FarKernel far_kernel([[maybe_unused]] SimdLevel level) {
#if HWY_ARCH_X86
  const SimdLevel available = available_level(level);
  if (available == SimdLevel::kAvx512) return {HWY_CHOOSE_AVX3(sum_here), HWY_CHOOSE_AVX3(add_multipole_here)};
  if (available == SimdLevel::kAvx2) return {HWY_CHOOSE_AVX2(sum_here), HWY_CHOOSE_AVX2(add_multipole_here)};
  if (available == SimdLevel::kSse4) return {HWY_CHOOSE_SSE4(sum_here), HWY_CHOOSE_SSE4(add_multipole_here)};
#endif
  return {&HWY_STATIC_DISPATCH(sum_here), &HWY_STATIC_DISPATCH(add_multipole_here)};
}

}  // namespace raycone
#endif
