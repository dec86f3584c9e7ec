#include "core/orientation/nesting.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "core/data/box.h"
#include "core/machine/threads.h"
#include "core/mesh/ray_grid.h"
#include "core/orientation/canonical_face.h"
#include "core/orientation/ray_sums.h"

namespace raycone {
namespace {

// That along which the fewest boxes lie beside each other: of all parts in a plane, one within it.
int axis_to_sweep(const std::vector<Box>& boxes) {
  Box all = empty_box();
  for (const Box& box : boxes) extend(all, box);
  std::array<double, 3> beside{};  // their extents in all, in units of that of all together
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto half_extent = [n = static_cast<int>(axis)](const Box& box) {  // by halves, which do not overflow
      return box.upper[n] / 2 - box.lower[n] / 2;
    };
    for (const Box& box : boxes)
      beside[axis] += half_extent(box) < half_extent(all) ? half_extent(box) / half_extent(all) : 1.0;
  }
  return static_cast<int>(std::ranges::min_element(beside) - beside.begin());
}

// For each box those that hold it.
std::vector<std::vector<std::uint32_t>> boxes_around(const std::vector<Box>& boxes) {
  const int axis = axis_to_sweep(boxes);
  std::vector<std::uint32_t> order(boxes.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, {}, [&](std::uint32_t i) { return std::pair(boxes[i].lower[axis], i); });
  std::vector<std::vector<std::uint32_t>> around(boxes.size());
  std::vector<std::uint32_t> met;
  for (const std::uint32_t i : order) {
    std::erase_if(met, [&](std::uint32_t j) { return boxes[j].upper[axis] < boxes[i].lower[axis]; });
    for (const std::uint32_t j : met) {
      if (contains(boxes[j], boxes[i])) around[i].push_back(j);
      if (contains(boxes[i], boxes[j])) around[j].push_back(i);
    }
    met.push_back(i);
  }
  return around;
}

// Vertices of a surface, each once: the first ones that its faces come to, up to `most`. `last_seen` is per vertex the
// time at which it was seen last, before `now`.
std::vector<std::uint32_t> vertices_of(const ClosedSurface& surface, std::size_t most, std::uint64_t now,
                                       std::vector<std::uint64_t>& last_seen) {
  std::vector<std::uint32_t> found;
  for (const Triangle& t : surface.faces) {
    for (const std::uint32_t v : t) {
      if (std::exchange(last_seen[v], now) == now) continue;
      found.push_back(v);
      if (found.size() == most) return found;
    }
  }
  return found;
}

// By halves, which do not overflow.
double half_longest_side(const Box& box) {
  const Vec3 half = 0.5 * box.upper - 0.5 * box.lower;
  return std::max({half.x, half.y, half.z});
}

// Points beside the faces of a surface, in pairs: one on either side.
class PointsBesideFaces {
 public:
  // `most`: points of a surface, where its faces are not more.
  PointsBesideFaces(const ClosedSurface& surface, const std::vector<Vec3>& vertices, const Box& box, std::size_t most)
      : extent_(half_longest_side(box)) {
    std::vector<CanonicalFace> faces;
    const double least = surface.faces.size() > kManyFaces ? extent_ / 64 : 0.0;
    for (const Triangle& t : surface.faces) {
      const CanonicalFace face = canonical_face(t, vertices);
      if (side_of(face) >= least) faces.push_back(face);
    }
    const double share = std::sqrt(static_cast<double>(most) / static_cast<double>(faces.size()));
    most_parts_ = std::clamp(std::floor(share), 1.0, kMostParts);
    for (const CanonicalFace& face : faces) add(face);
  }

  [[nodiscard]] std::vector<Vec3> take() { return std::move(points_); }

 private:
  static constexpr std::size_t kManyFaces = 4096;
  static constexpr double kMostParts = 16.0;  // of each side

  // Half its box's longest side.
  static double side_of(const CanonicalFace& face) {
    return half_longest_side(box_of(face.corners[0], face.corners[1], face.corners[2]));
  }

