// Rays along +x in bins, by which a triangle finds those that it may meet.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/data/box.h"
#include "core/data/vec3.h"

namespace raycone {

// The ray {origin + t x, t >= 0}, and a number by which its owner knows it.
struct NumberedRay {
  Vec3 origin;
  std::uint32_t number;

  [[nodiscard]] bool meets(const Box& closed) const {
    return origin.y >= closed.lower.y && origin.y <= closed.upper.y && origin.z >= closed.lower.z &&
           origin.z <= closed.upper.z && origin.x <= closed.upper.x;
  }
};

// Rays put into bins over y and z, fine enough that most small triangles find none. So one pass over the triangles
// finds what all rays meet. Const calls are thread-safe.
class BinnedRays {
 public:
  // Precondition: all coordinates are finite.
  explicit BinnedRays(std::vector<NumberedRay> rays);

  // Calls visit(ray) once for each ray that meets a closed box, and for no other. Returns how many rays and rows of
  // bins were looked at for that.
  template <class Visit>
  std::size_t for_each_met(const Box& box, const Visit& visit) const;

 private:
  // Cuts the range of the rays' coordinates along an axis. The bin of a number never falls as the number grows.
  struct Axis {
    double lower = 0, upper = 0, bins_per_unit = 0;
    std::size_t bins = 1;

    // Written so that NaN, of 0 times infinity, has the first bin. Where the range overflows all have it; where it is
    // 0, or nearly, what is above has the last one.
    [[nodiscard]] std::size_t bin(double x) const {
      const double place = x > lower ? (x - lower) * bins_per_unit : 0.0, last = static_cast<double>(bins - 1);
      return place >= last ? bins - 1 : place > 0.0 ? static_cast<std::size_t>(place) : 0;
    }
  };

  static Axis axis_of(const std::vector<NumberedRay>& rays, int axis, std::size_t bins);
  [[nodiscard]] std::size_t bin_of(const NumberedRay& ray) const {
    return z_.bin(ray.origin.z) * y_.bins + y_.bin(ray.origin.y);
  }

  Axis y_, z_;
  double least_x_ = 0;
  std::vector<NumberedRay> rays_;      // bin by bin, y fastest
  std::vector<std::uint32_t> begins_;  // of each bin in rays_, and the end of the last one
};

template <class Visit>
std::size_t BinnedRays::for_each_met(const Box& box, const Visit& visit) const {
  if (box.upper.x < least_x_ || box.upper.y < y_.lower || box.lower.y > y_.upper || box.upper.z < z_.lower ||
      box.lower.z > z_.upper) {
    return 0;
  }
  const std::size_t first = y_.bin(box.lower.y), last = y_.bin(box.upper.y), last_row = z_.bin(box.upper.z);
  std::size_t looked = 0;
  for (std::size_t row = z_.bin(box.lower.z); row <= last_row; ++row) {
    const std::size_t begin = begins_[row * y_.bins + first], end = begins_[row * y_.bins + last + 1];
    looked += end - begin + 1;
    for (std::size_t i = begin; i < end; ++i) {
      if (rays_[i].meets(box)) visit(rays_[i]);
    }
  }
  return looked;
}

}  // namespace raycone
