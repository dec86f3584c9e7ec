#include "core/boundary/cone_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/boundary/edge_factor.h"
#include "core/boundary/near_edge.h"
#include "core/exact/predicates.h"

// Highway compiles what is between its markers once per SIMD level.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/boundary/cone_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/boundary/product_lanes-inl.h"
#include "core/machine/simd_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

// An edge is taken with care where |P|^2 of an end is beyond these bounds. Within them s_a s_b is at least 2^-100, so a
// factor that is not near its edge is above 2^-108, and the product of a block cannot underflow.
constexpr double kSmallestSquare = 0x1p-50;
constexpr double kLargestSquare = 0x1p800;

// |P|^2, NaN where it is too small or large.
HWY_INLINE Lanes square_of(Lanes y, Lanes z) {
  const Lanes square = hn::Add(hn::Mul(y, y), hn::Mul(z, z));
  const auto ordinary =
      hn::And(hn::Gt(square, hn::Set(d, kSmallestSquare)), hn::Lt(square, hn::Set(d, kLargestSquare)));
  return hn::IfThenElse(ordinary, square, hn::NaN(d));
}

// What the projections along the rays say about an edge: P_a . P_b, and D times the orientation, NaN where the sign of
// D is in doubt; and that sign as +-1, the direction in which the factor turns.
struct ProjectedEdge {
  Lanes re, im, direction;
};

// The projection of a vertex.
struct ProjectedVertex {
  Lanes y, z;
  Lanes square;  // square_of(y, z)
};

// The edge determinant as in predicates.h: from the nearer end, and trusted beyond its error. (dy, dz) is the edge.
HWY_INLINE ProjectedEdge project(const ProjectedVertex& a, const ProjectedVertex& b, Lanes dy, Lanes dz,
                                 Lanes orientation) {
  const auto a_is_nearer = hn::Le(a.square, b.square);
  const Lanes left = hn::Mul(hn::IfThenElse(a_is_nearer, a.y, b.y), dz);
  const Lanes right = hn::Mul(hn::IfThenElse(a_is_nearer, a.z, b.z), dy);
  const Lanes determinant = hn::Sub(left, right);
  const Lanes doubt =
      hn::Add(hn::Mul(hn::Set(d, kSideFilter), hn::Add(hn::Abs(left), hn::Abs(right))), hn::Set(d, kSideUnderflow));
  const auto sure = hn::Gt(hn::Abs(determinant), doubt);
  const Lanes im = hn::Mul(determinant, orientation);
  return {hn::Add(hn::Mul(a.y, b.y), hn::Mul(a.z, b.z)), hn::IfThenElse(sure, im, hn::NaN(d)),
          hn::CopySignToAbs(hn::Set(d, 1.0), im)};
}

// Steps that are taken together, sample by sample: edge n leads from vertex n to vertex n + 1. What is kept of them for
// a few samples fits the first-level cache.
constexpr std::size_t kEdgesPerChunk = 64;
using Column = std::array<double, kEdgesPerChunk + 8>;  // room for one vertex more, and for lanes beyond the last one

struct Chunk {
  Column x, y, z;
  Column dy, dz;       // of edges
  Column orientation;  // of edges: +1, -1 if reversed, 0 where there is none
  std::size_t edges;

  Chunk(const Vec3& from, std::span<const ChainStep> steps)
      : x{}, y{}, z{}, dy{}, dz{}, orientation{}, edges(steps.size()) {
    set_vertex(0, from);
    for (std::size_t n = 0; n < edges; ++n) {
      set_vertex(n + 1, steps[n].to);
      dy[n] = y[n + 1] - y[n];
      dz[n] = z[n + 1] - z[n];
      if (steps[n].joined) orientation[n] = steps[n].reversed ? -1.0 : 1.0;
    }
  }
  void set_vertex(std::size_t n, const Vec3& v) {
    x[n] = v.x;
    y[n] = v.y;
    z[n] = v.z;
  }
  [[nodiscard]] Vec3 vertex(std::size_t n) const { return {x[n], y[n], z[n]}; }
};