  // Of a face cut into parts like it, beside the middle of each.
  void add(const CanonicalFace& face) {
    const double parts = std::clamp(std::ceil(kMostParts * (side_of(face) / extent_)), 1.0, most_parts_);
    const Vec3 aside = step_aside(face);
    const auto count = static_cast<int>(parts);
    for (int i = 0; i < count; ++i) {
      for (int j = 0; i + j < count; ++j) {
        add_beside(face, (i + 1.0 / 3) / parts, (j + 1.0 / 3) / parts, aside);
        if (i + j + 1 < count) add_beside(face, (i + 2.0 / 3) / parts, (j + 2.0 / 3) / parts, aside);
      }
    }
  }

  void add_beside(const CanonicalFace& face, double u, double v, const Vec3& aside) {
    const auto& [a, b, c] = face.corners;
    const Vec3 point = (1 - u - v) * a + u * b + v * c;
    for (const double side : {-1.0, 1.0}) {
      Vec3 beside = point + side * aside;
      for (int axis = 0; axis < 3; ++axis) beside[axis] = std::clamp(beside[axis], -kLargest, kLargest);
      points_.push_back(beside);
    }
  }

  // Farther than the point is off the face by rounding, along the axis that is the least along the face.
  static Vec3 step_aside(const CanonicalFace& face) {
    const auto& [a, b, c] = face.corners;
    const Vec3 along = 0.5 * b - 0.5 * a, other = 0.5 * c - 0.5 * a;
    // Only their directions matter: products of what is so scaled do not overflow.
    const double scale = 1.0 / std::max({largest_coordinate(along), largest_coordinate(other), kLeastScaled});
    const Vec3 normal = cross(scale * along, scale * other);
    int axis = 0;
    for (int n = 1; n < 3; ++n) axis = std::abs(normal[n]) > std::abs(normal[axis]) ? n : axis;
    Vec3 aside;
    aside[axis] = 0x1p-29 * side_of(face) + 0x1p-45 * largest_coordinate(box_of(a, b, c));
    return aside;
  }

  static constexpr double kLargest = std::numeric_limits<double>::max();
  static constexpr double kLeastScaled = std::numeric_limits<double>::min();
  double extent_;  // half the longest side of the box
  double most_parts_ = 1.0;
  std::vector<Vec3> points_;
};

// Where a surface is looked at.
struct Places {
  std::vector<std::uint32_t> vertices;
  std::vector<Vec3> beside;  // pairs of points
};

// What the points of a surface say of another one.
struct Verdict {
  bool misses = false;  // a point off the other surface has the winding number 0 there
  bool hits = false;    // or another one
};

// How closely surfaces are looked at.
enum class Look { kFew, kAll };  // some vertices; all, and beside faces

// Which surfaces lie within which.
class Nesting {
 public:
  Nesting(const std::vector<const ClosedSurface*>& surfaces, const std::vector<Vec3>& vertices)
      : surfaces_(surfaces), vertices_(vertices), last_seen_(vertices.size(), 0) {
    for (const ClosedSurface* surface : surfaces) boxes_.push_back(bounding_box(surface->faces, vertices));
  }

  [[nodiscard]] const std::vector<Box>& boxes() const { return boxes_; }

  // For some surfaces, where they are to be looked at. `most_beside`: points of each.
  [[nodiscard]] std::vector<Places> places_of(std::span<const std::uint32_t> of, Look look, std::size_t most_beside) {
    constexpr std::size_t kFew = 16;  // enough nearly always where one is not around
    const std::size_t most = look == Look::kFew ? kFew : std::numeric_limits<std::size_t>::max();
    std::vector<Places> places(of.size());
    for (std::size_t n = 0; n < of.size(); ++n) {
      const ClosedSurface& surface = *surfaces_[of[n]];
      places[n].vertices = vertices_of(surface, most, ++now_, last_seen_);
      if (look == Look::kFew) continue;
      places[n].beside = PointsBesideFaces(surface, vertices_, boxes_[of[n]], most_beside).take();
    }
    return places;
  }

