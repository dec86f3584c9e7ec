#include "core/orientation/nesting.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "core/data/box.h"
#include "core/data/triangle_mesh.h"
#include "core/machine/threads.h"
#include "core/mesh/ray_grid.h"
#include "core/orientation/box_pairs.h"
#include "core/orientation/ray_sums.h"

namespace raycone {
namespace {

// For each box those that hold it.
std::vector<std::vector<std::uint32_t>> boxes_around(const std::vector<Box>& boxes) {
  std::vector<std::vector<std::uint32_t>> around(boxes.size());
  for_each_overlapping_pair(boxes, [&](std::uint32_t i, std::uint32_t j) {
    if (contains(boxes[i], boxes[j])) around[j].push_back(i);
    if (contains(boxes[j], boxes[i])) around[i].push_back(j);
  });
  return around;
}

// What points of a surface say of another one: whether its winding number is 0 at some, and something else at some.
struct Says {
  bool misses = false, hits = false;

  void add(std::int64_t winding) { (winding == 0 ? misses : hits) = true; }
};

struct Verdict {
  Says clear;  // points that are not near the other surface
  Says any;    // not on it

  [[nodiscard]] bool excludes() const { return clear.misses; }
  [[nodiscard]] bool is_within() const { return !clear.misses && (clear.hits || (any.hits && !any.misses)); }
};

// How closely a surface is looked at: at so many vertices, or at all points.
enum class Look { kOne, kFew, kAll };

using Numbers = std::vector<std::uint32_t>;  // of surfaces

// Looks at points of surfaces, and tells which ones lie within another one. Thread-safe.
class Nesting {
 public:
  Nesting(const std::vector<const ClosedSurface*>& surfaces, const std::vector<Vec3>& vertices)
      : surfaces_(surfaces), vertices_(vertices), most_on_faces_(most_on_faces(surfaces.size())) {
    for (const ClosedSurface* surface : surfaces) boxes_.push_back(bounding_box(surface->faces, vertices));
  }

  [[nodiscard]] const std::vector<Box>& boxes() const { return boxes_; }

  // Of `inner`, whose boxes the box of `outer` holds, those that lie within it.
  [[nodiscard]] Numbers within(std::uint32_t outer, Numbers inner) const {
    inner = not_excluded(outer, inner, Look::kOne);
    Numbers others;
    Numbers found = split_off_apart(outer, inner, others);
    for (const Look look : {Look::kFew, Look::kAll}) others = not_excluded(outer, others, look);
    found.insert(found.end(), others.begin(), others.end());
    std::ranges::sort(found);
    return found;
  }

 private:
  // Of each of so many surfaces, all of which may touch all others.
  static std::size_t most_on_faces(std::size_t surfaces) {
    constexpr std::size_t kLeast = 16, kMost = 1024, kOfAllPairs = std::size_t{1} << 24;
    return std::clamp(kOfAllPairs / std::max<std::size_t>(surfaces * surfaces, 1), kLeast, kMost);
  }

  [[nodiscard]] std::vector<Vec3> points_of(std::uint32_t surface, Look look) const {
    constexpr std::size_t kFewFaces = 5;  // enough nearly always where one is not around
    const ClosedSurface& of = *surfaces_[surface];
    if (look == Look::kOne) return {vertices_[of.faces.front()[0]]};
    if (look == Look::kFew) {
      std::vector<Vec3> points;
      for (std::size_t n = 0; n < std::min(kFewFaces, of.faces.size()); ++n) {
        for (const std::uint32_t v : of.faces[n]) points.push_back(vertices_[v]);
      }
      return points;
    }
    std::vector<Vec3> points = vertices_of(of, vertices_);
    const std::vector<Vec3> on_faces = points_on_faces(of, vertices_, boxes_[surface], most_on_faces_);
    points.insert(points.end(), on_faces.begin(), on_faces.end());
    return points;
  }

