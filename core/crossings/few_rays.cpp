#include "core/crossings/few_rays.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>

namespace raycone {
namespace {

// A set of queries: bit i stands for the i-th.
using Queries = std::uint64_t;
static_assert(kFewRays <= std::numeric_limits<Queries>::digits);

// The queries by one of their coordinates, which stands for a bin: of two numbers, the larger one never has the lesser
// bin.
class ByCoordinate {
 public:
  // Precondition: at least one query.
  ByCoordinate(std::span<const Vec3> queries, int axis) {
    const auto [least, most] = std::ranges::minmax(queries, {}, [&](const Vec3& q) { return q[axis]; });
    lower_ = least[axis];
    upper_ = most[axis];
    bins_per_unit_ = kBins / (upper_ - lower_);
    for (std::size_t i = 0; i < queries.size(); ++i) below_[bin(queries[i][axis]) + 1] |= Queries{1} << i;
    for (std::size_t n = 1; n < below_.size(); ++n) below_[n] |= below_[n - 1];
  }

  // Those from `lower` to `upper`, and perhaps some that are nearly there.
  [[nodiscard]] Queries within(double lower, double upper) const {
    if (upper < lower_ || lower > upper_) return 0;
    return below_[bin(upper) + 1] & ~below_[bin(lower)];
  }
  [[nodiscard]] Queries up_to(double upper) const { return upper < lower_ ? 0 : below_[bin(upper) + 1]; }

 private:
  static constexpr std::size_t kBins = 256;

  // Written so that NaN, of 0 times infinity, has the first bin. Where the queries' range overflows they all have it;
  // where it is 0, or nearly, what is above has the last one.
  [[nodiscard]] std::size_t bin(double x) const {
    const double place = x > lower_ ? (x - lower_) * bins_per_unit_ : 0.0;
    if (place >= kBins - 1) return kBins - 1;
    return place > 0.0 ? static_cast<std::size_t>(place) : 0;
  }

  double lower_, upper_, bins_per_unit_;
  std::array<Queries, kBins + 1> below_{};  // those of lesser bins
};

}  // namespace

void for_each_candidate(const TriangleMesh& mesh, std::span<const Vec3> queries,
                        const std::function<void(const RayCandidate&)>& visit) {
  if (queries.empty()) return;
  const ByCoordinate by_x(queries, 0), by_y(queries, 1), by_z(queries, 2);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& corners = mesh.triangles[t];
    const Vec3 &a = mesh.vertices[corners[0]], &b = mesh.vertices[corners[1]], &c = mesh.vertices[corners[2]];
    Queries met = by_y.within(std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y}));
    if (met == 0) continue;
    met &= by_z.within(std::min({a.z, b.z, c.z}), std::max({a.z, b.z, c.z}));
    if (met == 0) continue;
    for (met &= by_x.up_to(std::max({a.x, b.x, c.x})); met != 0; met &= met - 1) {
      visit({static_cast<std::uint32_t>(std::countr_zero(met)), static_cast<std::uint32_t>(t)});
    }
  }
}

}  // namespace raycone
