// A search tree for the triangles of a mesh whose boxes meet.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/intersections/box_node.h"
#include "core/intersections/triangle_pair.h"
#include "core/mesh/triangle_runs.h"

namespace raycone {

// Boxes of the triangles in nodes of eight, boxes of nodes in nodes of eight, and so on.
class PairTree {
 public:
  static constexpr std::size_t kWidth = BoxNode::kWidth;

  // Keeps a reference to the mesh. `triangles`: all of them in any order, best with those in a row that are near each
  // other. Uses the threads that ThreadLimit allows.
  PairTree(const TriangleMesh& mesh, std::vector<std::uint32_t> triangles);

  [[nodiscard]] std::size_t size() const { return triangles_.size(); }
  [[nodiscard]] std::uint32_t triangle(std::size_t place) const { return triangles_[place]; }
  [[nodiscard]] const Triangle& vertices(std::size_t place) const { return mesh_.triangles[triangles_[place]]; }
  [[nodiscard]] Corners3 corners(std::size_t place) const { return corners_of(mesh_, vertices(place)); }

  [[nodiscard]] std::size_t runs() const { return levels_.front().size(); }

  // Calls visit(place, other) for the places of a run of triangles and those behind each of them whose boxes meet, both
  // in increasing order, as long as it returns true. `runs` is for its own use.
  template <class Visit>
  void for_each_pair(std::size_t run, std::vector<std::size_t>& runs, const Visit& visit) const {
    runs.clear();
    const RunBoxes of_run(*this, run);
    find_runs(levels_.size() - 1, 0, run, HalfBox(of_run.all()), runs);
    for (std::size_t child = 0; child < of_run.size(); ++child) {
      const HalfBox box(of_run[child]);
      for (const std::size_t other : runs) {
        unsigned meeting = levels_.front()[other].meeting(box);
        if (other == run) meeting &= ~0U << (child + 1);
        for (; meeting != 0; meeting &= meeting - 1) {
          const auto of_other = static_cast<std::size_t>(std::countr_zero(meeting));
          if (!visit(run * kWidth + child, other * kWidth + of_other)) return;
        }
      }
    }
  }

  // The same for those triangles of a run for which `of` is not 0, and all others whose boxes meet them; of two such
  // triangles the first one's run has the pair.
  template <class Visit>
  void for_each_pair_of(const std::vector<std::uint8_t>& of, std::size_t run, std::vector<std::size_t>& runs,
                        const Visit& visit) const {
    const auto is_asked = [&](std::size_t place) { return of[triangles_[place]] != 0; };
    const std::size_t end = std::min((run + 1) * kWidth, triangles_.size());
    Box asked = empty_box();
    for (std::size_t place = run * kWidth; place < end; ++place) {
      if (is_asked(place)) extend(asked, box_at(place));
    }
    runs.clear();
    find_runs(levels_.size() - 1, 0, 0, HalfBox(asked), runs);
    for (std::size_t place = run * kWidth; place < end && !runs.empty(); ++place) {
      if (!is_asked(place)) continue;
      const HalfBox box(box_at(place));
      for (const std::size_t other_run : runs) {
        for (unsigned meeting = levels_.front()[other_run].meeting(box); meeting != 0; meeting &= meeting - 1) {
          const std::size_t other = other_run * kWidth + static_cast<std::size_t>(std::countr_zero(meeting));
          if (other == place || (other < place && is_asked(other))) continue;
          if (!visit(place, other)) return;
        }
      }
    }
  }

 private:
  using Level = std::vector<BoxNode>;

  // The boxes of a run of triangles.
  class RunBoxes {
   public:
    RunBoxes(const PairTree& tree, std::size_t run)
        : size_(std::min(kWidth, tree.triangles_.size() - run * kWidth)), all_(empty_box()) {
      for (std::size_t child = 0; child < size_; ++child) {
        boxes_[child] = tree.box_at(run * kWidth + child);
        extend(all_, boxes_[child]);
      }
    }
    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] const Box& operator[](std::size_t child) const { return boxes_[child]; }
    [[nodiscard]] const Box& all() const { return all_; }
    [[nodiscard]] BoxNode node() const { return {{boxes_.data(), size_}, all_}; }

   private:
    std::size_t size_;
    std::array<Box, kWidth> boxes_;
    Box all_;
  };

  // Of the triangle at a place.
  [[nodiscard]] Box box_at(std::size_t place) const { return box_of_triangle(mesh_, triangles_[place]); }

  // The nodes of those that have these boxes, which become the boxes of the new ones.
  static Level level_above(std::vector<Box>& boxes);
  // Adds the runs from `first` on whose boxes meet a box, in increasing order. Child i of node n of a level is node
  // 8 n + i of the level below; nodes of the lowest level are runs.
  void find_runs(std::size_t level, std::size_t node, std::size_t first, const HalfBox& box,
                 std::vector<std::size_t>& runs) const;

  const TriangleMesh& mesh_;
  std::vector<std::uint32_t> triangles_;
  std::vector<Level> levels_;  // the triangles' first
};

}  // namespace raycone
