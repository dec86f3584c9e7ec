#include "core/mesh/triangle_runs.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/machine/threads.h"

namespace raycone {
namespace {

// Sorts triangles into the tree's order.
class RunOrder {
 public:
  explicit RunOrder(const TriangleMesh& mesh) : centers_(mesh.triangles.size()), triangles_(mesh.triangles.size()) {
    std::iota(triangles_.begin(), triangles_.end(), std::uint32_t{0});
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
      const Box box = box_of_triangle(mesh, i);
      centers_[i] = 0.5 * box.lower + 0.5 * box.upper;
    }
  }

  // The triangles in runs of `width` that are close together, these in runs of `width` runs, and so on.
  std::vector<std::uint32_t> in_runs_of(std::size_t width) && {
    std::size_t run = width;
    while (run < triangles_.size()) run *= width;
    split(0, triangles_.size(), run / width, width);
    return std::move(triangles_);
  }

 private:
  // Arranges [begin, end), the start of which is one of a run of `run`, into runs of that and of shorter ones.
  void split(std::size_t begin, std::size_t end, std::size_t run, std::size_t width) {
    while (run >= width && end - begin <= run) run /= width;
    if (run < width) return;
    const std::size_t runs = (end - begin + run - 1) / run;
    const std::size_t middle = begin + (runs + 1) / 2 * run;
    const int axis = longest_axis(begin, end);
    const auto at = [this](std::size_t n) { return triangles_.begin() + static_cast<std::ptrdiff_t>(n); };
    std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
      return centers_[a][axis] != centers_[b][axis] ? centers_[a][axis] < centers_[b][axis] : a < b;
    });
    constexpr std::size_t kWorthATask = 4096;
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

  [[nodiscard]] int longest_axis(std::size_t begin, std::size_t end) const {
    Box box{centers_[triangles_[begin]], centers_[triangles_[begin]]};
    for (std::size_t n = begin; n < end; ++n) {
      const Vec3& center = centers_[triangles_[n]];
      for (int axis = 0; axis < 3; ++axis) {
        box.lower[axis] = std::min(box.lower[axis], center[axis]);
        box.upper[axis] = std::max(box.upper[axis], center[axis]);
      }
    }
    const Vec3 sides = box.upper - box.lower;
    return sides.x >= sides.y && sides.x >= sides.z ? 0 : sides.y >= sides.z ? 1 : 2;
  }

  std::vector<Vec3> centers_;
  std::vector<std::uint32_t> triangles_;
};

}  // namespace

Box box_of_triangle(const TriangleMesh& mesh, std::uint32_t triangle) {
  const Triangle& t = mesh.triangles[triangle];
  const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  return {{std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}), std::min({a.z, b.z, c.z})},
          {std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}), std::max({a.z, b.z, c.z})}};
}

std::vector<std::uint32_t> triangles_in_runs(const TriangleMesh& mesh, std::size_t width) {
  return RunOrder(mesh).in_runs_of(width);
}

}  // namespace raycone
