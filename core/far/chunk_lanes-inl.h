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

using Eight = std::array<double, 8>;

HWY_INLINE Lanes load(const Eight& eight, std::size_t first = 0) { return hn::Load(d, &eight[first]); }

// Before triangle n: look_at(corner) for all corners up to those of a triangle a little ahead but those `seen` before.
// Square roots take long; so they are found while other triangles are multiplied.
template <class LookAt>
HWY_INLINE void see_corners(const SharedCorners::Chunk& chunk, std::size_t n, std::size_t& seen,
                            const LookAt& look_at) {
  constexpr std::size_t kAhead = 2;
  const std::size_t known = chunk.places[std::min(n + kAhead, chunk.places.size() - 1)].known;
  for (; seen < known; ++seen) look_at(seen);
}

// A chunk as seen from a group of samples.
template <Care kCare>
class TrianglesOfChunk {
 public:
  TrianglesOfChunk(const SharedCorners::Chunk& chunk, const SampleTile& samples) : chunk_(chunk), samples_(samples) {}

  // Goes to the samples from i on.
  void begin(std::size_t i) {
    sample_ = i;
    seen_ = 0;
  }

  HWY_INLINE void see(std::size_t n) {
    see_corners(chunk_, n, seen_, [&](std::size_t corner) { look_at(corner); });
  }

  [[nodiscard]] HWY_INLINE TriangleFactors factors(std::size_t n) const {
    const SolidTriangle& t = chunk_.triangles[n];
    const auto& [a, b, c, known] = chunk_.places[n];
    const Lanes ax = load(corners_[a].x), ay = load(corners_[a].y), az = load(corners_[a].z);
    const Lanes bx = load(corners_[b].x), by = load(corners_[b].y), bz = load(corners_[b].z);
    const Lanes cx = load(corners_[c].x), cy = load(corners_[c].y), cz = load(corners_[c].z);
    const auto product = [](Lanes x, Lanes v, Lanes y, Lanes w, Lanes z, Lanes u) {
      return hn::Add(hn::Mul(x, v), hn::Add(hn::Mul(y, w), hn::Mul(z, u)));
    };
    const Lanes nx = hn::Mul(hn::Set(d, t.normal.x), ax), ny = hn::Mul(hn::Set(d, t.normal.y), ay);
    const Lanes nz = hn::Mul(hn::Set(d, t.normal.z), az);
    return factors_of<kCare>(
        t,
        {load(corners_[a].norm), load(corners_[b].norm), load(corners_[c].norm), product(ax, bx, ay, by, az, bz),
         product(bx, cx, by, cy, bz, cz), product(cx, ax, cy, ay, cz, az)},
        hn::Add(nx, hn::Add(ny, nz)), hn::Add(hn::Abs(nx), hn::Add(hn::Abs(ny), hn::Abs(nz))));
  }

 private:
  struct Corner {
    alignas(64) Eight x, y, z, norm;
  };

  HWY_INLINE void look_at(std::size_t n) {
    const Vec3& p = chunk_.corners[n];
    const Lanes x = hn::Sub(hn::Set(d, p.x), hn::Load(d, &samples_.x[sample_]));
    const Lanes y = hn::Sub(hn::Set(d, p.y), hn::Load(d, &samples_.y[sample_]));
    const Lanes z = hn::Sub(hn::Set(d, p.z), hn::Load(d, &samples_.z[sample_]));
    const Lanes square = hn::Add(hn::Mul(x, x), hn::Add(hn::Mul(y, y), hn::Mul(z, z)));
    Corner& corner = corners_[n];
    hn::Store(x, d, corner.x.data());
    hn::Store(y, d, corner.y.data());
    hn::Store(z, d, corner.z.data());
    hn::Store(hn::Sqrt(square), d, corner.norm.data());
  }

  const SharedCorners::Chunk& chunk_;
  const SampleTile& samples_;
  std::size_t sample_ = 0, seen_ = 0;
  std::array<Corner, 3 * SharedCorners::kInChunk> corners_;
};

// A chunk as seen from a tile of rows. What x contributes to a product is the same in all rows, what y and z contribute
// is one number of each: of every product one sum is left to each sample.
template <Care kCare>
class TrianglesOfRows {
 public:
  TrianglesOfRows(const SharedCorners::Chunk& chunk, const SampleTile& samples) : chunk_(chunk) {
    alignas(64) Eight ys;
    for (std::size_t row = 0; row < ys.size(); ++row) ys[row] = samples.y[std::min(8 * row, samples.count - 8)];
    for (std::size_t i = 0; i < 8; i += hn::Lanes(d)) {
      set_corners(i, hn::Load(d, &samples.x[i]), load(ys, i), samples.z[0]);
      for (std::size_t n = 0; n < chunk_.triangles.size(); ++n) set_triangle(n, i);
    }
  }

  // Goes to the samples from i on.
  void begin(std::size_t i) {
    row_ = i / 8;
    in_row_ = i % 8;
    seen_ = 0;
  }

  HWY_INLINE void see(std::size_t n) {
    see_corners(chunk_, n, seen_, [&](std::size_t corner) {
      hn::Store(hn::Sqrt(sum(corners_[corner].square)), d, norms_[corner].data());
    });
  }

  [[nodiscard]] HWY_INLINE TriangleFactors factors(std::size_t n) const {
    const auto& [a, b, c, known] = chunk_.places[n];
    const Products& p = products_[n];
    return factors_of<kCare>(chunk_.triangles[n],
                             {load(norms_[a]), load(norms_[b]), load(norms_[c]), sum(p.ab), sum(p.bc), sum(p.ca)},
                             sum(p.side), sum(p.terms));
  }

