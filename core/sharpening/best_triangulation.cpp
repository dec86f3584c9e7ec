#include "core/sharpening/best_triangulation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace raycone {
namespace {

struct Point2 {
  double x, y;
};

class BestTriangulation {
 public:
  BestTriangulation(const std::vector<Vec3>& corners, const Vec3& front)
      : size_(corners.size()), best_(size_ * size_, {kNoTriangle, 0}) {
    const Vec3 across = std::abs(front.x) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    const Vec3 u = cross(across, front), v = cross(front, u);
    for (const Vec3& p : corners) {
      const Vec3 from_first = p - corners.front();
      points_.push_back({dot(u, from_first), dot(v, from_first)});
    }
  }

  std::vector<Triangle> triangles() {
    for (std::size_t sides = 2; sides < size_; ++sides) {
      for (std::size_t first = 0; first + sides < size_; ++first) cut(first, first + sides);
    }
    std::vector<Triangle> found;
    if (at(0, size_ - 1).shape > 0.0) collect(0, size_ - 1, found);
    return found;
  }

 private:
  static constexpr double kNoTriangle = 1e300;  // shape of what is cut off by a side: better than any triangle's
  struct Cut {
    double shape;        // of the worst triangle between two corners and those between them
    std::size_t corner;  // of the triangle that has both
  };

  [[nodiscard]] Cut& at(std::size_t first, std::size_t last) { return best_[first * size_ + last]; }
  void cut(std::size_t first, std::size_t last) {
    Cut best{0.0, 0};
    for (std::size_t corner = first + 1; corner < last; ++corner) {
      const double sides = std::min(at(first, corner).shape, at(corner, last).shape);
      if (!(sides > best.shape)) continue;
      const double shape = std::min(sides, shape_of(points_[first], points_[corner], points_[last]));
      if (shape > best.shape) best = {shape, corner};
    }
    at(first, last) = best;
  }
  void collect(std::size_t first, std::size_t last, std::vector<Triangle>& found) {
    if (last - first < 2) return;
    const std::size_t corner = at(first, last).corner;
    found.push_back(
        {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(corner), static_cast<std::uint32_t>(last)});
    collect(first, corner, found);
    collect(corner, last, found);
  }

  // 0 for what is turned over.
  [[nodiscard]] static double shape_of(const Point2& a, const Point2& b, const Point2& c) {
    const auto square = [](const Point2& p, const Point2& q) {
      return (p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y);
    };
    const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    const double longest = std::max({square(a, b), square(b, c), square(c, a)});
    return area > 0.0 ? area / longest : 0.0;
  }

  std::size_t size_;
  std::vector<Point2> points_;
  std::vector<Cut> best_;  // of each first and last corner
};

}  // namespace

std::vector<Triangle> best_triangulation(const std::vector<Vec3>& corners, const Vec3& front) {
  return BestTriangulation(corners, front).triangles();
}

}  // namespace raycone
