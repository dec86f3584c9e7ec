// Exterior edges as kernels see them: chunks of a chain, and what their projections say of the samples of a tile.
// Included once per SIMD level.
#if defined(RAYCONE_CORE_EDGE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYCONE_CORE_EDGE_LANES_INL_H_
#undef RAYCONE_CORE_EDGE_LANES_INL_H_
#else
#define RAYCONE_CORE_EDGE_LANES_INL_H_
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/boundary/chain.h"
#include "core/boundary/level_edges-inl.h"
#include "core/boundary/product_lanes-inl.h"
#include "core/boundary/sample_tile.h"
#include "core/exact/predicates.h"

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

  Chunk(const Vec3& from, std::span<const ChainStep> steps) : edges(steps.size()) {
    set_vertex(0, from);
    for (std::size_t n = 0; n < edges; ++n) {
      set_vertex(n + 1, steps[n].to);
      dy[n] = y[n + 1] - y[n];
      dz[n] = z[n + 1] - z[n];
      orientation[n] = !steps[n].joined ? 0.0 : steps[n].reversed ? -1.0 : 1.0;
    }
    // Only what lanes beyond the last edge see: to fill whole columns takes as long as some edges.
    for (std::size_t n = edges; n < std::min(edges + 8, x.size()); ++n) {
      if (n > edges) set_vertex(n, {});
      dy[n] = dz[n] = orientation[n] = 0.0;
    }
  }
  void set_vertex(std::size_t n, const Vec3& v) {
    x[n] = v.x;
    y[n] = v.y;
    z[n] = v.z;
  }
  [[nodiscard]] Vec3 vertex(std::size_t n) const { return {x[n], y[n], z[n]}; }
  // Of the edge from vertex n.
  [[nodiscard]] EdgeSide side(std::size_t n, const Vec3& q) const { return edge_side(vertex(n), vertex(n + 1), q); }
};

// One value per vertex of a chunk and lane.
using LaneColumn = std::array<double, (kEdgesPerChunk + 1) * 8>;
HWY_INLINE void store(Lanes value, LaneColumn& column, std::size_t n) {
  hn::Store(value, d, &column[n * hn::Lanes(d)]);
}
HWY_INLINE Lanes load(const LaneColumn& column, std::size_t n) { return hn::Load(d, &column[n * hn::Lanes(d)]); }

// The projections of a chunk along the one ray that all samples share: the lanes can be vertices and edges.
class EdgesOfOneRay {
 public:
  EdgesOfOneRay(const Chunk& chunk, const SampleTile& samples) : chunk_(chunk) {
    std::size_t n = 0;
    for (; n <= chunk.edges; n += hn::Lanes(d)) {
      const Lanes y = hn::Sub(hn::LoadU(d, &chunk.y[n]), hn::Set(d, samples.y[0]));
      const Lanes z = hn::Sub(hn::LoadU(d, &chunk.z[n]), hn::Set(d, samples.z[0]));
      hn::StoreU(y, d, &y_[n]);
      hn::StoreU(z, d, &z_[n]);
      hn::StoreU(square_of(y, z), d, &square_[n]);
    }
    if (n < y_.size()) y_[n] = z_[n] = square_[n] = 0.0;  // the end of an edge in lanes beyond the last one
    for (n = 0; n < chunk.edges; n += hn::Lanes(d)) {
      const ProjectedEdge edge = project(projected(n), projected(n + 1), hn::LoadU(d, &chunk.dy[n]),
                                         hn::LoadU(d, &chunk.dz[n]), hn::LoadU(d, &chunk.orientation[n]));
      hn::StoreU(edge.re, d, &re_[n]);
      hn::StoreU(edge.im, d, &im_[n]);
      hn::StoreU(edge.direction, d, &direction_[n]);
    }
    for (n = 0; n < chunk.edges; ++n) {
      without_factor_[n] = chunk.orientation[n] == 0.0;
      if (without_factor_[n] || !std::isnan(im_[n])) continue;
      without_factor_[n] = is_level_beside(n);
      if (!without_factor_[n]) sides_[n] = chunk.side(n, {samples.x[0], samples.y[0], samples.z[0]});
    }
  }

  // Whether there is no edge n, or it has no factor at any of the samples from i on.
  [[nodiscard]] bool is_without_factor(std::size_t n, std::size_t) const { return without_factor_[n]; }

  // The projections of vertices for a group of samples, beyond what all samples share.
  struct Projections {};
  // The samples of the group at which edge n has no factor, beside is_without_factor().
  [[nodiscard]] LaneMask without_factor(std::size_t, const Projections&) const { return hn::FirstN(d, 0); }
  // Projects vertex n for the samples from i on, and returns its |P|^2.
  [[nodiscard]] Lanes project_vertex(std::size_t n, std::size_t, Projections&) const { return hn::Set(d, square_[n]); }
  // Edge n, whose ends have been projected.
  [[nodiscard]] ProjectedEdge edge(std::size_t n, const Projections&) const {
    return {hn::Set(d, re_[n]), hn::Set(d, im_[n]), hn::Set(d, direction_[n])};
  }
  // That of edge n, exact.
  [[nodiscard]] EdgeSide side(std::size_t n, const Vec3& q) const {
    return std::isnan(im_[n]) ? sides_[n] : chunk_.side(n, q);
  }

