#include "core/orientation/surface_samples.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <mutex>

#include "core/exact/predicates.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// In (0, 1], as if random (splitmix64 over the coordinates; Steele, Lea, Flood 2014).
double number_of(const CanonicalFace& face) {
  std::uint64_t state = 0;
  for (const Vec3& corner : face.corners) {
    for (int axis = 0; axis < 3; ++axis) {
      state = (state ^ std::bit_cast<std::uint64_t>(corner[axis])) + 0x9E3779B97F4A7C15;
      state = (state ^ state >> 30) * 0xBF58476D1CE4E5B9;
      state = (state ^ state >> 27) * 0x94D049BB133111EB;
      state ^= state >> 31;
    }
  }
  return static_cast<double>((state >> 11) + 1) * 0x1p-53;
}

double area_of(const CanonicalFace& face) {
  const Vec3 normal = cross(face.corners[1] - face.corners[0], face.corners[2] - face.corners[0]);
  return 0.5 * std::sqrt(dot(normal, normal));
}

struct RankedFace {
  double priority;
  double area;
  CanonicalFace face;

  friend bool operator<(const RankedFace& a, const RankedFace& b) {
    return a.priority != b.priority ? a.priority > b.priority : a.face < b.face;
  }
};

void keep_first(std::vector<RankedFace>& ranked, std::size_t count) {
  if (ranked.size() <= count) return;
  std::nth_element(ranked.begin(), ranked.begin() + static_cast<std::ptrdiff_t>(count), ranked.end());
  ranked.resize(count);
}

// The sign of the normal's component, exactly.
int normal_sign(const CanonicalFace& face, int axis) {
  const auto turned = [&](const Vec3& p) { return Vec3{p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]}; };
  return exact_edge_orientation(turned(face.corners[0]), turned(face.corners[1]), turned(face.corners[2]));
}

// Of a face that runs around its corners in their order.
int side_of_perturbed(const CanonicalFace& face, const Vec3& q) {
  if (const int side = plane_side(face.corners[0], face.corners[1], face.corners[2], q); side != 0) return side;
  for (int axis = 0; axis < 3; ++axis) {
    if (const int sign = normal_sign(face, axis); sign != 0) return sign;
  }
  return 1;  // no area: no sample
}

}  // namespace

std::vector<SurfaceSample> sample_surface(const std::vector<Triangle>& faces, const std::vector<Vec3>& vertices,
                                          std::size_t count) {
  constexpr std::size_t kGrain = 4096;
  std::vector<RankedFace> ranked;
  std::mutex mutex;
  parallel_for(faces.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<RankedFace> part;
    for (std::size_t i = begin; i < end; ++i) {
      const CanonicalFace face = canonical_face(faces[i], vertices);
      const double area = area_of(face);
      if (area > 0.0 && std::isfinite(area)) part.push_back({area / number_of(face), area, face});
      if (part.size() > 4 * count + kGrain) keep_first(part, count + 1);
    }
    keep_first(part, count + 1);
    const std::lock_guard<std::mutex> lock(mutex);
    ranked.insert(ranked.end(), part.begin(), part.end());
  });
  keep_first(ranked, count + 1);
  std::sort(ranked.begin(), ranked.end());
  double least = 0.0;  // what each sample stands for at least
  if (ranked.size() > count) {
    least = ranked.back().priority;
    ranked.pop_back();
  }
  std::vector<SurfaceSample> samples;
  for (const RankedFace& r : ranked) {
    const Vec3 middle =
        (1.0 / 3.0) * r.face.corners[0] + (1.0 / 3.0) * r.face.corners[1] + (1.0 / 3.0) * r.face.corners[2];
    samples.push_back({middle, std::max(r.area, least), r.face, r.face.sign * side_of_perturbed(r.face, middle)});
  }
  return samples;
}

}  // namespace raycone
