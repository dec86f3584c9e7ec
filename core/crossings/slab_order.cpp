#include "core/crossings/slab_order.h"

#include <algorithm>

#include "core/machine/buckets.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

constexpr std::size_t kGroup = 128;           // triangles
constexpr std::size_t kBinsPerLength = 2048;  // of the mesh along the axis
// What a triangle of a class may be long, as parts of the mesh; longer ones are in the last class.
constexpr double kClasses[] = {1.0 / 1024, 1.0 / 128, 1.0 / 16};

Interval extent_of(const TriangleMesh& mesh, const Triangle& t, int axis) {
  const auto [lower, upper] =
      std::minmax({mesh.vertices[t[0]][axis], mesh.vertices[t[1]][axis], mesh.vertices[t[2]][axis]});
  return {lower, upper};
}

// Bins by length and position along the axis, as parts of the mesh.
class AxisBins {
 public:
  AxisBins(const TriangleMesh& mesh, int axis) {
    if (mesh.triangles.empty()) return;
    const Box box = bounding_box(mesh);
    lower_ = box.lower[axis];
    length_ = box.upper[axis] - lower_;
  }

  // Short triangles first, those of a class by their lower end.
  [[nodiscard]] std::size_t bucket(const Interval& extent) const {
    const double length = (extent.upper - extent.lower) / length_;
    std::size_t of_class = 0;
    while (of_class < std::size(kClasses) && length > kClasses[of_class]) ++of_class;
    const double bin = (extent.lower - lower_) / length_ * static_cast<double>(kBinsPerLength);
    // Written so that NaN, of a flat mesh or one whose length overflows, has a bin.
    const double within = bin > 0.0 ? std::min(bin, static_cast<double>(kBinsPerLength - 1)) : 0.0;
    return of_class * kBinsPerLength + static_cast<std::size_t>(within);
  }
  static constexpr std::size_t kBuckets = (std::size(kClasses) + 1) * kBinsPerLength;

 private:
  double lower_ = 0.0, length_ = 1.0;
};

std::vector<std::uint32_t> ordered(const TriangleMesh& mesh, int axis) {
  const AxisBins bins(mesh, axis);
  const Buckets<std::uint32_t> buckets(
      mesh.triangles.size(), AxisBins::kBuckets, [&](std::size_t begin, std::size_t end, const auto& emit) {
        for (std::size_t i = begin; i < end; ++i) {
          emit(bins.bucket(extent_of(mesh, mesh.triangles[i], axis)), static_cast<std::uint32_t>(i));
        }
      });
  return {buckets.all().begin(), buckets.all().end()};
}

}  // namespace

SlabOrder::SlabOrder(const TriangleMesh& mesh, int axis)
    : triangles_(ordered(mesh, axis)), groups_((triangles_.size() + kGroup - 1) / kGroup) {
  constexpr std::size_t kGroupsOfATask = 64;
  parallel_for_each(groups_.size(), kGroupsOfATask, [&](std::size_t n) {
    const std::span<const std::uint32_t> group = (*this)[static_cast<std::uint32_t>(n)];
    groups_[n] = extent_of(mesh, mesh.triangles[group.front()], axis);
    for (const std::uint32_t triangle : group) {
      groups_[n] = hull(groups_[n], extent_of(mesh, mesh.triangles[triangle], axis));
    }
  });
}

std::vector<std::uint32_t> SlabOrder::groups_in(double lower, double upper) const {
  std::vector<std::uint32_t> met;
  for (std::size_t n = 0; n < groups_.size(); ++n) {
    if (groups_[n].lower <= upper && groups_[n].upper >= lower) met.push_back(static_cast<std::uint32_t>(n));
  }
  return met;
}

std::span<const std::uint32_t> SlabOrder::operator[](std::uint32_t group) const {
  const std::size_t begin = group * kGroup;
  return std::span(triangles_).subspan(begin, std::min(kGroup, triangles_.size() - begin));
}

}  // namespace raycone
