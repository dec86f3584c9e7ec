#include "core/boundary/cone_kernel.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/boundary/edge_factor.h"
#include "core/boundary/near_edge.h"

// Highway compiles what is between its markers once per SIMD level.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/boundary/cone_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/boundary/edge_lanes-inl.h"
#include "core/machine/simd_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

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
HWY_INLINE LaneMask is_not_near(const EdgeFactors& f) {
  return hn::Gt(magnitude(f), hn::Mul(hn::Set(d, kNearEdge), f.product_of_s));
}

template <class Rays>
struct ProjectedChunk {
  Chunk chunk;
  Rays rays;

  ProjectedChunk(const Vec3& from, std::span<const ChainStep> steps, const SampleTile& samples)
      : chunk(from, steps), rays(chunk, samples) {}
};

// A chunk and the samples from i on, whose products it is multiplied onto.
template <class Rays>
struct Stage {
  const ProjectedChunk<Rays>& of;
  std::size_t i;
  ChunkView<Rays>& view;

  HWY_INLINE void view_vertex(const SampleTile& samples, std::size_t n) const {
    view.set_vertex(of.chunk, of.rays, samples, n, i);
  }
};

// A few edges of a chunk.
struct EdgeRange {
  std::size_t begin, end;
};

// A product, and the lanes where it is right.
struct Trial {
  ProductLanes z;
  LaneMask trusted;
};

// What multiply_block() multiplies, but at each of the samples without the edges that have no factor there. In a tile
// of one ray these are not even tried, and a value must not depend on the other samples of its tile.
template <class Rays>
HWY_INLINE Trial product_without_level_edges(const ProductTile& products, const Stage<Rays>& stage,
                                             const EdgeRange& block) {
  const auto& [of, i, view] = stage;
  const Rays& rays = of.rays;
  Trial trial{load(products, i), hn::FirstN(d, hn::Lanes(d))};
  ProductLanes& z = trial.z;
  for (std::size_t n = block.begin; n < block.end; ++n) {
    if (rays.is_without_factor(n, i)) continue;
    const LaneMask none = rays.without_factor(n, view.projections);
    const EdgeFactors factors = factors_of(rays, view, n);
    trial.trusted = hn::And(trial.trusted, hn::Or(none, is_not_near(factors)));
    const ProductLanes next = times(z, factors.re, factors.im, factors.direction);
    z = {hn::IfThenElse(none, z.re, next.re), hn::IfThenElse(none, z.im, next.im),
         hn::IfThenElse(none, z.passages, next.passages)};
  }
  trial.trusted = hn::And(trial.trusted, is_sound(z));
  return trial;
}

// What multiply_block() does, factor by factor, for those of the samples whose bit in `trusted` is not set.
template <class Rays>
HWY_NOINLINE void multiply_carefully(ProductTile& products, const SampleTile& samples, const Stage<Rays>& stage,
                                     const EdgeRange& block, std::uint64_t trusted) {
  const auto& [of, i, view] = stage;
  const auto& [chunk, rays] = of;
  for (std::size_t n = block.begin; n < block.end; ++n) {
    if (rays.is_without_factor(n, i)) continue;
    const EdgeFactors factors = factors_of(rays, view, n);
    const auto in_range = hn::And(hn::Gt(magnitude(factors), hn::Set(d, kSmallestFactor)),
                                  hn::Lt(magnitude(factors), hn::Set(d, kLargestFactor)));
    alignas(64) std::array<double, 8> re, im;
    hn::Store(factors.re, d, re.data());
    hn::Store(factors.im, d, im.data());
    const std::uint64_t plain = bits_of(hn::And(is_not_near(factors), in_range));
    const std::uint64_t done = trusted | bits_of(rays.without_factor(n, view.projections));
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
      const Vec3 q = samples.query(i + lane);
      if ((done >> lane) & 1U) continue;
      if ((plain >> lane) & 1U) {
        multiply_one(products, i + lane, re[lane], im[lane]);
      } else if (const auto f = edge_factor(chunk.vertex(n), chunk.vertex(n + 1), q, rays.side(n, q))) {
        multiply_one(products, i + lane, f->re, chunk.orientation[n] * f->im);
      }
    }
  }
}

