#include "core/intersections/curve_order.h"

#include <algorithm>
#include <cstddef>
#include <span>

#include "core/data/box.h"
#include "core/data/space_curve.h"
#include "core/machine/buckets.h"
#include "core/machine/threads.h"
#include "core/mesh/triangle_runs.h"

namespace raycone {

std::vector<std::uint32_t> triangles_along_curve(const TriangleMesh& mesh) {
  constexpr unsigned kBitsPerAxis = 11, kNumberBits = 31, kBucketBits = 12;
  static_assert(kMaxTriangles < std::uint64_t{1} << kNumberBits && kNumberBits + 3 * kBitsPerAxis == 64);
  const SpaceCurve curve(half_of(bounding_box(mesh)), kBitsPerAxis);
  const auto place_and_number = [&](std::size_t triangle) {
    const Box half = half_of(box_of_triangle(mesh, static_cast<std::uint32_t>(triangle)));
    return curve.place(middle(half)) << kNumberBits | triangle;
  };
  const Buckets<std::uint64_t> buckets(mesh.triangles.size(), std::size_t{1} << kBucketBits,
                                       [&](std::size_t begin, std::size_t end, auto emit) {
                                         for (std::size_t i = begin; i < end; ++i) {
                                           const std::uint64_t at = place_and_number(i);
                                           emit(static_cast<std::size_t>(at >> (64 - kBucketBits)), at);
                                         }
                                       });
  std::vector<std::uint32_t> triangles(mesh.triangles.size());
  parallel_for_each(buckets.count(), 16, [&](std::size_t n) {
    const std::span<std::uint64_t> bucket = buckets[n];
    std::ranges::sort(bucket);
    std::ranges::transform(bucket, triangles.begin() + (bucket.data() - buckets[0].data()), [](std::uint64_t at) {
      return static_cast<std::uint32_t>(at & ((std::uint64_t{1} << kNumberBits) - 1));
    });
  });
  return triangles;
}

}  // namespace raycone
