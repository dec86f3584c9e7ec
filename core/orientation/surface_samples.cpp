#include "core/orientation/surface_samples.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <mutex>
#include <utility>

#include "core/data/split_mix.h"
#include "core/exact/predicates.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// As if random, by the coordinates alone.
std::uint64_t random_word_of(const Vec3& p) {
  std::uint64_t state = 0;
  for (int axis = 0; axis < 3; ++axis) {
    state = split_mix((state ^ std::bit_cast<std::uint64_t>(p[axis])) + kSplitMixStep);
  }
  return state;
}

// In (0, 1], as if random, by the coordinates; whatever the order of corners.
double number_of(const Triangle& t, const std::vector<std::uint64_t>& numbers) {
  return static_cast<double>((split_mix(numbers[t[0]] + numbers[t[1]] + numbers[t[2]]) >> 11) + 1) * 0x1p-53;
}

double area_of(const Vec3& p, const Vec3& q, const Vec3& r) {
  const Vec3 normal = cross(q - p, r - p);
  return 0.5 * std::sqrt(dot(normal, normal));
}

struct RankedFace {
  double priority;
  double area;
  CanonicalFace face;
  Triangle corners;
};

// Faces that became the same by moving are told apart by where they were: they may face either way.
struct RanksBefore {
  const std::vector<Vec3>& exact;

  bool operator()(const RankedFace& a, const RankedFace& b) const {
    if (a.priority != b.priority) return a.priority > b.priority;
    if (const auto order = a.face <=> b.face; order != 0) return order < 0;
    return canonical_face(a.corners, exact) < canonical_face(b.corners, exact);
  }
};

// The first `count` of those that it was given, nearly without work for others.
class FirstRanked {
 public:
  FirstRanked(std::size_t count, const NumberedVertices& vertices) : count_(count), vertices_(vertices) {}

  void add(const Triangle& t) {
    const Vec3 &p = vertices_.at[t[0]], &q = vertices_.at[t[1]], &r = vertices_.at[t[2]];
    const double number = number_of(t, vertices_.number);
    // What the order of corners changes is less; exactly that decides which faces come near being taken.
    constexpr double kRounding = 1e-14;
    const double most = area_of(p, q, r) + kRounding * (dot(q - p, q - p) + dot(r - p, r - p));
    if (most < least_ * number) return;
    const CanonicalFace face = canonical_face(t, vertices_.at);
    const double area = area_of(face.corners[0], face.corners[1], face.corners[2]);
    if (!(area > 0.0 && std::isfinite(area))) return;
    ranked_.push_back({area / number, area, face, t});
    if (ranked_.size() > 4 * count_ + kSpare) cut();
  }

  std::vector<RankedFace> take() {
    cut();
    return std::move(ranked_);
  }

 private:
  static constexpr std::size_t kSpare = 256;

  void cut() {
    if (ranked_.size() <= count_) return;
    std::nth_element(ranked_.begin(), ranked_.begin() + static_cast<std::ptrdiff_t>(count_), ranked_.end(),
                     RanksBefore{vertices_.exact});
    ranked_.resize(count_);
    least_ = std::ranges::min(ranked_, {}, &RankedFace::priority).priority;
  }

  std::size_t count_;
  const NumberedVertices& vertices_;
  double least_ = 0.0;  // lower priorities are not among the first
  std::vector<RankedFace> ranked_;
};

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

// At coordinates `b` and `c` of the second and third corner.
SurfaceSample sample_on(const CanonicalFace& face, double b, double c, double weight) {
  const Vec3 at = (1.0 - b - c) * face.corners[0] + b * face.corners[1] + c * face.corners[2];
  return {at, weight, face, face.sign * side_of_perturbed(face, at)};
}

// The middles of parts² triangles, which are alike.
void add_parts(const SurfaceSample& sample, int parts, std::vector<SurfaceSample>& result) {
  constexpr double kThird = 1.0 / 3.0;
  const double step = 1.0 / parts, weight = sample.weight * step * step;
  for (int i = 0; i < parts; ++i) {
    for (int j = 0; i + j < parts; ++j) {
      result.push_back(sample_on(sample.face, (i + kThird) * step, (j + kThird) * step, weight));
      if (i + j + 1 == parts) continue;
      result.push_back(sample_on(sample.face, (i + 2 * kThird) * step, (j + 2 * kThird) * step, weight));
    }
  }
}

}  // namespace

NumberedVertices::NumberedVertices(std::vector<Vec3> moved, const std::vector<Vec3>& exact_vertices)
    : at(std::move(moved)), number(at.size()), exact(exact_vertices) {
  constexpr std::size_t kGrain = 4096;
  parallel_for_each(at.size(), kGrain, [&](std::size_t v) { number[v] = random_word_of(at[v]); });
}

std::vector<SurfaceSample> sample_surface(const std::vector<Triangle>& faces, const NumberedVertices& vertices,
                                          std::size_t count) {
  constexpr std::size_t kGrain = 4096;
  std::vector<RankedFace> ranked;
  std::mutex mutex;
  parallel_for(faces.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    FirstRanked first(count + 1, vertices);
    for (std::size_t i = begin; i < end; ++i) first.add(faces[i]);
    const std::vector<RankedFace> part = first.take();
    const std::lock_guard<std::mutex> lock(mutex);
    ranked.insert(ranked.end(), part.begin(), part.end());
  });
  std::sort(ranked.begin(), ranked.end(), RanksBefore{vertices.exact});
  double least = 0.0;  // what each sample stands for at least
  if (ranked.size() > count) {
    least = ranked[count].priority;
    ranked.resize(count);
  }
  std::vector<SurfaceSample> samples;
  for (const RankedFace& r : ranked) {
    const Vec3 middle =
        (1.0 / 3.0) * r.face.corners[0] + (1.0 / 3.0) * r.face.corners[1] + (1.0 / 3.0) * r.face.corners[2];
    samples.push_back({middle, std::max(r.area, least), r.face, r.face.sign * side_of_perturbed(r.face, middle)});
  }
  return samples;
}

std::vector<SurfaceSample> divided(const std::vector<SurfaceSample>& samples, double area) {
  constexpr double kMostParts = 32.0;  // along a side, lest an area of next to nothing makes too many
  std::vector<SurfaceSample> result;
  for (const SurfaceSample& sample : samples) {
    const auto& [p, q, r] = sample.face.corners;
    const auto parts = static_cast<int>(std::min(std::sqrt(area_of(p, q, r) / area), kMostParts));
    if (parts < 2) {
      result.push_back(sample);
    } else {
      add_parts(sample, parts, result);
    }
  }
  return result;
}

}  // namespace raycone