 private:
  // By x for the samples of a row, by y and z for the rows.
  struct Sum {
    alignas(64) Eight by_x, by_row;
  };
  struct Corner {
    alignas(64) Eight x, y;
    double z;
    Sum square;
  };
  struct Products {
    Sum ab, bc, ca, side, terms;
  };

  [[nodiscard]] HWY_INLINE Lanes sum(const Sum& s) const {
    return hn::Add(load(s.by_x, in_row_), hn::Set(d, s.by_row[row_]));
  }

  // Of samples and of rows from i on.
  void set_corners(std::size_t i, Lanes qx, Lanes qy, double qz) {
    for (std::size_t n = 0; n < chunk_.corners.size(); ++n) {
      const Vec3& p = chunk_.corners[n];
      Corner& corner = corners_[n];
      const Lanes x = hn::Sub(hn::Set(d, p.x), qx), y = hn::Sub(hn::Set(d, p.y), qy);
      corner.z = p.z - qz;
      hn::Store(x, d, &corner.x[i]);
      hn::Store(y, d, &corner.y[i]);
      hn::Store(hn::Mul(x, x), d, &corner.square.by_x[i]);
      hn::Store(hn::Add(hn::Mul(y, y), hn::Set(d, corner.z * corner.z)), d, &corner.square.by_row[i]);
    }
  }
  void set_triangle(std::size_t n, std::size_t i) {
    const SolidTriangle& t = chunk_.triangles[n];
    const auto& [at_a, at_b, at_c, known] = chunk_.places[n];
    const Corner &a = corners_[at_a], &b = corners_[at_b], &c = corners_[at_c];
    Products& products = products_[n];
    const auto set_product = [&](const Corner& v, const Corner& w, Sum& product) {
      hn::Store(hn::Mul(load(v.x, i), load(w.x, i)), d, &product.by_x[i]);
      hn::Store(hn::Add(hn::Mul(load(v.y, i), load(w.y, i)), hn::Set(d, v.z * w.z)), d, &product.by_row[i]);
    };
    set_product(a, b, products.ab);
    set_product(b, c, products.bc);
    set_product(c, a, products.ca);
    const Lanes nx = hn::Mul(hn::Set(d, t.normal.x), load(a.x, i));
    const Lanes ny = hn::Mul(hn::Set(d, t.normal.y), load(a.y, i)), nz = hn::Set(d, t.normal.z * a.z);
    hn::Store(nx, d, &products.side.by_x[i]);
    hn::Store(hn::Abs(nx), d, &products.terms.by_x[i]);
    hn::Store(hn::Add(ny, nz), d, &products.side.by_row[i]);
    hn::Store(hn::Add(hn::Abs(ny), hn::Abs(nz)), d, &products.terms.by_row[i]);
  }

  const SharedCorners::Chunk chunk_;
  std::size_t row_ = 0, in_row_ = 0, seen_ = 0;
  std::array<Corner, 3 * SharedCorners::kInChunk> corners_;
  alignas(64) std::array<Eight, 3 * SharedCorners::kInChunk> norms_;
  std::array<Products, SharedCorners::kInChunk> products_;
};

template <Care kCare>
HWY_INLINE TriangleFactors factors_at(TrianglesOfChunk<kCare>& triangles, const TriangleBlock&, std::size_t n) {
  triangles.see(n);
  return triangles.factors(n);
}
template <Care kCare>
HWY_INLINE TriangleFactors factors_at(TrianglesOfRows<kCare>& triangles, const TriangleBlock&, std::size_t n) {
  triangles.see(n);
  return triangles.factors(n);
}

// As multiply_block<true>(), for triangles that look small from all samples. Their arguments are below 0.28
// (looks_small_from()), so those of a block sum to less than pi: to the argument of the block's product, which is all
// that is seen to pass the real axis.
template <class Views>
HWY_INLINE void multiply_small_block(ProductTile& products, const TriangleBlock& block, Views& views, LaneMask active) {
  static_assert(kFactorsPerBlock * 0.28 < 3.14);
  auto [re, im, trusted] = factors_at(views, block, block.begin);
  for (std::size_t n = block.begin + 1; n < block.end; ++n) {
    const TriangleFactors f = factors_at(views, block, n);
    const Lanes next = hn::Sub(hn::Mul(re, f.re), hn::Mul(im, f.im));
    im = hn::Add(hn::Mul(re, f.im), hn::Mul(im, f.re));
    re = next;
  }
  const ProductLanes z = times(load(products, block.i), re, im, hn::CopySignToAbs(hn::Set(d, 1.0), im));
  finish_block(products, block, views, active, z, active);
}

// How triangles of a chunk are multiplied.
enum class Looks {
  kLarge,         // each is looked at
  kSmall,         // they look small from the samples at hand: with the same bits
  kSmallFromAll,  // from all samples that the chunk is ever seen from: with other bits
};

// Multiplies the factors of a chunk onto the products of those of the samples from i on that are `active`.
template <class Views>
HWY_INLINE void multiply_chunk(ProductTile& products, const SharedCorners::Chunk& chunk, Views& views,
                               const SampleTile& samples, std::size_t i, LaneMask active, Looks looks) {
  views.begin(i);
  for (std::size_t begin = 0; begin < chunk.triangles.size(); begin += kFactorsPerBlock) {
    const TriangleBlock block{chunk.triangles, begin, std::min(begin + kFactorsPerBlock, chunk.triangles.size()),
                              samples, i};
    switch (looks) {
      case Looks::kLarge:
        multiply_block(products, block, views, active);
        break;
      case Looks::kSmall:
        multiply_block<true>(products, block, views, active);
        break;
      case Looks::kSmallFromAll:
        multiply_small_block(products, block, views, active);
        break;
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#endif  // RAYCONE_CORE_CHUNK_LANES_INL_H_
