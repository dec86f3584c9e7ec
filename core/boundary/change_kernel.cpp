#include "core/boundary/change_kernel.h"

#include <limits>

// Highway compiles what is between its markers once per SIMD level.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/boundary/change_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/machine/lanes-inl.h"
#include "core/machine/simd_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

// Of a distance: less has lost bits, or its third power does.
constexpr double kLeastSquare = 0x1p-660;
constexpr std::size_t kDeepest = 16;  // levels of nodes: each has eight times as many as the one above it

// Of the distances of the boxes from lane i on from `box`.
HWY_INLINE Lanes square_of_gap(const ChangeNode& node, std::size_t i, const Box& box) {
  Lanes sum = hn::Zero(d);
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const Lanes below = hn::Sub(hn::Load(d, &node.lower[a][i]), hn::Set(d, box.upper[axis]));
    const Lanes above = hn::Sub(hn::Set(d, box.lower[axis]), hn::Load(d, &node.upper[a][i]));
    const Lanes gap = hn::Max(hn::Max(below, above), hn::Zero(d));
    sum = hn::Add(sum, hn::Mul(gap, gap));
  }
  return sum;
}

// add(node, i, square, taken) for the lanes from i on, `taken` those that count as they are, as long as it returns
// true.
template <class Add>
HWY_INLINE void visit(std::span<const ChangeNode> nodes, const Box& box, const Add& add) {
  std::array<std::uint32_t, 8 * kDeepest> waiting;
  std::size_t count = 1;
  waiting[0] = 0;
  while (count > 0) {
    const ChangeNode& node = nodes[waiting[--count]];
    for (std::size_t i = 0; i < 8; i += hn::Lanes(d)) {
      const Lanes square = square_of_gap(node, i, box);
      const auto taken = hn::Gt(square, hn::Load(d, &node.far_square[i]));
      if (!add(node, i, square, taken)) return;
      if (hn::AllTrue(d, taken)) continue;
      const std::uint32_t bits = bits_of(taken);
      for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
        if (!(bits >> lane & 1U)) waiting[count++] = node.child[i + lane];
      }
    }
  }
}

HWY_INLINE bool comes_too_close(Lanes square, LaneMask taken) {
  return !hn::AllFalse(d, hn::And(taken, hn::Lt(square, hn::Set(d, kLeastSquare))));
}

double gradient_here(std::span<const ChangeNode> nodes, const Box& box, double limit) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  alignas(64) ChangeNode::Numbers sums{};
  bool too_close = false;
  visit(nodes, box, [&](const ChangeNode& node, std::size_t i, Lanes square, LaneMask taken) {
    too_close = comes_too_close(square, taken);
    const Lanes of_length = hn::Div(hn::Load(d, &node.length[i]), square);
    const Lanes of_area = hn::Div(hn::Load(d, &node.area[i]), hn::Mul(square, hn::Sqrt(square)));
    const Lanes terms = hn::IfThenElseZero(taken, hn::Add(of_length, of_area));
    hn::Store(hn::Add(hn::Load(d, &sums[i]), terms), d, &sums[i]);
    return !too_close;
  });
  double sum = 0.0;
  for (const double number : sums) sum += number;
  return !too_close && sum <= limit ? sum : kInfinity;
}

ChangeSums derivatives_here(std::span<const ChangeNode> nodes, const Box& box) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  alignas(64) std::array<ChangeNode::Numbers, kChangeOrders> sums{};
  bool too_close = false;
  visit(nodes, box, [&](const ChangeNode& node, std::size_t i, Lanes square, LaneMask taken) {
    too_close = comes_too_close(square, taken);
    const Lanes used = hn::IfThenElse(taken, square, hn::Set(d, 1.0));
    const Lanes inverse_square = hn::Div(hn::Set(d, 1.0), used), inverse = hn::Sqrt(inverse_square);
    Lanes of_length = hn::IfThenElseZero(taken, hn::Mul(hn::Load(d, &node.length[i]), inverse_square));
    Lanes of_area = hn::IfThenElseZero(taken, hn::Mul(hn::Load(d, &node.area[i]), hn::Mul(inverse_square, inverse)));
    for (std::size_t k = 0; k < kChangeOrders; ++k) {
      const Lanes terms = hn::Add(of_length, hn::Mul(hn::Set(d, static_cast<double>(k + 2) / 2), of_area));
      hn::Store(hn::Add(hn::Load(d, &sums[k][i]), terms), d, &sums[k][i]);
      of_length = hn::Mul(of_length, inverse);
      of_area = hn::Mul(of_area, inverse);
    }
    return !too_close;
  });
  ChangeSums result{};
  for (std::size_t k = 0; k < kChangeOrders; ++k) {
    for (const double number : sums[k]) result[k] += number;
    if (too_close) result[k] = kInfinity;
  }
  return result;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raycone {

ChangeKernel change_kernel(SimdLevel level) {
  return {RAYCONE_AT_LEVEL(level, gradient_here), RAYCONE_AT_LEVEL(level, derivatives_here)};
}

}  // namespace raycone
#endif