EdgeSide side_of(const Chunk& chunk, std::size_t n, const Vec3& q) {
  return edge_side(chunk.vertex(n), chunk.vertex(n + 1), q);
}

// One value per vertex of a chunk and lane.
using LaneColumn = std::array<double, (kEdgesPerChunk + 1) * 8>;
HWY_INLINE void store(Lanes value, LaneColumn& column, std::size_t n) {
  hn::Store(value, d, &column[n * hn::Lanes(d)]);
}
HWY_INLINE Lanes load(const LaneColumn& column, std::size_t n) { return hn::Load(d, &column[n * hn::Lanes(d)]); }

// The projections of a chunk along the one ray that all samples share: the lanes can be vertices and edges.
class EdgesOfOneRay {
 public:
  EdgesOfOneRay(const Chunk& chunk, const SampleTile& samples) : chunk_(chunk), y_{}, z_{}, square_{} {
    for (std::size_t n = 0; n <= chunk.edges; n += hn::Lanes(d)) {
      const Lanes y = hn::Sub(hn::LoadU(d, &chunk.y[n]), hn::Set(d, samples.y[0]));
      const Lanes z = hn::Sub(hn::LoadU(d, &chunk.z[n]), hn::Set(d, samples.z[0]));
      hn::StoreU(y, d, &y_[n]);
      hn::StoreU(z, d, &z_[n]);
      hn::StoreU(square_of(y, z), d, &square_[n]);
    }
    for (std::size_t n = 0; n < chunk.edges; n += hn::Lanes(d)) {
      const ProjectedEdge edge = project(projected(n), projected(n + 1), hn::LoadU(d, &chunk.dy[n]),
                                         hn::LoadU(d, &chunk.dz[n]), hn::LoadU(d, &chunk.orientation[n]));
      hn::StoreU(edge.re, d, &re_[n]);
      hn::StoreU(edge.im, d, &im_[n]);
      hn::StoreU(edge.direction, d, &direction_[n]);
    }
    for (std::size_t n = 0; n < chunk.edges; ++n) {
      if (chunk.orientation[n] != 0.0 && std::isnan(im_[n]))
        sides_[n] = side_of(chunk, n, {samples.x[0], samples.y[0], samples.z[0]});
    }
  }

  // The projections of vertices for a group of samples, beyond what all samples share.
  struct Projections {};
  // Projects vertex n for the samples from i on, and returns its |P|^2.
  [[nodiscard]] Lanes project_vertex(std::size_t n, std::size_t, Projections&) const { return hn::Set(d, square_[n]); }
  // Edge n, whose ends have been projected.
  [[nodiscard]] ProjectedEdge edge(std::size_t n, const Projections&) const {
    return {hn::Set(d, re_[n]), hn::Set(d, im_[n]), hn::Set(d, direction_[n])};
  }
  // That of edge n, exact.
  [[nodiscard]] EdgeSide side(std::size_t n, const Vec3& q) const {
    return std::isnan(im_[n]) ? sides_[n] : side_of(chunk_, n, q);
  }

 private:
  [[nodiscard]] ProjectedVertex projected(std::size_t n) const {
    return {hn::LoadU(d, &y_[n]), hn::LoadU(d, &z_[n]), hn::LoadU(d, &square_[n])};
  }

  const Chunk& chunk_;
  Column y_, z_, square_;
  Column re_, im_, direction_;
  std::array<EdgeSide, kEdgesPerChunk> sides_;  // where Im z is NaN
};

// The same for samples with a ray each.
class EdgesOfRays {
 public:
  EdgesOfRays(const Chunk& chunk, const SampleTile& samples) : chunk_(chunk), samples_(samples) {}

