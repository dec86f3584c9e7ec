// Triangles with shared corners in SIMD lanes, one per sample: what kernels share. Included once per SIMD level.
#if defined(RAYCONE_CORE_CHUNK_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYCONE_CORE_CHUNK_LANES_INL_H_
#undef RAYCONE_CORE_CHUNK_LANES_INL_H_
#else
#define RAYCONE_CORE_CHUNK_LANES_INL_H_
#endif

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/boundary/triangle_lanes-inl.h"
#include "core/far/shared_corners.h"

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

// Multiplies the factors of a chunk onto the products of those of the samples from i on that are `active`.
HWY_INLINE void multiply_chunk(ProductTile& products, const SharedCorners::Chunk& chunk, const SampleTile& samples,
                               std::size_t i, hn::Mask<Doubles> active) {
  TrianglesOfChunk views(chunk, samples);
  views.begin(i);
  for (std::size_t begin = 0; begin < chunk.triangles.size(); begin += kFactorsPerBlock) {
    multiply_block(products, chunk.triangles, views, samples, i, begin,
                   std::min(begin + kFactorsPerBlock, chunk.triangles.size()), active);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#endif  // RAYCONE_CORE_CHUNK_LANES_INL_H_
