#include "core/mesh/triangle_runs.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>

#include "core/machine/threads.h"

namespace raycone {
namespace {

// Where a triangle's box has its middle, in units of the longest side of all middles' box: at least 0. It goes along
// with the triangle, so that what is looked at one after the other lies in memory so; in floats, as memory is what
// sorting takes.
struct PlacedTriangle {
  std::array<float, 3> middle;
  std::uint32_t number;

  // Orders by the middle along an axis, then by number: bits of floats that are not negative are ordered as they are.
  [[nodiscard]] std::uint64_t key(std::size_t axis) const {
    return std::uint64_t{std::bit_cast<std::uint32_t>(middle[axis])} << 32 | number;
  }
};

// A quarter of it, which never overflows.
Vec3 quarter_of_middle(const Box& box) { return 0.125 * box.lower + 0.125 * box.upper; }

// Puts the `count` triangles whose keys along the axis are least before the others.
class Selection {
 public:
  Selection(std::span<PlacedTriangle> triangles, std::size_t axis) : triangles_(triangles), axis_(axis) {}

  void select(std::size_t count) {
    std::size_t begin = 0, end = triangles_.size();
    // Halves would need half as many rounds. An order that defeats the samples is not to take quadratic time.
    int rounds = 4 * static_cast<int>(std::bit_width(end));
    while (begin < count && count < end) {
      if (end - begin <= kFew) return sort_few(begin, end);
      if (rounds-- == 0) return select_slowly(begin, count, end);
      const std::size_t middle = partition(begin, end, pivot(begin, end, count));
      (middle <= count ? begin : end) = middle;
    }
  }

 private:
  static constexpr std::size_t kFew = 32;     // more than a sample, whose keys differ then
  static constexpr std::size_t kMany = 1024;  // worth a larger sample
  static constexpr std::size_t kLarge = 31, kSmall = 7;

  // A key near the one at `wanted`, on its far side, so that most triangles are sorted out; never the least one.
  [[nodiscard]] std::uint64_t pivot(std::size_t begin, std::size_t end, std::size_t wanted) const {
    std::array<std::uint64_t, kLarge> keys;
    const std::size_t size = end - begin, sample = size < kMany ? kSmall : kLarge, aside = size < kMany ? 1 : 2;
    for (std::size_t n = 0; n < sample; ++n) keys[n] = triangles_[begin + (2 * n + 1) * size / (2 * sample)].key(axis_);
    const std::size_t place = (wanted - begin) * sample / size;
    const bool in_upper_half = 2 * (wanted - begin) > size;
    const std::size_t chosen = in_upper_half ? std::max(place, aside + 1) - aside : std::min(place + aside, sample - 1);
    const auto at = keys.begin() + static_cast<std::ptrdiff_t>(chosen);
    std::nth_element(keys.begin(), at, keys.begin() + static_cast<std::ptrdiff_t>(sample));
    return *at;
  }

  // Puts keys below `pivot` first; returns where the others begin. Without branches, which nobody could predict.
  std::size_t partition(std::size_t begin, std::size_t end, std::uint64_t pivot) {
    std::size_t middle = begin;
    for (std::size_t n = begin; n < end; ++n) {
      const PlacedTriangle triangle = triangles_[n];
      triangles_[n] = triangles_[middle];
      triangles_[middle] = triangle;
      middle += triangle.key(axis_) < pivot ? 1 : 0;
    }
    return middle;
  }

  void select_slowly(std::size_t begin, std::size_t count, std::size_t end) {
    const auto at = [&](std::size_t n) { return triangles_.begin() + static_cast<std::ptrdiff_t>(n); };
    std::nth_element(at(begin), at(count), at(end),
                     [&](const PlacedTriangle& a, const PlacedTriangle& b) { return a.key(axis_) < b.key(axis_); });
  }

  // Each goes where as many keys as are below its own say.
  void sort_few(std::size_t begin, std::size_t end) {
    std::array<PlacedTriangle, kFew> few;
    std::array<std::uint64_t, kFew> keys;
    const std::size_t size = end - begin;
    for (std::size_t n = 0; n < size; ++n) few[n] = triangles_[begin + n], keys[n] = few[n].key(axis_);
    for (std::size_t n = 0; n < size; ++n) {
      std::size_t below = 0;
      for (std::size_t other = 0; other < size; ++other) below += keys[other] < keys[n] ? 1 : 0;
      triangles_[begin + below] = few[n];
    }
  }