  // Those of `inner` that may lie within `outer`, as far as this look tells. The last look (kAll) decides.
  [[nodiscard]] Numbers not_excluded(std::uint32_t outer, const Numbers& inner, Look look) const {
    constexpr std::size_t kMostTogether = std::size_t{1} << 20;  // in memory
    Numbers left;
    std::vector<Vec3> points;
    std::vector<std::size_t> ends;
    for (std::size_t begin = 0, n = 0; n < inner.size();) {
      const std::vector<Vec3> more = points_of(inner[n], look);
      points.insert(points.end(), more.begin(), more.end());
      ends.push_back(points.size());
      if (++n < inner.size() && points.size() < kMostTogether) continue;
      const std::vector<Verdict> verdicts = verdicts_of(outer, points, ends);
      for (std::size_t i = begin; i < n; ++i) {
        const Verdict& verdict = verdicts[i - begin];
        if (look == Look::kAll ? verdict.is_within() : !verdict.excludes()) left.push_back(inner[i]);
      }
      begin = n;
      points.clear();
      ends.clear();
    }
    return left;
  }

  // Per surface: what its points say, which end at ends[n].
  [[nodiscard]] std::vector<Verdict> verdicts_of(std::uint32_t outer, std::span<const Vec3> points,
                                                 std::span<const std::size_t> ends) const {
    const Box& box = boxes_[outer];
    const double near = 0x1p-20 * half_longest_side(box) + 0x1p-45 * largest_coordinate(box);
    const std::vector<RaySum> sums = ray_sums(surfaces_[outer]->faces, vertices_, points, near);
    std::vector<Verdict> verdicts(ends.size());
    std::size_t at = 0;
    for (std::size_t n = 0; n < ends.size(); ++n) {
      for (; at < ends[n]; ++at) {
        if (!sums[at].is_near) verdicts[n].clear.add(sums[at].winding);
        if (!sums[at].on_surface) verdicts[n].any.add(sums[at].winding);
      }
    }
    return verdicts;
  }

  // Those of `inner` to whose boxes no face of `outer` comes near; the rest go to `others`.
  [[nodiscard]] Numbers split_off_apart(std::uint32_t outer, const Numbers& inner, Numbers& others) const {
    if (inner.empty()) return {};
    const Vec3 small = 0.125 * (0.5 * boxes_[outer].upper - 0.5 * boxes_[outer].lower);
    Numbers small_ones, large_ones;
    std::vector<Vec3> corners;
    for (const std::uint32_t i : inner) {
      const Vec3 half = 0.5 * boxes_[i].upper - 0.5 * boxes_[i].lower;
      const bool is_small = half.x <= small.x && half.y <= small.y && half.z <= small.z;
      (is_small ? small_ones : large_ones).push_back(i);
      if (is_small) corners.push_back(boxes_[i].lower);
    }
    std::vector<bool> meets_small(small_ones.size(), false), meets_large(large_ones.size(), false);
    std::optional<RayGrid> grid;
    if (!corners.empty()) grid.emplace(corners);
    for (const Triangle& t : surfaces_[outer]->faces) {
      const Box face = box_of(vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]);
      const auto mark = [&](const Numbers& ones, std::vector<bool>& meets, std::size_t n) {
        if (!meets[n] && overlap(face, boxes_[ones[n]])) meets[n] = true;
      };
      for (std::size_t n = 0; n < large_ones.size(); ++n) mark(large_ones, meets_large, n);
      if (!grid) continue;
      const Vec3 lower = face.lower - small - small;  // lower corners of what may reach the face
      grid->for_each_ray(lower, face.upper, face.upper, lower.x,
                         [&](std::size_t n) { mark(small_ones, meets_small, n); });
    }
    Numbers apart;
    for (std::size_t n = 0; n < small_ones.size(); ++n) (meets_small[n] ? others : apart).push_back(small_ones[n]);
    for (std::size_t n = 0; n < large_ones.size(); ++n) (meets_large[n] ? others : apart).push_back(large_ones[n]);
    std::ranges::sort(others);
    return apart;
  }

