#include "core/mesh/triangle_runs.h"

#include <algorithm>
#include <array>
#include <bit>
#include <memory>
#include <numeric>

#include "core/machine/threads.h"
#include "core/mesh/selection_kernel.h"

namespace raycone {
namespace {

// The places of triangles' middles along each axis, from 0 on, in units of 2^-30 of the longest side of a box.
constexpr double kUnits = 0x1p30;

// Of `count` triangles.
class TriangleColumns {
 public:
  explicit TriangleColumns(std::size_t count)
      : count_(count), numbers_(std::make_unique_for_overwrite<std::uint32_t[]>(4 * count)) {}

  [[nodiscard]] PlacedTriangles all() const {
    std::uint32_t* const first = numbers_.get();
    return {{first, first + count_, first + 2 * count_}, first + 3 * count_};
  }

 private:
  std::size_t count_;
  std::unique_ptr<std::uint32_t[]> numbers_;
};

// A quarter of it, which never overflows.
Vec3 quarter_of_middle(const Box& box) { return 0.125 * box.lower + 0.125 * box.upper; }

// Puts those of `size` triangles first whose keys along the axis are least. `room` is for as many.
class Selection {
 public:
  Selection(const SelectionKernel& kernel, const PlacedTriangles& triangles, const PlacedTriangles& room,
            std::size_t size, std::size_t axis)
      : kernel_(kernel), triangles_(triangles), room_(room), size_(size), axis_(axis) {}

  // `count` of them.
  void select(std::size_t count) {
    std::size_t begin = 0, end = size_;
    // Halves would need half as many rounds. An order that defeats the samples is not to take quadratic time.
    int rounds = 4 * static_cast<int>(std::bit_width(end));
    while (begin < count && count < end) {
      if (end - begin <= kMostSorted) return kernel_.sort_few(triangles_.from(begin), end - begin, axis_);
      const std::uint64_t key = rounds-- > 0 ? pivot(begin, end, count) : key_at(begin, end, count);
      const std::size_t middle = begin + kernel_.partition(triangles_.from(begin), room_, end - begin, axis_, key);
      (middle <= count ? begin : end) = middle;
    }
  }

 private:
  static constexpr std::size_t kMany = 1024;  // worth a larger sample
  static constexpr std::size_t kLarge = 31, kSmall = 7;

  // A key near the one at `wanted`, on its far side, so that most triangles are sorted out; never the least one.
  [[nodiscard]] std::uint64_t pivot(std::size_t begin, std::size_t end, std::size_t wanted) const {
    std::array<std::uint64_t, kLarge> keys;
    const std::size_t size = end - begin, sample = size < kMany ? kSmall : kLarge, aside = size < kMany ? 1 : 2;
    for (std::size_t n = 0; n < sample; ++n) {
      keys[n] = triangles_.key(axis_, begin + (2 * n + 1) * size / (2 * sample));
    }
    const std::size_t place = (wanted - begin) * sample / size;
    const bool in_upper_half = 2 * (wanted - begin) > size;
    const std::size_t chosen = in_upper_half ? std::max(place, aside + 1) - aside : std::min(place + aside, sample - 1);
    const auto at = keys.begin() + static_cast<std::ptrdiff_t>(chosen);
    std::nth_element(keys.begin(), at, keys.begin() + static_cast<std::ptrdiff_t>(sample));
    return *at;
  }

  // The key at `wanted` in sorted order.
  [[nodiscard]] std::uint64_t key_at(std::size_t begin, std::size_t end, std::size_t wanted) const {
    std::vector<std::uint64_t> keys(end - begin);
    for (std::size_t n = 0; n < keys.size(); ++n) keys[n] = triangles_.key(axis_, begin + n);
    const auto at = keys.begin() + static_cast<std::ptrdiff_t>(wanted - begin);
    std::nth_element(keys.begin(), at, keys.end());
    return *at;
  }

  const SelectionKernel& kernel_;
  PlacedTriangles triangles_, room_;
  std::size_t size_, axis_;
};

// Sorts triangles into the tree's order.
class RunOrder {
 public:
  explicit RunOrder(const TriangleMesh& mesh)
      : mesh_(mesh), count_(mesh.triangles.size()), columns_(count_), room_columns_(count_) {
    std::iota(triangles_.number, triangles_.number + count_, 0U);
    place(0, count_, quarter_of_box());
  }