  // What points of other surfaces say of `outer`.
  [[nodiscard]] std::vector<Verdict> verdicts(std::uint32_t outer, std::span<const Places* const> of) const {
    std::vector<Vec3> points;
    for (const Places* places : of) {
      for (const std::uint32_t v : places->vertices) points.push_back(vertices_[v]);
      points.insert(points.end(), places->beside.begin(), places->beside.end());
    }
    const std::vector<RaySum> sums = ray_sums(surfaces_[outer]->faces, vertices_, points);
    std::vector<Verdict> verdicts(of.size());
    auto sum = sums.begin();
    for (std::size_t n = 0; n < of.size(); ++n) {
      Verdict& verdict = verdicts[n];
      for (const auto end = sum + std::ssize(of[n]->vertices); sum != end; ++sum) {
        if (!sum->on_surface) (sum->winding == 0 ? verdict.misses : verdict.hits) = true;
      }
      // What one side of a point says alone may be rounding: it lies on the other surface.
      for (const auto end = sum + std::ssize(of[n]->beside); sum != end; sum += 2) {
        if (sum[0].on_surface || sum[1].on_surface || (sum[0].winding == 0) != (sum[1].winding == 0)) continue;
        (sum->winding == 0 ? verdict.misses : verdict.hits) = true;
      }
    }
    return verdicts;
  }

  // Whether no face of `outer` comes near the box of each of some surfaces: then one vertex tells of all of it. Also
  // false where that would take long to find out.
  [[nodiscard]] std::vector<bool> are_apart(std::uint32_t outer, std::span<const std::uint32_t> inner) const {
    constexpr std::size_t kMostComparisons = std::size_t{1} << 27;  // a fraction of a second
    const std::vector<Triangle>& faces = surfaces_[outer]->faces;
    std::vector<bool> apart(inner.size(), faces.size() <= kMostComparisons / std::max<std::size_t>(inner.size(), 1));
    if (inner.empty() || !apart.front()) return apart;
    for (const Triangle& t : faces) {
      const Box face = box_of(vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]);
      for (std::size_t n = 0; n < inner.size(); ++n) {
        if (apart[n] && overlap(face, boxes_[inner[n]])) apart[n] = false;
      }
    }
    return apart;
  }

  static bool may_be_within(const Verdict& verdict, Look look) {
    return !verdict.misses && (verdict.hits || look == Look::kFew);
  }

 private:
  const std::vector<const ClosedSurface*>& surfaces_;
  const std::vector<Vec3>& vertices_;
  std::vector<Box> boxes_;
  std::vector<std::uint64_t> last_seen_;  // vertices_of()
  std::uint64_t now_ = 0;
};

// Beside the faces of each of so many surfaces.
std::size_t most_beside(std::size_t surfaces) {
  constexpr std::size_t kMost = 2048, kOfAll = std::size_t{1} << 20;
  return std::clamp<std::size_t>(kOfAll / std::max<std::size_t>(surfaces, 1), 1, kMost);
}

