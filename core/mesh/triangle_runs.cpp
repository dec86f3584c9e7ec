#include "core/mesh/triangle_runs.h"

#include <algorithm>
#include <utility>

#include "core/machine/threads.h"

namespace raycone {
namespace {

// Centres go along with triangles: what is looked at one after the other then lies in memory so.
struct CenteredTriangle {
  Vec3 center;
  std::uint32_t number;
};

// Sorts triangles into the tree's order.
class RunOrder {
 public:
  explicit RunOrder(const TriangleMesh& mesh) : triangles_(mesh.triangles.size()) {
    parallel_for(triangles_.size(), kWorthATask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        const auto number = static_cast<std::uint32_t>(n);
        const Box box = box_of_triangle(mesh, number);
        triangles_[n] = {0.5 * box.lower + 0.5 * box.upper, number};
      }
    });
  }

  // The triangles in runs of `width` that are close together, these in runs of `width` runs, and so on.
  std::vector<std::uint32_t> in_runs_of(std::size_t width) && {
    std::size_t run = width;
    while (run < triangles_.size()) run *= width;
    split(0, triangles_.size(), run / width, width);
    std::vector<std::uint32_t> numbers(triangles_.size());
    std::ranges::transform(triangles_, numbers.begin(), &CenteredTriangle::number);
    return numbers;
  }

 private:
  static constexpr std::size_t kWorthATask = 4096;

  // Arranges [begin, end), the start of which is one of a run of `run`, into runs of that and of shorter ones.
  void split(std::size_t begin, std::size_t end, std::size_t run, std::size_t width) {
    while (run >= width && end - begin <= run) run /= width;
    if (run < width) return;
    const std::size_t runs = (end - begin + run - 1) / run;
    const std::size_t middle = begin + (runs + 1) / 2 * run;
    switch (longest_axis(begin, end)) {
      case 0:
        halve<&Vec3::x>(begin, middle, end);
        break;
      case 1:
        halve<&Vec3::y>(begin, middle, end);
        break;
      default:
        halve<&Vec3::z>(begin, middle, end);
    }
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

  template <double Vec3::*coordinate>
  void halve(std::size_t begin, std::size_t middle, std::size_t end) {
    const auto at = [this](std::size_t n) { return triangles_.begin() + static_cast<std::ptrdiff_t>(n); };
    std::nth_element(at(begin), at(middle), at(end), [](const CenteredTriangle& a, const CenteredTriangle& b) {
      const double x = a.center.*coordinate, y = b.center.*coordinate;
      return x != y ? x < y : a.number < b.number;
    });
  }

  [[nodiscard]] int longest_axis(std::size_t begin, std::size_t end) const {
    Vec3 lower = triangles_[begin].center, upper = lower;
    for (std::size_t n = begin; n < end; ++n) {
      const Vec3& center = triangles_[n].center;
      lower = {std::min(lower.x, center.x), std::min(lower.y, center.y), std::min(lower.z, center.z)};
      upper = {std::max(upper.x, center.x), std::max(upper.y, center.y), std::max(upper.z, center.z)};
    }
    const Vec3 sides = upper - lower;
    return sides.x >= sides.y && sides.x >= sides.z ? 0 : sides.y >= sides.z ? 1 : 2;
  }

  std::vector<CenteredTriangle> triangles_;
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