  const std::vector<const ClosedSurface*>& surfaces_;
  const std::vector<Vec3>& vertices_;
  std::size_t most_on_faces_;
  std::vector<Box> boxes_;
};

// For each of the numbers in the lists, ascending, the lists that it is in.
std::vector<Numbers> inverse_of(const std::vector<Numbers>& lists) {
  std::vector<Numbers> inverse(lists.size());
  for (std::uint32_t n = 0; n < lists.size(); ++n) {
    for (const std::uint32_t i : lists[n]) inverse[i].push_back(n);
  }
  return inverse;
}

// Of quarters, which do not overflow.
double size_of(const Box& box) {
  const Vec3 quarter = 0.25 * box.upper - 0.25 * box.lower;
  return quarter.x + quarter.y + quarter.z;
}

// Surfaces that have not been found within another one, by the lower corners of their boxes.
class Unsurrounded {
 public:
  // `surfaces`: ascending.
  Unsurrounded(Numbers surfaces, const std::vector<Box>& boxes)
      : boxes_(boxes), surfaces_(std::move(surfaces)), is_surrounded_(boxes.size(), false) {
    file();
  }
  Unsurrounded(const Unsurrounded&) = delete;
  Unsurrounded& operator=(const Unsurrounded&) = delete;

  [[nodiscard]] bool empty() const { return surfaces_.empty(); }

  // Those whose boxes the box of `outer` holds, ascending.
  [[nodiscard]] Numbers in_box_of(std::uint32_t outer) const {
    const Box& box = boxes_[outer];
    Numbers inner;
    grid_->for_each_ray(box.lower, box.upper, box.upper, box.lower.x, [&](std::size_t n) {  // as of a flat triangle
      const std::uint32_t i = surfaces_[n];
      if (i != outer && !is_surrounded_[i] && contains(box, boxes_[i])) inner.push_back(i);
    });
    std::ranges::sort(inner);
    return inner;
  }

  void drop(const Numbers& surfaces) {
    for (const std::uint32_t i : surfaces) is_surrounded_[i] = true;
    dropped_ += surfaces.size();
    if (4 * dropped_ >= surfaces_.size()) file();  // time to go on without them
  }

  [[nodiscard]] Numbers take() {
    file();
    return std::move(surfaces_);
  }

 private:
  void file() {
    std::erase_if(surfaces_, [&](std::uint32_t i) { return is_surrounded_[i]; });
    dropped_ = 0;
    corners_.clear();
    for (const std::uint32_t i : surfaces_) corners_.push_back(boxes_[i].lower);
    if (!corners_.empty()) grid_.emplace(corners_);
  }

  const std::vector<Box>& boxes_;
  Numbers surfaces_;
  std::vector<bool> is_surrounded_;  // per surface
  std::size_t dropped_ = 0;
  std::vector<Vec3> corners_;
  std::optional<RayGrid> grid_;
};

}  // namespace

std::vector<std::vector<std::uint32_t>> surfaces_around(const std::vector<const ClosedSurface*>& surfaces,
                                                        const std::vector<Vec3>& vertices) {
  const Nesting nesting(surfaces, vertices);
  std::vector<Numbers> within = inverse_of(boxes_around(nesting.boxes()));
  parallel_for_each(within.size(), [&](std::size_t outer) {
    if (!within[outer].empty()) {
      within[outer] = nesting.within(static_cast<std::uint32_t>(outer), std::move(within[outer]));
    }
  });
  return inverse_of(within);
}

std::vector<std::uint32_t> not_surrounded(std::vector<std::uint32_t> asked,
                                          const std::vector<const ClosedSurface*>& surfaces,
                                          const std::vector<Vec3>& vertices) {
  const Nesting nesting(surfaces, vertices);
  const std::vector<Box>& boxes = nesting.boxes();
  Numbers by_size(surfaces.size());
  std::iota(by_size.begin(), by_size.end(), 0U);
  std::ranges::stable_sort(by_size, std::greater(), [&](std::uint32_t i) { return size_of(boxes[i]); });
  Unsurrounded left(std::move(asked), boxes);
  for (const std::uint32_t outer : by_size) {
    if (left.empty()) break;
    Numbers inner = left.in_box_of(outer);
    if (inner.empty()) continue;
    inner = nesting.within(outer, std::move(inner));
    if (!inner.empty()) left.drop(inner);
  }
  return left.take();
}

}  // namespace raycone