// Leaves those in `around` that are around a surface as far as this look tells.
void keep_around(Nesting& nesting, Look look, std::vector<std::vector<std::uint32_t>>& around) {
  std::vector<std::uint32_t> inner;
  std::vector<std::vector<std::uint32_t>> within(around.size());  // places in `inner`
  for (std::uint32_t i = 0; i < around.size(); ++i) {
    if (around[i].empty()) continue;
    for (const std::uint32_t outer : around[i]) within[outer].push_back(static_cast<std::uint32_t>(inner.size()));
    inner.push_back(i);
  }
  const std::vector<Places> places = nesting.places_of(inner, look, most_beside(inner.size()));
  std::vector<std::vector<std::uint32_t>> dropped(around.size());  // places in `inner`
  parallel_for_each(around.size(), [&](std::size_t outer) {
    if (within[outer].empty()) return;
    std::vector<const Places*> of;
    for (const std::uint32_t n : within[outer]) of.push_back(&places[n]);
    const std::vector<Verdict> verdicts = nesting.verdicts(static_cast<std::uint32_t>(outer), of);
    for (std::size_t n = 0; n < of.size(); ++n) {
      if (!Nesting::may_be_within(verdicts[n], look)) dropped[outer].push_back(within[outer][n]);
    }
  });
  std::vector<std::vector<std::uint32_t>> not_around(inner.size());  // ascending
  for (std::uint32_t outer = 0; outer < around.size(); ++outer) {
    for (const std::uint32_t n : dropped[outer]) not_around[n].push_back(outer);
  }
  for (std::size_t n = 0; n < inner.size(); ++n) {
    std::erase_if(around[inner[n]],
                  [&](std::uint32_t outer) { return std::ranges::binary_search(not_around[n], outer); });
  }
}

// Takes from `around` the pairs of which the surfaces are apart.
std::vector<std::vector<std::uint32_t>> take_apart_ones(const Nesting& nesting,
                                                        std::vector<std::vector<std::uint32_t>>& around) {
  std::vector<std::vector<std::uint32_t>> within(around.size()), apart(around.size());
  for (std::uint32_t i = 0; i < around.size(); ++i) {
    for (const std::uint32_t outer : around[i]) within[outer].push_back(i);
  }
  parallel_for_each(around.size(), [&](std::size_t outer) {
    const std::vector<bool> are_apart = nesting.are_apart(static_cast<std::uint32_t>(outer), within[outer]);
    for (std::size_t n = 0; n < within[outer].size(); ++n) {
      if (are_apart[n]) apart[outer].push_back(within[outer][n]);
    }
  });
  std::vector<std::vector<std::uint32_t>> taken(around.size());  // ascending
  for (std::uint32_t outer = 0; outer < around.size(); ++outer) {
    for (const std::uint32_t i : apart[outer]) taken[i].push_back(outer);
  }
  for (std::size_t i = 0; i < around.size(); ++i) {
    std::erase_if(around[i], [&](std::uint32_t outer) { return std::ranges::binary_search(taken[i], outer); });
  }
  return taken;
}

// Of quarters, which do not overflow.
double size_of(const Box& box) {
  const Vec3 quarter = 0.25 * box.upper - 0.25 * box.lower;
  return quarter.x + quarter.y + quarter.z;
}

// Surfaces that have not been found within another one, by the lower corners of their boxes.
class Unsurrounded {
 public:
  Unsurrounded(std::vector<std::uint32_t> surfaces, const std::vector<Box>& boxes)
      : boxes_(boxes), surfaces_(std::move(surfaces)) {
    file();
  }

  [[nodiscard]] bool empty() const { return surfaces_.empty(); }
  [[nodiscard]] std::vector<std::uint32_t> at(const std::vector<std::size_t>& places) const {
    std::vector<std::uint32_t> surfaces;
    for (const std::size_t n : places) surfaces.push_back(surfaces_[n]);
    return surfaces;
  }

  // The places, until the next drop(), of those whose boxes the box of `outer` holds.
  [[nodiscard]] std::vector<std::size_t> in_box_of(std::uint32_t outer) const {
    const Box& box = boxes_[outer];
    std::vector<std::size_t> places;
    grid_->for_each_ray(box.lower, box.upper, box.upper, box.lower.x, [&](std::size_t n) {  // as of a flat triangle
      if (surfaces_[n] != outer && !is_surrounded_[n] && contains(box, boxes_[surfaces_[n]])) places.push_back(n);
    });
    std::ranges::sort(places);
    return places;
  }

  void drop(const std::vector<std::size_t>& places) {
    for (const std::size_t n : places) is_surrounded_[n] = true;
    dropped_ += places.size();
    if (4 * dropped_ >= surfaces_.size()) file();  // time to go on without them
  }

