// Lists of triangles as the tree of sources sees them from afar.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/boundary/chain.h"
#include "core/boundary/cone_kernel.h"
#include "core/boundary/sample_tile.h"
#include "core/data/box.h"
#include "core/far/far_kernel.h"
#include "core/far/shared_corners.h"
#include "core/far/source_tree.h"
#include "core/far/triangle_extent.h"

namespace raycone {

// Triangles, some of them as nodes of the tree.
struct Cover {
  struct Expansion {
    std::uint32_t node;
    int degree;
  };
  std::vector<Expansion> expansions;
  std::vector<std::uint32_t> triangles;
  double cost = 0.0;  // at a point, in units of that of a triangle that is summed by itself
};

// Of `triangles`, numbers in the tree, ascending: nodes as expansions that are off by `tolerance` in all points of a
// box at most, all together. Each has a share of it, in proportion to area and to the number of triangles by halves:
// many small triangles are to be far, too, where there are a few large ones. `triangle_cost`: of one at a point, 1 or
// less where they are not summed one by one.
[[nodiscard]] Cover cover_in(const SourceTree& tree, std::span<const std::uint32_t> triangles, const Box& box,
                             double tolerance, double triangle_cost = 1.0);

// What interpolation between nodes in a box makes of a function: where its derivatives of order kOrder along any
// axis are at most D times the factorial of that, it is off by at most bend D, and values at nodes that are off by e
// make it off by at most growth e.
struct Interpolation {
  static constexpr int kOrder = 4;
  double bend, growth;
};

// A cover of all triangles in two parts, and how far what it sums to is off at most.
struct RoughCover {
  Cover smooth;                          // to be interpolated
  Cover near;                            // to be summed at each point
  std::vector<std::uint32_t> unopened;   // nodes: for covers of smaller boxes
  double error = 0.0, near_error = 0.0;  // of `smooth` and what has been left out; of `near`
};

// How nodes that come into the box and are much smaller are taken.
enum class SmallNodes { kOpened, kUnopened };

struct RoughCoverOptions {
  Interpolation interpolation;
  double each;  // what any node or triangle may be off by, about
  SmallNodes small_nodes;
};

// Nodes as expansions, and triangles, or nothing in their place, each of which is off by twice `options.each` at most
// in all points of the box. Of what `around`, the cover of a box around this one, has near or unopened; of all
// triangles without. `extents`: of the tree's triangles. How far all are off together is known only afterwards, so that
// sums may be too rough for some samples.
[[nodiscard]] RoughCover rough_cover_in(const SourceTree& tree, std::span<const TriangleExtent> extents, const Box& box,
                                        const RoughCoverOptions& options, const RoughCover* around);

struct CoverKernels {
  SharedCornersKernel shared_corners;
  ConeKernel cone;
  FarKernel far;
};

// Sums of a cover at the samples of tiles.
class CoverSums {
 public:
  // All samples must be within the box.
  CoverSums(const SourceTree& tree, const Cover& cover, const Box& samples, const CoverKernels& kernels);
  CoverSums(const CoverSums&) = delete;  // corners_ refers to triangles_

  // Without the crossings of the triangles: these have the boundary `steps`, which is summed in their place.
  CoverSums(const SourceTree& tree, const Cover& cover, std::span<const ChainStep> steps, const CoverKernels& kernels)
      : tree_(tree), cover_(cover), kernels_(kernels), steps_(steps) {}

  // visit(i, turns, rest) for each sample of the tile: the sum of both, the turns being whole.
  template <class Visit>
  void evaluate(SampleTile& tile, TileShape shape, const Visit& visit) {
    tile.fill_up();
    alignas(64) Tile far{};
    for (const auto& [node, degree] : cover_.expansions) kernels_.far.add_multipole(tree_, node, degree, tile, far);
    if (corners_.chunks() > 0) {
      kernels_.shared_corners(corners_, tile, shape, products_);
      for (std::size_t i = 0; i < tile.count; ++i) {
        visit(i, static_cast<double>(products_.turns(i)), products_.argument[i] + far[i]);
      }
    } else if (!steps_.empty()) {
      kernels_.cone(steps_, tile, shape, products_);
      for (std::size_t i = 0; i < tile.count; ++i) {
        visit(i, -static_cast<double>(products_.turns(i)), far[i] - products_.argument[i]);
      }
    } else {
      for (std::size_t i = 0; i < tile.count; ++i) visit(i, 0.0, far[i]);
    }
  }

 private:
  const SourceTree& tree_;
  const Cover& cover_;
  std::vector<SolidTriangle> triangles_;  // first those that look small
  SharedCorners corners_;
  CoverKernels kernels_;
  std::span<const ChainStep> steps_;
  ProductTile products_;
};

}  // namespace raycone
