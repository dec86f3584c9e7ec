#include "core/evaluation/gradient_kernel.h"

#include <array>
#include <cstddef>
#include <cstdint>

// Highway compiles what is between its markers once per SIMD level.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/evaluation/gradient_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/machine/simd_kernel.h"
#include "core/machine/vector_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

constexpr double kLeast = 0x1p-200, kMost = 0x1p200;  // of squares: products of four lengths are in range
constexpr double kNear = 0x1p-16;                     // of a sine's square: the cross product loses eight bits

// An end of a segment as samples see it.
struct End {
  VectorLanes at;
  Lanes square, length;

  HWY_INLINE End(const Vec3& p, const VectorLanes& q)
      : at(minus(in_all_lanes(p), q)), square(dot(at, at)), length(hn::Sqrt(square)) {}
};

// What a segment adds, and where doubles hold that.
struct Part {
  VectorLanes vector;
  LaneMask sure;
};

// (a x b) (|a| + |b|) / (|a| |b| (|a| |b| + a b)) for the ends a, b. Where the angle between them is obtuse, the last
// factor is |a x b|^2 / (|a| |b| - a b).
HWY_INLINE Part part_of(const GradientSegment& segment, const End& a, const End& b) {
  const VectorLanes step = in_all_lanes(segment.step);
  const VectorLanes normal = cross(if_then_else(hn::Lt(a.square, b.square), a.at, b.at), step);
  const Lanes least = hn::Min(a.square, b.square), most = hn::Max(a.square, b.square);
  const Lanes square = dot(normal, normal), step_square = dot(step, step), ab = dot(a.at, b.at);
  const LaneMask in_range = hn::And(hn::Ge(hn::Min(least, step_square), hn::Set(d, kLeast)),
                                    hn::Le(hn::Max(most, step_square), hn::Set(d, kMost)));
  const Lanes lengths = hn::Mul(a.length, b.length), sum = hn::Add(a.length, b.length);
  const LaneMask is_obtuse = hn::Lt(ab, hn::Zero(d));
  const Lanes above = hn::IfThenElse(is_obtuse, hn::Mul(sum, hn::Sub(lengths, ab)), sum);
  const Lanes below = hn::Mul(lengths, hn::IfThenElse(is_obtuse, square, hn::Add(lengths, ab)));
  const Lanes factor = hn::Div(hn::Mul(hn::Set(d, segment.weight), above), below);
  return {times(factor, normal),
          hn::And(in_range, hn::Ge(square, hn::Mul(hn::Set(d, kNear), hn::Mul(least, step_square))))};
}

// Of some samples.
class Sums {
 public:
  HWY_INLINE Sums() : sums_(in_all_lanes({})) {}

  HWY_INLINE void add(const Part& part) { sums_ = plus(sums_, if_then_else_zero(part.sure, part.vector)); }

  // part(lane) is added to the lanes that are not sure.
  template <class CarefulPart>
  HWY_NOINLINE void add_carefully(LaneMask sure, const CarefulPart& part) {
    const std::uint32_t bits = bits_of(sure);
    alignas(64) std::array<double, hn::MaxLanes(d)> x, y, z;
    store(x.data(), y.data(), z.data());
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
      if ((bits >> lane & 1U) != 0) continue;
      const Vec3 more = part(lane);
      x[lane] += more.x;
      y[lane] += more.y;
      z[lane] += more.z;
    }
    sums_ = {hn::Load(d, x.data()), hn::Load(d, y.data()), hn::Load(d, z.data())};
  }

  HWY_INLINE void store(double* x, double* y, double* z) const {
    hn::Store(sums_.x, d, x);
    hn::Store(sums_.y, d, y);
    hn::Store(sums_.z, d, z);
  }

 private:
  VectorLanes sums_;
};

void sum_parts_here(std::span<const GradientSegment> segments, const SampleTile& samples,
                    Vec3 (*careful_part)(const GradientSegment& segment, const Vec3& q), GradientTile& sums) {
  for (std::size_t i = 0; i < samples.count; i += hn::Lanes(d)) {
    const VectorLanes q{hn::Load(d, &samples.x[i]), hn::Load(d, &samples.y[i]), hn::Load(d, &samples.z[i])};
    Sums here;
    End last(segments.empty() ? Vec3{} : segments.front().from, q);
    for (const GradientSegment& segment : segments) {
      if (!segment.joined) last = End(segment.from, q);
      const End next(segment.to, q);
      const Part part = part_of(segment, last, next);
      here.add(part);
      if (HWY_UNLIKELY(!hn::AllTrue(d, part.sure))) {
        here.add_carefully(part.sure, [&](std::size_t lane) { return careful_part(segment, samples.query(i + lane)); });
      }
      last = next;
    }
    here.store(&sums.x[i], &sums.y[i], &sums.z[i]);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raycone {

GradientKernel gradient_kernel(SimdLevel level) { return RAYCONE_AT_LEVEL(level, sum_parts_here); }

}  // namespace raycone
#endif
