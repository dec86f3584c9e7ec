#include "core/far/moment_kernel.h"

#include <algorithm>
#include <cstddef>

#include "core/far/multipole.h"

// Highway compiles what is between its markers once per SIMD level.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/far/moment_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/machine/lanes-inl.h"
#include "core/machine/simd_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

static_assert(hn::MaxLanes(d) <= kMomentLanes);

// What leads from R_(n-1)^m and R_n^m to R_(n+1)^m, in the order of multipole_index(n, m, kMomentOrder).
struct Step {
  double forward, back;
};
constexpr std::array<Step, kMomentTerms> kSteps = [] {
  std::array<Step, kMomentTerms> steps{};
  for (int m = 0; m <= kMomentOrder; ++m) {
    for (int n = m; n <= kMomentOrder; ++n) {
      const double step = 1.0 / ((n + 1) * (n + 1) - m * m);
      steps[multipole_index(n, m, kMomentOrder)] = {(2 * n + 1) * step, step};
    }
  }
  return steps;
}();

// Of each term, of as many edges as there are lanes.
struct Integrals {
  alignas(64) std::array<MomentLanes, kMomentTerms> re, im;
};

// Numbers, one in each lane.
struct ComplexLanes {
  Lanes re, im;
};

// Of R_n^m at one point, n <= last, times its weight: adds those of all n to the integrals.
HWY_INLINE void add_column(int m, int last, const ComplexLanes& corner, Lanes z, Lanes square, bool is_first,
                           Integrals& integrals) {
  ComplexLanes value = corner, before{hn::Zero(d), hn::Zero(d)};
  const Step* step = &kSteps[multipole_index(m, m, kMomentOrder)];
  std::size_t term = multipole_index(m, m, last);
  for (int n = m; n <= last; ++n, ++term, ++step) {
    double* const re = integrals.re[term].data();
    double* const im = integrals.im[term].data();
    hn::Store(is_first ? value.re : hn::Add(hn::Load(d, re), value.re), d, re);
    hn::Store(is_first ? value.im : hn::Add(hn::Load(d, im), value.im), d, im);
    const Lanes forward = hn::Mul(hn::Set(d, step->forward), z), back = hn::Mul(hn::Set(d, step->back), square);
    const ComplexLanes next{hn::Sub(hn::Mul(forward, value.re), hn::Mul(back, before.re)),
                            hn::Sub(hn::Mul(forward, value.im), hn::Mul(back, before.im))};
    before = value;
    value = next;
  }
}

HWY_INLINE void integrate(const MomentEdges& edges, std::size_t lane, int last, const GaussRule& rule,
                          Integrals& integrals) {
  for (std::size_t point = 0; point < rule.points; ++point) {
    const Lanes t = hn::Set(d, rule.at[point]);
    const auto at = [&](std::size_t axis) {
      return hn::Add(hn::Load(d, &edges.from[axis][lane]), hn::Mul(t, hn::Load(d, &edges.along[axis][lane])));
    };
    const Lanes x = at(0), y = at(1), z = at(2);
    const Lanes square = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
    ComplexLanes corner{hn::Set(d, rule.weight[point]), hn::Zero(d)};
    for (int m = 0; m <= last; ++m) {
      add_column(m, last, corner, z, square, point == 0, integrals);
      const Lanes factor = hn::Set(d, -1.0 / (2 * (m + 1)));
      corner = {hn::Mul(factor, hn::Sub(hn::Mul(corner.re, x), hn::Mul(corner.im, y))),
                hn::Mul(factor, hn::Add(hn::Mul(corner.re, y), hn::Mul(corner.im, x)))};
    }
  }
}

void add_edges_here(const MomentEdges& edges, int order, const GaussRule& rule, MomentSums& sums) {
  const int last = order - 1;
  const std::size_t terms = multipole_index(last, last, last) + 1;
  Integrals integrals;
  for (std::size_t lane = 0; lane < kMomentLanes; lane += hn::Lanes(d)) {
    integrate(edges, lane, last, rule, integrals);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Lanes normal = hn::Load(d, &edges.normal[axis][lane]);
      for (std::size_t term = 0; term < terms; ++term) {
        double* const re = &sums.re[axis][term][lane];
        double* const im = &sums.im[axis][term][lane];
        hn::Store(hn::Add(hn::Load(d, re), hn::Mul(normal, hn::Load(d, integrals.re[term].data()))), d, re);
        hn::Store(hn::Add(hn::Load(d, im), hn::Mul(normal, hn::Load(d, integrals.im[term].data()))), d, im);
      }
    }
  }
}

// One lane is one m.
void shift_here(const DegreeRows& shift, const DegreeRows& part, int order, DegreeRows& sums) {
  constexpr int kMiddle = DegreeRows::kMiddle;
  for (int n = 1; n <= order; ++n) {
    for (int m = 0; m <= n; m += static_cast<int>(hn::Lanes(d))) {
      Lanes re = hn::Zero(d), im = hn::Zero(d);
      for (int k = 0; k < n; ++k) {
        const auto of_shift = static_cast<std::size_t>(k), of_part = static_cast<std::size_t>(n - k);
        for (int l = std::max(-k, m - (n - k)); l <= k; ++l) {
          const int from_middle = kMiddle + l, to_middle = kMiddle + m - l;
          const auto at = static_cast<std::size_t>(from_middle), from = static_cast<std::size_t>(to_middle);
          const Lanes a_re = hn::Set(d, shift.re[of_shift][at]), a_im = hn::Set(d, shift.im[of_shift][at]);
          const Lanes b_re = hn::LoadU(d, &part.re[of_part][from]), b_im = hn::LoadU(d, &part.im[of_part][from]);
          re = hn::Add(re, hn::Sub(hn::Mul(a_re, b_re), hn::Mul(a_im, b_im)));
          im = hn::Add(im, hn::Add(hn::Mul(a_re, b_im), hn::Mul(a_im, b_re)));
        }
      }
      const int of_order = kMiddle + m;
      const auto degree = static_cast<std::size_t>(n), to = static_cast<std::size_t>(of_order);
      hn::Store(re, d, &sums.re[degree][to]);
      hn::Store(im, d, &sums.im[degree][to]);
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raycone {

MomentKernel moment_kernel(SimdLevel level) {
  return {RAYCONE_AT_LEVEL(level, add_edges_here), RAYCONE_AT_LEVEL(level, shift_here)};
}

}  // namespace raycone
#endif