// The stages of a chain: each chunk with all samples, one chunk after the other. The vertices of the stage at hand have
// been viewed.
template <class Rays>
class Stages {
 public:
  Stages(std::span<const ChainStep> steps, const SampleTile& samples) : steps_(steps), samples_(samples) {
    set_next(0, 0);
    if (next_) {
      for (std::size_t n = 0; n <= next_->of.chunk.edges; ++n) next_->view_vertex(samples, n);
    }
    go_on();
  }

  // The one at hand, and the one after it; none behind the last one.
  [[nodiscard]] const std::optional<Stage<Rays>>& here() const { return here_; }
  [[nodiscard]] const std::optional<Stage<Rays>>& next() const { return next_; }

  void go_on() {
    here_.reset();
    if (next_) here_.emplace(*next_);
    if (here_) set_next(begin_, here_->i + hn::Lanes(d));
  }

 private:
  // To the samples from i on of the chunk that starts with a step, else to the first ones of the next chunk.
  void set_next(std::size_t begin, std::size_t i) {
    if (i >= samples_.count) {
      begin += kEdgesPerChunk;
      i = 0;
    }
    next_.reset();
    if (begin >= steps_.size() || samples_.count == 0) return;
    std::optional<ProjectedChunk<Rays>>& chunk = chunks_[begin / kEdgesPerChunk % 2];
    if (i == 0) {
      chunk.emplace(steps_[begin > 0 ? begin - 1 : 0].to,
                    steps_.subspan(begin, std::min(kEdgesPerChunk, steps_.size() - begin)), samples_);
    }
    view_ = 1 - view_;
    begin_ = begin;
    next_.emplace(Stage<Rays>{*chunk, i, views_[view_]});
  }

  std::span<const ChainStep> steps_;
  const SampleTile& samples_;
  std::array<std::optional<ProjectedChunk<Rays>>, 2> chunks_;  // in turns, as views
  std::array<ChunkView<Rays>, 2> views_;
  std::size_t begin_ = 0, view_ = 0;  // of the next stage
  std::optional<Stage<Rays>> here_, next_;
};

// Multiplies the factors of a block onto the products of a stage, and views vertices of the next stage, if there is
// one: as many of them, whose square roots fill the time that products wait for one another.
template <class Rays>
HWY_INLINE void multiply_block(ProductTile& products, const SampleTile& samples, const Stage<Rays>& stage,
                               const Stage<Rays>* next, const EdgeRange& block) {
  const Rays& rays = stage.of.rays;
  const std::size_t viewed = next ? next->of.chunk.edges : 0;
  ProductLanes z = load(products, stage.i);
  LaneMask trusted = hn::FirstN(d, hn::Lanes(d));
  for (std::size_t n = block.begin; n < block.end; ++n) {
    if (n < viewed) next->view_vertex(samples, n + 1);
    if (rays.is_without_factor(n, stage.i)) continue;
    const EdgeFactors factors = factors_of(rays, stage.view, n);
    trusted = hn::And(trusted, is_not_near(factors));
    z = times(z, factors.re, factors.im, factors.direction);
  }
  trusted = hn::And(trusted, is_sound(z));
  if (HWY_LIKELY(hn::AllTrue(d, trusted))) {
    store(scaled(z), products, stage.i);
  } else {
    const Trial trial = product_without_level_edges(products, stage, block);
    if (!hn::AllTrue(d, trial.trusted)) {
      multiply_carefully(products, samples, stage, block, bits_of(trial.trusted));
    }
    store_trusted(trial.z, trial.trusted, products, stage.i);
  }
}

template <class Rays>
void multiply_all(std::span<const ChainStep> steps, const SampleTile& samples, ProductTile& products) {
  set_ones(products);
  for (Stages<Rays> stages(steps, samples); stages.here(); stages.go_on()) {
    const Stage<Rays>& stage = *stages.here();
    const Stage<Rays>* const next = stages.next() ? &*stages.next() : nullptr;
    if (next) next->view_vertex(samples, 0);
    const std::size_t edges = stage.of.chunk.edges;
    for (std::size_t begin = 0; begin < edges; begin += kFactorsPerBlock) {
      multiply_block(products, samples, stage, next, {begin, std::min(begin + kFactorsPerBlock, edges)});
    }
  }
  set_arguments(products, samples.count);
}

void multiply_chains_here(std::span<const ChainStep> steps, const SampleTile& samples, TileShape shape,
                          ProductTile& products) {
  if (shape == TileShape::kInRows) {
    multiply_all<EdgesOfRows>(steps, samples, products);
  } else if (samples.share_a_ray()) {
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