  struct Projections {
    alignas(64) LaneColumn y, z, square;
    [[nodiscard]] ProjectedVertex vertex(std::size_t n) const { return {load(y, n), load(z, n), load(square, n)}; }
  };
  [[nodiscard]] Lanes project_vertex(std::size_t n, std::size_t i, Projections& projections) const {
    const Lanes y = hn::Sub(hn::Set(d, chunk_.y[n]), hn::Load(d, &samples_.y[i]));
    const Lanes z = hn::Sub(hn::Set(d, chunk_.z[n]), hn::Load(d, &samples_.z[i]));
    const Lanes square = square_of(y, z);
    store(y, projections.y, n);
    store(z, projections.z, n);
    store(square, projections.square, n);
    return square;
  }
  [[nodiscard]] ProjectedEdge edge(std::size_t n, const Projections& projections) const {
    return project(projections.vertex(n), projections.vertex(n + 1), hn::Set(d, chunk_.dy[n]), hn::Set(d, chunk_.dz[n]),
                   hn::Set(d, chunk_.orientation[n]));
  }
  [[nodiscard]] EdgeSide side(std::size_t n, const Vec3& q) const { return side_of(chunk_, n, q); }

 private:
  const Chunk& chunk_;
  const SampleTile& samples_;
};

// The vertices of a chunk as seen from a group of samples: s = |p| - p_x as fractions s / t, t > 0. For p_x > 0, where
// s = |P|^2 / (|p| + p_x), that saves the division. NaN where |P|^2 is.
template <class Rays>
struct ChunkView {
  alignas(64) LaneColumn s, t;
  typename Rays::Projections projections;

  // Vertex n, from the samples from i on.
  void set_vertex(const Chunk& chunk, const Rays& rays, const SampleTile& samples, std::size_t n, std::size_t i) {
    const Lanes square = rays.project_vertex(n, i, projections);
    const Lanes px = hn::Sub(hn::Set(d, chunk.x[n]), hn::Load(d, &samples.x[i]));
    const Lanes sum = hn::Add(hn::Sqrt(hn::Add(hn::Mul(px, px), square)), hn::Abs(px));
    store(hn::IfNegativeThenElse(px, sum, square), s, n);
    store(hn::IfNegativeThenElse(px, hn::Set(d, 1.0), sum), t, n);
  }
};

// Lanes of the factor z_ab t_a t_b of an edge, whose argument is that of z_ab.
struct EdgeFactors {
  Lanes re, im;
  Lanes direction;  // the sign of im as +-1
  Lanes product_of_s;
};

template <class Rays>
HWY_INLINE EdgeFactors factors_of(const Rays& rays, const ChunkView<Rays>& view, std::size_t n) {
  const ProjectedEdge edge = rays.edge(n, view.projections);
  const Lanes product_of_s = hn::Mul(load(view.s, n), load(view.s, n + 1));
  const Lanes product_of_t = hn::Mul(load(view.t, n), load(view.t, n + 1));
  return {hn::Add(product_of_s, hn::Mul(product_of_t, edge.re)), hn::Mul(product_of_t, edge.im), edge.direction,
          product_of_s};
}

HWY_INLINE Lanes magnitude(const EdgeFactors& f) { return hn::Add(hn::Abs(f.re), hn::Abs(f.im)); }

// Not near the edge; false where anything is NaN.
HWY_INLINE hn::Mask<Doubles> is_not_near(const EdgeFactors& f) {
  return hn::Gt(magnitude(f), hn::Mul(hn::Set(d, kNearEdge), f.product_of_s));
}

// A few edges of a chunk.
struct EdgeRange {
  std::size_t begin, end;
};

// What multiply_block() does, factor by factor, for those of the samples from i on whose bit in `trusted` is not set.
template <class Rays>
HWY_NOINLINE void multiply_carefully(ProductTile& products, const Chunk& chunk, const Rays& rays,
                                     const SampleTile& samples, std::size_t i, const ChunkView<Rays>& view,
                                     const EdgeRange& block, std::uint64_t trusted) {
  for (std::size_t n = block.begin; n < block.end; ++n) {
    if (chunk.orientation[n] == 0.0) continue;
    const EdgeFactors factors = factors_of(rays, view, n);
    const auto in_range = hn::And(hn::Gt(magnitude(factors), hn::Set(d, kSmallestFactor)),
                                  hn::Lt(magnitude(factors), hn::Set(d, kLargestFactor)));
    alignas(64) std::array<double, 8> re, im;
    hn::Store(factors.re, d, re.data());
    hn::Store(factors.im, d, im.data());
    const std::uint64_t plain = bits_of(hn::And(is_not_near(factors), in_range));
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
      const Vec3 q = samples.query(i + lane);
      if ((trusted >> lane) & 1U) continue;
      if ((plain >> lane) & 1U) {
        multiply_one(products, i + lane, re[lane], im[lane]);
      } else if (const auto f = edge_factor(chunk.vertex(n), chunk.vertex(n + 1), chunk.orientation[n] < 0.0, q,
                                            rays.side(n, q))) {
        multiply_one(products, i + lane, f->re, f->im);
      }
    }
  }
}