  std::span<PlacedTriangle> triangles_;
  std::size_t axis_;
};

// Sorts triangles into the tree's order.
class RunOrder {
 public:
  explicit RunOrder(const TriangleMesh& mesh) : triangles_(mesh.triangles.size()) {
    const Box box = middles_of(mesh);
    const Vec3 sides = box.upper - box.lower;
    const double longest = std::max({sides.x, sides.y, sides.z});
    const double scale = longest > kNoSize ? 1.0 / longest : 0.0;
    parallel_for(triangles_.size(), kWorthATask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        const auto number = static_cast<std::uint32_t>(n);
        const Vec3 middle = scale * (quarter_of_middle(box_of_triangle(mesh, number)) - box.lower);
        triangles_[n] = {{static_cast<float>(middle.x), static_cast<float>(middle.y), static_cast<float>(middle.z)},
                         number};
      }
    });
  }

  // The triangles in runs of `width` that are close together, these in runs of `width` runs, and so on.
  std::vector<std::uint32_t> in_runs_of(std::size_t width) && {
    std::size_t run = width;
    while (run < triangles_.size()) run *= width;
    split(0, triangles_.size(), run / width, width);
    std::vector<std::uint32_t> numbers(triangles_.size());
    std::ranges::transform(triangles_, numbers.begin(), &PlacedTriangle::number);
    return numbers;
  }

 private:
  static constexpr std::size_t kWorthATask = 4096;
  static constexpr double kNoSize = 1e-300;  // what is shorter is a point: its inverse could overflow

  // The box of their quarters.
  static Box middles_of(const TriangleMesh& mesh) {
    const Box all = mesh.triangles.empty() ? Box{} : bounding_box(mesh);
    return {0.25 * all.lower, 0.25 * all.upper};
  }

  // Arranges [begin, end), the start of which is one of a run of `run`, into runs of that and of shorter ones.
  void split(std::size_t begin, std::size_t end, std::size_t run, std::size_t width) {
    while (run >= width && end - begin <= run) run /= width;
    if (run < width) return;
    const std::size_t runs = (end - begin + run - 1) / run;
    const std::size_t middle = begin + (runs + 1) / 2 * run;
    Selection(std::span(triangles_).subspan(begin, end - begin), longest_axis(begin, end)).select(middle - begin);
    if (end - begin < kWorthATask) {
      split(begin, middle, run, width);
      split(middle, end, run, width);
      return;
    }
    parallel_for(2, 1, [&](std::size_t first, std::size_t last) {
      for (std::size_t half = first; half < last; ++half) {
        half == 0 ? split(begin, middle, run, width) : split(middle, end, run, width);
      }
    });
  }

  // Of the middles' box; where they are many, of that of some of them.
  [[nodiscard]] std::size_t longest_axis(std::size_t begin, std::size_t end) const {
    constexpr std::size_t kSome = 128;
    const std::size_t step = std::max<std::size_t>((end - begin) / kSome, 1);
    std::array<float, 3> lower = triangles_[begin].middle, upper = lower;
    for (std::size_t n = begin; n < end; n += step) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        lower[axis] = std::min(lower[axis], triangles_[n].middle[axis]);
        upper[axis] = std::max(upper[axis], triangles_[n].middle[axis]);
      }
    }
    const float x = upper[0] - lower[0], y = upper[1] - lower[1], z = upper[2] - lower[2];
    return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
  }

  std::vector<PlacedTriangle> triangles_;
};

}  // namespace

Box box_of_triangle(const TriangleMesh& mesh, std::uint32_t triangle) {
  const Triangle& t = mesh.triangles[triangle];
  return box_of(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
}

std::vector<std::uint32_t> triangles_in_runs(const TriangleMesh& mesh, std::size_t width) {
  return RunOrder(mesh).in_runs_of(width);
}

}  // namespace raycone
