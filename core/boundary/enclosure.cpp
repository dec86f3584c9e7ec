// Every constant counts roundings, derived in docs/method.md, "Error bound".
#include "core/boundary/enclosure.h"

#include <quadmath.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/boundary/edge_factor.h"
#include "core/boundary/enclosure_kernel.h"

namespace raycone {
namespace {

const Quad kTurn = 8 * atanq(1);

TurnsWithin turns_of(const Factor<Quad>& product, std::int64_t turns, Quad error) {
  return {turns, atan2q(product.im, product.re) / kTurn, error / kTurn};
}

Quad part_of(double high, double low) {
  return std::abs(high) < kNoPart ? Quad(std::copysign(0.0, high)) : Quad(high) + low;
}

// The product of factors, the turns completed, and a bound of its argument's error.
struct QuadProduct {
  Factor<Quad> z{1, 0};
  std::int64_t turns = 0;
  Quad error = 0;  // of its argument, radians

  // `error`: of the factor's argument. Both factors and product are rounded, the latter by sqrt(5) u (docs/method.md).
  void multiply(const Factor<Quad>& f, Quad factor_error) {
    const Factor<Quad> product{z.re * f.re - z.im * f.im, z.re * f.im + z.im * f.re};
    const bool before = signbitq(z.im) != 0, turn = signbitq(f.im) != 0, after = signbitq(product.im) != 0;
    if (before == turn && after != before) turns += before ? -1 : 1;
    error += factor_error + 8 * kQuadRounding;
    const int exponent = -ilogbq(fmaxq(absolute(product.re), absolute(product.im)));
    z = {scalbnq(product.re, exponent), scalbnq(product.im, exponent)};
  }
};

TurnsWithin enclose_in_113(const ChainGroup& group, const Vec3& q) {
  QuadProduct product;
  for (std::size_t i = 1; i < group.steps.size(); ++i) {
    const ChainStep& step = group.steps[i];
    if (!step.joined) continue;
    if (const auto f = close_edge_factor(group.steps[i - 1].to, step, q)) product.multiply(f->factor, f->error);
  }
  return turns_of(product.z, product.turns, product.error);
}

// Adds what a group adds. What its rest, the multiple of that and the sum round is less than 8 roundings of the two.
void add(const ChainGroup& group, const TurnsWithin& turns, TurnsWithin& sum) {
  const Quad rest = group.multiplicity * turns.rest;
  sum.whole += group.multiplicity * turns.whole;
  sum.rest += rest;
  sum.bound += group.multiplicity * turns.bound + 8 * kQuadRounding * (absolute(rest) + absolute(sum.rest));
}

}  // namespace

void enclose_in_106_bits(std::span<const ChainGroup> groups, SampleTile& samples, std::span<TurnsWithin> cones) {
  static const EnclosureKernel multiply_pairs = enclosure_kernel(SimdLevel::kBest);
  samples.fill_up();
  PairProductTile z;
  std::ranges::fill(cones, TurnsWithin{});
  for (const ChainGroup& group : groups) {
    multiply_pairs(group.steps, samples, z);
    for (std::size_t i = 0; i < cones.size(); ++i) {
      const Factor<Quad> product{part_of(z.re_high[i], z.re_low[i]), part_of(z.im_high[i], z.im_low[i])};
      add(group, turns_of(product, static_cast<std::int64_t>(z.turns[i]), z.error[i]), cones[i]);
    }
  }
}

TurnsWithin enclose_in_113_bits(std::span<const ChainGroup> groups, const Vec3& q) {
  TurnsWithin sum;
  for (const ChainGroup& group : groups) add(group, enclose_in_113(group, q), sum);
  return sum;
}

void enclose(std::span<const ChainGroup> groups, SampleTile& samples, std::span<TurnsWithin> cones) {
  enclose_in_106_bits(groups, samples, cones);
  for (std::size_t i = 0; i < cones.size(); ++i) {
    if (!(cones[i].bound < std::numeric_limits<double>::infinity()))
      cones[i] = enclose_in_113_bits(groups, samples.query(i));
  }
}

}  // namespace raycone