// Multiplies the factors of a block onto the products of the samples from i on, and views its vertices from the
// samples at `next`: their square roots fill the time that products wait for one another.
template <class Rays>
HWY_INLINE void multiply_block(ProductTile& products, const Chunk& chunk, const Rays& rays, const SampleTile& samples,
                               std::size_t i, const ChunkView<Rays>& view, std::size_t next, ChunkView<Rays>& next_view,
                               const EdgeRange& block) {
  ProductLanes z = load(products, i);
  auto trusted = hn::Eq(z.re, z.re);  // all
  for (std::size_t n = block.begin; n < block.end; ++n) {
    next_view.set_vertex(chunk, rays, samples, n + 1, next);
    if (chunk.orientation[n] == 0.0) continue;
    const EdgeFactors factors = factors_of(rays, view, n);
    trusted = hn::And(trusted, is_not_near(factors));
    z = times(z, factors.re, factors.im, factors.direction);
  }
  trusted = hn::And(trusted, is_sound(z));
  if (HWY_LIKELY(hn::AllTrue(d, trusted))) {
    store(scaled(z), products, i);
  } else {
    multiply_carefully(products, chunk, rays, samples, i, view, block, bits_of(trusted));
    store_trusted(z, trusted, products, i);
  }
}

template <class Rays>
void multiply_chunk(ProductTile& products, const Chunk& chunk, const SampleTile& samples) {
  const Rays rays(chunk, samples);
  std::array<ChunkView<Rays>, 2> views;  // of the samples at hand and of the next ones, in turns
  for (std::size_t n = 0; n <= chunk.edges; ++n) views[0].set_vertex(chunk, rays, samples, n, 0);
  std::size_t here = 0;
  for (std::size_t i = 0; i < samples.count; i += hn::Lanes(d)) {
    const std::size_t next = i + hn::Lanes(d) < samples.count ? i + hn::Lanes(d) : i;
    views[1 - here].set_vertex(chunk, rays, samples, 0, next);
    for (std::size_t begin = 0; begin < chunk.edges; begin += kFactorsPerBlock) {
      multiply_block(products, chunk, rays, samples, i, views[here], next, views[1 - here],
                     {begin, std::min(begin + kFactorsPerBlock, chunk.edges)});
    }
    here = 1 - here;
  }
}

template <class Rays>
void multiply_all(std::span<const ChainStep> steps, const SampleTile& samples, ProductTile& products) {
  set_ones(products);
  for (std::size_t begin = 0; begin < steps.size(); begin += kEdgesPerChunk) {
    const Vec3& from = steps[begin > 0 ? begin - 1 : 0].to;
    const Chunk chunk(from, steps.subspan(begin, std::min(kEdgesPerChunk, steps.size() - begin)));
    multiply_chunk<Rays>(products, chunk, samples);
  }
  set_arguments(products, samples.count);
}

void multiply_chains_here(std::span<const ChainStep> steps, const SampleTile& samples, ProductTile& products) {
  if (samples.share_a_ray()) {
    multiply_all<EdgesOfOneRay>(steps, samples, products);
  } else {
    multiply_all<EdgesOfRays>(steps, samples, products);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raycone {

ConeKernel cone_kernel(SimdLevel level) { return RAYCONE_AT_LEVEL(level, multiply_chains_here); }

}  // namespace raycone
#endif
