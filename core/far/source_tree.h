// Triangles as sources of a field: a tree whose nodes are evaluated as multipoles from afar.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/boundary/solid_angle_kernel.h"
#include "core/data/vec3.h"
#include "core/far/multipole.h"
#include "core/far/shared_corners.h"

namespace raycone {

// A node has the triangles [begin, end): first its own, up to own_end, then those of its children. Nodes are in
// depth-first order: the first child is the next node, and `next` is the first one that is not below this one.
struct SourceNode {
  Vec3 centre;
  double unit = 1;    // of length, for its multipole; a power of two, radius <= unit <= 2 radius
  double radius = 0;  // no point of its triangles is farther from the centre
  double area = 0;
  // From so far on, squared, its own triangles look small (looks_small_from()).
  double square_of_small = 0;
  std::uint32_t begin = 0, own_end = 0, end = 0, next = 0;
  std::uint32_t first_chunk = 0, last_chunk = 0;  // of its own triangles in corners(): up to, without the last
  int order = 0;                                  // of its expansion; 0: there is none
  std::size_t first_coefficient = 0;
  MultipoleBounds bounds;
  // From so far on, squared, the expansion cut off behind degree p errs by at most the node's share of the tolerance,
  // in proportion to area and to the number of its triangles by halves, rounding included. Never increases with p;
  // infinite where no distance will do, [0] always; no numbers in a node without expansion: nothing is far enough.
  std::array<double, kMultipoleOrder + 1> square_of_distance{};

  [[nodiscard]] std::size_t triangles() const { return end - begin; }
};

// Thread-safe once made.
class SourceTree {
 public:
  // How fine a tree is: triangles in a leaf, and the order of expansions. Where sources fill a volume, or the tolerance
  // is small, high orders leave much less near, but they take longer to make.
  struct Detail {
    std::uint32_t leaf = 16;
    int order = 16;
  };

  // Triangles of a mesh in scale: coordinates of at most 1. Nodes that are accepted as square_of_distance says err by
  // at most `tolerance` turns (positive) together, whichever they are. Deterministic, also for every level. Throws
  // std::length_error for more than 2^32 - 1 triangles.
  SourceTree(std::vector<SolidTriangle> triangles, double tolerance, SimdLevel level, Detail detail);

  [[nodiscard]] std::span<const SourceNode> nodes() const { return nodes_; }  // first the root, if any
  [[nodiscard]] std::span<const SolidTriangle> triangles() const { return triangles_; }
  [[nodiscard]] const SharedCorners& corners() const { return corners_; }
  [[nodiscard]] const double* coefficients() const { return coefficients_.get(); }  // set_coefficients()
  [[nodiscard]] double area() const { return nodes_.empty() ? 0.0 : nodes_.front().area; }

  // How far the expansion of `node` cut off behind some degree is off at most at a distance from its centre: the least
  // degree behind which it is off by no more than `most`, none above the node's order, and that error; 0: the
  // node need not be summed at all. Nothing for a node without expansion.
  struct Cut {
    int degree;
    double error;
  };
  [[nodiscard]] static std::optional<Cut> least_cut(const SourceNode& node, double distance, double most);

 private:
  struct PlacedTriangle;

  void build();
  // Of all of `placed`, which it sorts; they become the triangles from `begin` on.
  void build_node(std::span<PlacedTriangle> placed, std::uint32_t begin);
  static void sort_by_middles(std::span<PlacedTriangle> placed);
  [[nodiscard]] double square_of_small(const SourceNode& node) const;
  void measure(SourceNode& node) const;
  void expand();
  [[nodiscard]] Multipole expansion_of(const SourceNode& node) const;
  void finish(SourceNode& node, const Multipole& multipole);

  std::vector<SolidTriangle> triangles_;
  SharedCorners corners_;  // of the triangles, node by node
  double tolerance_;
  Detail detail_;
  MomentKernel moments_;
  std::vector<SourceNode> nodes_;
  std::unique_ptr<double[]> coefficients_;  // tens of megabytes, first touched by the threads that set them
};

}  // namespace raycone