 private:
  [[nodiscard]] ProjectedVertex projected(std::size_t n) const {
    return {hn::LoadU(d, &y_[n]), hn::LoadU(d, &z_[n]), hn::LoadU(d, &square_[n])};
  }

  [[nodiscard]] bool is_level_beside(std::size_t n) const {
    const auto all = [](double v) { return hn::Set(d, v); };
    return hn::AllTrue(d, HWY_NAMESPACE::is_level_beside(all(y_[n]), all(z_[n]), all(y_[n + 1]), all(z_[n + 1])));
  }

  const Chunk& chunk_;
  Column y_, z_, square_;
  Column re_, im_, direction_;
  std::array<bool, kEdgesPerChunk> without_factor_;
  std::array<EdgeSide, kEdgesPerChunk> sides_;  // where Im z is NaN
};

// The same for samples with a ray each.
class EdgesOfRays {
 public:
  EdgesOfRays(const Chunk& chunk, const SampleTile& samples) : chunk_(chunk), samples_(samples) {}

  [[nodiscard]] bool is_without_factor(std::size_t n, std::size_t) const { return chunk_.orientation[n] == 0.0; }

  struct Projections {
    alignas(64) LaneColumn y, z, square;
    [[nodiscard]] ProjectedVertex vertex(std::size_t n) const { return {load(y, n), load(z, n), load(square, n)}; }
  };
  [[nodiscard]] LaneMask without_factor(std::size_t n, const Projections& projections) const {
    const ProjectedVertex a = projections.vertex(n), b = projections.vertex(n + 1);
    return is_level_beside(a.y, a.z, b.y, b.z);
  }
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
  [[nodiscard]] EdgeSide side(std::size_t n, const Vec3& q) const { return chunk_.side(n, q); }

 private:
  const Chunk& chunk_;
  const SampleTile& samples_;
};

// The same for a tile of rows, whose sample 8 j + i is (x_i, y_j, z): the lanes can be rows.
class EdgesOfRows {
 public:
  EdgesOfRows(const Chunk& chunk, const SampleTile& samples) : chunk_(chunk) {
    alignas(64) std::array<double, 8> ys;
    for (std::size_t row = 0; row < ys.size(); ++row) ys[row] = samples.y[std::min(8 * row, samples.count - 8)];
    for (std::size_t row = 0; row < ys.size(); row += hn::Lanes(d)) {
      set_rows(row, hn::Load(d, &ys[row]), samples.z[0]);
    }
  }

  [[nodiscard]] bool is_without_factor(std::size_t n, std::size_t i) const {
    return ((without_factor_[n] >> (i / 8)) & 1U) != 0;
  }

  // The row that is looked at.
  struct Projections {
    std::size_t row;
  };
  [[nodiscard]] LaneMask without_factor(std::size_t, const Projections&) const { return hn::FirstN(d, 0); }
  [[nodiscard]] Lanes project_vertex(std::size_t n, std::size_t i, Projections& projections) const {
    projections.row = i / 8;
    return hn::Set(d, square_[8 * n + projections.row]);
  }
  [[nodiscard]] ProjectedEdge edge(std::size_t n, const Projections& projections) const {
    const std::size_t place = 8 * n + projections.row;
    const Lanes im = hn::Set(d, im_[place]);
    return {hn::Set(d, re_[place]), im, hn::CopySignToAbs(hn::Set(d, 1.0), im)};
  }
  [[nodiscard]] EdgeSide side(std::size_t n, const Vec3& q) const { return chunk_.side(n, q); }

 private:
  // Of rows from `row` on.
  void set_rows(std::size_t row, Lanes qy, double qz) {
    const auto projected = [&](std::size_t n) -> ProjectedVertex {
      const Lanes y = hn::Sub(hn::Set(d, chunk_.y[n]), qy), z = hn::Set(d, chunk_.z[n] - qz);
      return {y, z, square_of(y, z)};
    };
    ProjectedVertex from = projected(0);
    hn::Store(from.square, d, &square_[row]);
    for (std::size_t n = 0; n < chunk_.edges; ++n) {
      const ProjectedVertex to = projected(n + 1);
      const ProjectedEdge edge =
          project(from, to, hn::Set(d, chunk_.dy[n]), hn::Set(d, chunk_.dz[n]), hn::Set(d, chunk_.orientation[n]));
      hn::Store(to.square, d, &square_[8 * (n + 1) + row]);
      hn::Store(edge.re, d, &re_[8 * n + row]);
      hn::Store(edge.im, d, &im_[8 * n + row]);
      const auto none =
          chunk_.orientation[n] == 0.0 ? hn::FirstN(d, hn::Lanes(d)) : is_level_beside(from.y, from.z, to.y, to.z);
      if (row == 0) without_factor_[n] = 0;
      without_factor_[n] = static_cast<std::uint8_t>(without_factor_[n] | bits_of(none) << row);
      from = to;
    }
  }

  const Chunk& chunk_;
  alignas(64) std::array<double, 8 * (kEdgesPerChunk + 1)> square_;  // row by row of each vertex
  alignas(64) std::array<double, 8 * kEdgesPerChunk> re_, im_;       // likewise of each edge
  std::array<std::uint8_t, kEdgesPerChunk> without_factor_;          // a bit for each row
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#endif  // RAYCONE_CORE_EDGE_LANES_INL_H_
