#include "core/far/shared_corners.h"

#include <algorithm>
#include <utility>

// Highway compiles what is between its markers once per SIMD level.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/far/shared_corners.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/boundary/triangle_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

// A chunk as seen from a group of samples.
class TrianglesOfChunk {
 public:
  TrianglesOfChunk(const SharedCorners::Chunk& chunk, const SampleTile& samples) : chunk_(chunk), samples_(samples) {}

  // Looks at the corners from the samples from i on.
  void begin(std::size_t i) {
    const Lanes qx = hn::Load(d, &samples_.x[i]), qy = hn::Load(d, &samples_.y[i]), qz = hn::Load(d, &samples_.z[i]);
    for (std::size_t n = 0; n < chunk_.corners.size(); ++n) {
      const Vec3& p = chunk_.corners[n];
      const Lanes x = hn::Sub(hn::Set(d, p.x), qx), y = hn::Sub(hn::Set(d, p.y), qy);
      const Lanes z = hn::Sub(hn::Set(d, p.z), qz);
      const Lanes square = hn::Add(hn::Mul(x, x), hn::Add(hn::Mul(y, y), hn::Mul(z, z)));
      Corner& corner = corners_[n];
      hn::Store(x, d, corner.x.data());
      hn::Store(y, d, corner.y.data());
      hn::Store(z, d, corner.z.data());
      hn::Store(hn::Sqrt(square), d, corner.norm.data());
    }
  }

  [[nodiscard]] HWY_INLINE TriangleFactors factors(std::size_t n) const {
    const SolidTriangle& t = chunk_.triangles[n];
    const auto& [a, b, c] = chunk_.places[n];
    const Lanes ax = load(corners_[a].x), ay = load(corners_[a].y), az = load(corners_[a].z);
    const Lanes bx = load(corners_[b].x), by = load(corners_[b].y), bz = load(corners_[b].z);
    const Lanes cx = load(corners_[c].x), cy = load(corners_[c].y), cz = load(corners_[c].z);
    const auto product = [](Lanes x, Lanes v, Lanes y, Lanes w, Lanes z, Lanes u) {
      return hn::Add(hn::Mul(x, v), hn::Add(hn::Mul(y, w), hn::Mul(z, u)));
    };
    const Lanes nx = hn::Mul(hn::Set(d, t.normal.x), ax), ny = hn::Mul(hn::Set(d, t.normal.y), ay);
    const Lanes nz = hn::Mul(hn::Set(d, t.normal.z), az);
    return factors_of(
        t,
        {load(corners_[a].norm), load(corners_[b].norm), load(corners_[c].norm), product(ax, bx, ay, by, az, bz),
         product(bx, cx, by, cy, bz, cz), product(cx, ax, cy, ay, cz, az)},
        hn::Add(nx, hn::Add(ny, nz)), hn::Add(hn::Abs(nx), hn::Add(hn::Abs(ny), hn::Abs(nz))));
  }

 private:
  using Eight = std::array<double, 8>;
  struct Corner {
    alignas(64) Eight x, y, z, norm;
  };
  static HWY_INLINE Lanes load(const Eight& eight) { return hn::Load(d, eight.data()); }

  const SharedCorners::Chunk& chunk_;
  const SampleTile& samples_;
  std::array<Corner, 3 * SharedCorners::kInChunk> corners_;
};

HWY_INLINE TriangleFactors factors_at(const TrianglesOfChunk& triangles, const SolidTriangle&, std::size_t n,
                                      const SampleTile&, std::size_t) {
  return triangles.factors(n);
}

void multiply_chunks_here(const SharedCorners& triangles, const SampleTile& samples, ProductTile& products) {
  set_ones(products);
  const auto every = hn::FirstN(d, hn::Lanes(d));
  for (std::size_t n = 0; n < triangles.chunks(); ++n) {
    const SharedCorners::Chunk chunk = triangles.chunk(n);
    TrianglesOfChunk views(chunk, samples);
    for (std::size_t i = 0; i < samples.count; i += hn::Lanes(d)) {
      views.begin(i);
      for (std::size_t begin = 0; begin < chunk.triangles.size(); begin += kFactorsPerBlock) {
        multiply_block(products, chunk.triangles, views, samples, i, begin,
                       std::min(begin + kFactorsPerBlock, chunk.triangles.size()), every);
      }
    }
  }
  set_arguments(products, samples.count);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raycone {

SharedCornersKernel shared_corners_kernel([[maybe_unused]] SimdLevel level) {
#if HWY_ARCH_X86
  const SimdLevel available = available_level(level);
  if (available == SimdLevel::kAvx512) return HWY_CHOOSE_AVX3(multiply_chunks_here);
  if (available == SimdLevel::kAvx2) return HWY_CHOOSE_AVX2(multiply_chunks_here);
  if (available == SimdLevel::kSse4) return HWY_CHOOSE_SSE4(multiply_chunks_here);
#endif
  return &HWY_STATIC_DISPATCH(multiply_chunks_here);
}

SharedCorners::SharedCorners(std::vector<SolidTriangle> triangles) : triangles_(std::move(triangles)) {
  places_.reserve(triangles_.size());
  for (std::size_t n = 0; n < triangles_.size(); ++n) {
    if (n % kInChunk == 0 && n > 0) corners_begin_.push_back(corners_.size());
    const auto place_of = [&](const Vec3& corner) {
      const std::size_t begin = corners_begin_.back();
      std::size_t place = corners_.size();
      while (place > begin && corners_[place - 1] != corner) --place;  // the latest are the likeliest
      if (place > begin) return static_cast<std::uint8_t>(place - 1 - begin);
      corners_.push_back(corner);
      return static_cast<std::uint8_t>(corners_.size() - 1 - begin);
    };
    const SolidTriangle& t = triangles_[n];
    const std::uint8_t a = place_of(t.a), b = place_of(t.b), c = place_of(t.c);
    places_.push_back({a, b, c});
  }
  if (!triangles_.empty()) corners_begin_.push_back(corners_.size());
}

SharedCorners::Chunk SharedCorners::chunk(std::size_t n) const {
  const std::size_t begin = n * kInChunk, count = std::min(kInChunk, triangles_.size() - begin);
  return {std::span(triangles_).subspan(begin, count), std::span(places_).subspan(begin, count),
          std::span(corners_).subspan(corners_begin_[n], corners_begin_[n + 1] - corners_begin_[n])};
}

}  // namespace raycone
#endif
