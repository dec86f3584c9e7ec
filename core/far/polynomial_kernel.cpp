#include "core/far/polynomial_kernel.h"

#include <array>
#include <cstddef>

// Highway compiles what is between its markers once per SIMD level.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/far/polynomial_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/machine/lanes-inl.h"
#include "core/machine/simd_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

// Groups of lanes that go through the coefficients together, so that sums need not wait for one another.
template <std::size_t kGroups>
using Together = std::array<Lanes, kGroups>;

// T_0, T_1, ... of one coordinate of some samples.
template <std::size_t kGroups>
class Chebyshev {
 public:
  HWY_INLINE Chebyshev(std::size_t degree, const double* coordinates, double centre, double half) {
    for (std::size_t g = 0; g < kGroups; ++g) {
      const Lanes q = hn::Load(d, coordinates + g * hn::Lanes(d));
      const Lanes x = hn::Div(hn::Sub(q, hn::Set(d, centre)), hn::Set(d, half));
      const Lanes twice = hn::Add(x, x);
      Lanes before = x, here = hn::Set(d, 1.0);  // T_{-1} = T_1
      for (std::size_t n = 0; n <= degree; ++n) {
        hn::Store(here, d, &numbers_[(n * kGroups + g) * hn::Lanes(d)]);
        const Lanes next = hn::Sub(hn::Mul(twice, here), before);
        before = here;
        here = next;
      }
    }
  }
  // sum += factor * T_n
  HWY_INLINE void add(Together<kGroups>& sum, const Together<kGroups>& factor, std::size_t n) const {
    for (std::size_t g = 0; g < kGroups; ++g) {
      const Lanes t = hn::Load(d, &numbers_[(n * kGroups + g) * hn::Lanes(d)]);
      sum[g] = hn::Add(sum[g], hn::Mul(factor[g], t));
    }
  }

 private:
  alignas(64) std::array<double, kTerms * kGroups * 8> numbers_;
};

template <std::size_t kGroups>
HWY_INLINE Together<kGroups> all_lanes(double value) {
  Together<kGroups> all;
  all.fill(hn::Set(d, value));
  return all;
}

// At the samples from i on.
template <std::size_t kGroups>
HWY_INLINE void evaluate_groups(const Coefficients& polynomial, std::size_t degree, const Cube& cube,
                                const SampleTile& samples, std::size_t i, Tile& values) {
  const Chebyshev<kGroups> tx(degree, &samples.x[i], cube.centre.x, cube.half);
  const Chebyshev<kGroups> ty(degree, &samples.y[i], cube.centre.y, cube.half);
  const Chebyshev<kGroups> tz(degree, &samples.z[i], cube.centre.z, cube.half);
  Together<kGroups> all = all_lanes<kGroups>(0.0);
  for (std::size_t k = 0; k <= degree; ++k) {
    Together<kGroups> layer = all_lanes<kGroups>(0.0);
    for (std::size_t j = 0; j + k <= degree; ++j) {
      const double* const coefficients = &polynomial[kRows.begin(j, k)];
      Together<kGroups> row = all_lanes<kGroups>(0.0);
      for (std::size_t n = 0; n + j + k <= degree; ++n) tx.add(row, all_lanes<kGroups>(coefficients[n]), n);
      ty.add(layer, row, j);
    }
    tz.add(all, layer, k);
  }
  for (std::size_t g = 0; g < kGroups; ++g) hn::Store(all[g], d, &values[i + g * hn::Lanes(d)]);
}

void evaluate_here(const Coefficients& polynomial, std::size_t degree, const Cube& cube, const SampleTile& samples,
                   Tile& values) {
  const std::size_t end = padded_to_lanes(samples.count), lanes = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + 4 * lanes <= end; i += 4 * lanes) evaluate_groups<4>(polynomial, degree, cube, samples, i, values);
  for (; i + 2 * lanes <= end; i += 2 * lanes) evaluate_groups<2>(polynomial, degree, cube, samples, i, values);
  for (; i < end; i += lanes) evaluate_groups<1>(polynomial, degree, cube, samples, i, values);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raycone {

PolynomialKernel polynomial_kernel(SimdLevel level) { return RAYCONE_AT_LEVEL(level, evaluate_here); }

}  // namespace raycone
#endif