  [[nodiscard]] std::vector<std::uint32_t> take() {
    file();
    return std::move(surfaces_);
  }

 private:
  void file() {
    std::size_t n = 0;
    if (dropped_ > 0) std::erase_if(surfaces_, [&](std::uint32_t) { return is_surrounded_[n++]; });
    is_surrounded_.assign(surfaces_.size(), false);
    dropped_ = 0;
    corners_.clear();
    for (const std::uint32_t i : surfaces_) corners_.push_back(boxes_[i].lower);
    if (!corners_.empty()) grid_.emplace(corners_);
  }

  const std::vector<Box>& boxes_;
  std::vector<std::uint32_t> surfaces_;
  std::vector<bool> is_surrounded_;  // of these
  std::size_t dropped_ = 0;
  std::vector<Vec3> corners_;
  std::optional<RayGrid> grid_;
};

// Leaves those of the surfaces at `places` that lie within `outer` as far as this look tells.
void keep_within(Nesting& nesting, std::uint32_t outer, const Unsurrounded& surfaces, Look look,
                 std::vector<std::size_t>& places) {
  if (places.empty()) return;
  const std::vector<Places> of = nesting.places_of(surfaces.at(places), look, most_beside(places.size()));
  std::vector<const Places*> pointers;
  for (const Places& p : of) pointers.push_back(&p);
  const std::vector<Verdict> verdicts = nesting.verdicts(outer, pointers);
  std::size_t n = 0;
  std::erase_if(places, [&](std::size_t) { return !Nesting::may_be_within(verdicts[n++], look); });
}

// Of the surfaces at `places`, those that lie within `outer`.
std::vector<std::size_t> within(Nesting& nesting, std::uint32_t outer, const Unsurrounded& surfaces,
                                std::vector<std::size_t> places) {
  keep_within(nesting, outer, surfaces, Look::kFew, places);
  const std::vector<bool> are_apart = nesting.are_apart(outer, surfaces.at(places));
  std::vector<std::size_t> apart, others;
  for (std::size_t n = 0; n < places.size(); ++n) (are_apart[n] ? apart : others).push_back(places[n]);
  keep_within(nesting, outer, surfaces, Look::kAll, others);
  apart.insert(apart.end(), others.begin(), others.end());
  return apart;
}

}  // namespace

std::vector<std::vector<std::uint32_t>> surfaces_around(const std::vector<const ClosedSurface*>& surfaces,
                                                        const std::vector<Vec3>& vertices) {
  Nesting nesting(surfaces, vertices);
  std::vector<std::vector<std::uint32_t>> around = boxes_around(nesting.boxes());
  keep_around(nesting, Look::kFew, around);
  std::vector<std::vector<std::uint32_t>> found = take_apart_ones(nesting, around);
  keep_around(nesting, Look::kAll, around);
  for (std::size_t i = 0; i < found.size(); ++i) {
    found[i].insert(found[i].end(), around[i].begin(), around[i].end());
    std::ranges::sort(found[i]);
  }
  return found;
}

std::vector<std::uint32_t> not_surrounded(std::vector<std::uint32_t> asked,
                                          const std::vector<const ClosedSurface*>& surfaces,
                                          const std::vector<Vec3>& vertices) {
  Nesting nesting(surfaces, vertices);
  const std::vector<Box>& boxes = nesting.boxes();
  std::vector<std::uint32_t> by_size(surfaces.size());
  std::iota(by_size.begin(), by_size.end(), 0U);
  std::ranges::stable_sort(by_size, std::greater(), [&](std::uint32_t i) { return size_of(boxes[i]); });
  Unsurrounded left(std::move(asked), boxes);
  for (const std::uint32_t outer : by_size) {
    if (left.empty()) break;
    const std::vector<std::size_t> places = within(nesting, outer, left, left.in_box_of(outer));
    if (!places.empty()) left.drop(places);
  }
  return left.take();
}

}  // namespace raycone