  // The triangles in runs of `width` that are close together, these in runs of `width` runs, and so on.
  std::vector<std::uint32_t> in_runs_of(std::size_t width) && {
    std::size_t run = width;
    while (run < count_) run *= width;
    split(0, count_, run / width, width);
    return {triangles_.number, triangles_.number + count_};
  }

 private:
  static constexpr std::size_t kWorthATask = 4096;
  static constexpr double kNoSize = 1e-290;  // what is shorter is a point: kUnits over it could overflow

  static constexpr std::uint32_t kClose = 256;  // units, of which a range of triangles has too few in all then

  // A quarter of the mesh's box, as quarters of middles are in it.
  [[nodiscard]] Box quarter_of_box() const {
    const Box all = count_ == 0 ? Box{} : bounding_box(mesh_);
    return {0.25 * all.lower, 0.25 * all.upper};
  }

  [[nodiscard]] Box box_of_quarters(std::size_t begin, std::size_t end) const {
    Box box = empty_box();
    for (std::size_t n = begin; n < end; ++n) {
      extend(box, quarter_of_middle(box_of_triangle(mesh_, triangles_.number[n])));
    }
    return box;
  }

  // Notes where the triangles of [begin, end) are in a box that holds quarters of their middles.
  void place(std::size_t begin, std::size_t end, const Box& quarter) {
    const double longest = longest_side(quarter);
    const double scale = longest > kNoSize ? kUnits / longest : 0.0;
    parallel_for(end - begin, kWorthATask, [&](std::size_t first, std::size_t last) {
      for (std::size_t n = begin + first; n < begin + last; ++n) {
        const Vec3 place = scale * (quarter_of_middle(box_of_triangle(mesh_, triangles_.number[n])) - quarter.lower);
        for (int axis = 0; axis < 3; ++axis) {
          triangles_.place[static_cast<std::size_t>(axis)][n] = static_cast<std::uint32_t>(place[axis]);
        }
      }
    });
  }

  // Arranges [begin, end), the start of which is one of a run of `run`, into runs of that and of shorter ones.
  void split(std::size_t begin, std::size_t end, std::size_t run, std::size_t width) {
    while (run >= width && end - begin <= run) run /= width;
    if (run < width) return;
    const std::size_t runs = (end - begin + run - 1) / run;
    const std::size_t middle = begin + (runs + 1) / 2 * run;
    Selection(kernel_, triangles_.from(begin), room_.from(begin), end - begin, axis_to_split(begin, end))
        .select(middle - begin);
    if (end - begin < kWorthATask) {
      split(begin, middle, run, width);
      split(middle, end, run, width);
      return;
    }
    parallel_for_each(
        2, [&](std::size_t half) { half == 0 ? split(begin, middle, run, width) : split(middle, end, run, width); });
  }

  // About the longest one. Triangles that are close together in the mesh, as all are in one with a stray far away, are
  // placed anew, in units of where they are: the old ones would leave them in any order.
  [[nodiscard]] std::size_t axis_to_split(std::size_t begin, std::size_t end) {
    std::array<std::uint32_t, 3> sides = sides_of(begin, end);
    if (std::ranges::max(sides) < kClose) {
      place(begin, end, box_of_quarters(begin, end));
      sides = sides_of(begin, end);
    }
    return static_cast<std::size_t>(std::ranges::max_element(sides) - sides.begin());
  }

  // Of the middles' box; where they are many, of that of some of them.
  [[nodiscard]] std::array<std::uint32_t, 3> sides_of(std::size_t begin, std::size_t end) const {
    constexpr std::size_t kSome = 128;
    const std::size_t step = std::max<std::size_t>((end - begin) / kSome, 1);
    std::array<std::uint32_t, 3> sides;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::uint32_t* const places = triangles_.place[axis];
      std::uint32_t lower = places[begin], upper = lower;
      for (std::size_t n = begin; n < end; n += step) {
        lower = std::min(lower, places[n]);
        upper = std::max(upper, places[n]);
      }
      sides[axis] = upper - lower;
    }
    return sides;
  }

  const TriangleMesh& mesh_;
  std::size_t count_;
  TriangleColumns columns_, room_columns_;
  PlacedTriangles triangles_ = columns_.all(), room_ = room_columns_.all();
  SelectionKernel kernel_ = selection_kernel(SimdLevel::kBest);
};

}  // namespace

std::vector<std::uint32_t> triangles_in_runs(const TriangleMesh& mesh, std::size_t width) {
  return RunOrder(mesh).in_runs_of(width);
}

}  // namespace raycone
