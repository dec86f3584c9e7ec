#include "core/sharpening/lattice_crossings.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/data/box.h"
#include "core/sharpening/fill_gap.h"

namespace raycone {
namespace {

// The lines of the lattice along an axis, as they see a triangle: in two coordinates.
class Lines {
 public:
  Lines(const Corners3& triangle, const Lattice& lattice, int axis)
      : triangle_(triangle), lattice_(lattice), right_((axis + 1) % 3), up_((axis + 2) % 3) {
    const Vec3 to_b = triangle[1] - triangle[0], to_c = triangle[2] - triangle[0];
    area_ = to_b[right_] * to_c[up_] - to_b[up_] * to_c[right_];
  }

  // visit(point) for each point where one of them meets the triangle.
  template <class Visit>
  void for_each_crossing(const Box& box, const Visit& visit) const {
    if (area_ == 0.0) return;
    for (std::int64_t i = first(right_, box); i <= last(right_, box); ++i) {
      for (std::int64_t j = first(up_, box); j <= last(up_, box); ++j) {
        const double x = coordinate(right_, i), y = coordinate(up_, j);
        const auto weights = weights_at(x, y);
        if (!weights) continue;
        const auto& [a, b, c] = *weights;
        visit(a * triangle_[0] + b * triangle_[1] + c * triangle_[2]);
      }
    }
  }

 private:
  // Of samples from the first one, in the order of the lattice.
  [[nodiscard]] std::int64_t first(int axis, const Box& box) const { return lattice_.cell_at(axis, box.lower[axis]); }
  [[nodiscard]] std::int64_t last(int axis, const Box& box) const {
    return lattice_.cell_at(axis, box.upper[axis]) + 1;
  }
  [[nodiscard]] double coordinate(int axis, std::int64_t sample) const {
    return lattice_.coordinate(axis, lattice_.index_min[static_cast<std::size_t>(axis)] + sample);
  }

  // Barycentric coordinates of the line; none where it passes beside the triangle. None is negative and their sum is 1,
  // so that the point is one of the triangle, whatever rounds where that is a needle.
  [[nodiscard]] std::optional<std::array<double, 3>> weights_at(double x, double y) const {
    constexpr double kBeside = -1e-9;
    std::array<double, 3> weights;
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 &a = triangle_[(i + 1) % 3], &b = triangle_[(i + 2) % 3];
      const double weight = ((a[right_] - x) * (b[up_] - y) - (a[up_] - y) * (b[right_] - x)) / area_;
      if (!(weight >= kBeside)) return std::nullopt;
      weights[i] = std::max(weight, 0.0);
      sum += weights[i];
    }
    if (!(sum > 0.5 && sum < 2.0)) return std::nullopt;  // all is rounding
    for (double& weight : weights) weight /= sum;
    return weights;
  }

  const Corners3& triangle_;
  const Lattice& lattice_;
  int right_, up_;
  double area_;  // twice that of the projection
};

}  // namespace

std::vector<Vec3> crossings_off_mesh(const Corners3& triangle, const Lattice& lattice,
                                     const DistanceEvaluator& distance, double off) {
  const Box box = box_of(triangle);
  std::vector<Vec3> points;
  for (int axis = 0; axis < 3; ++axis) {
    Lines(triangle, lattice, axis).for_each_crossing(box, [&](const Vec3& p) { points.push_back(p); });
  }
  if (are_on_mesh(points, distance, off)) return {};
  std::erase_if(points, [&](const Vec3& p) { return are_on_mesh({&p, 1}, distance, off); });
  return points;
}

}  // namespace raycone
