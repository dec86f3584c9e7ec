#include "core/sharpening/corner_gaps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/cells/source_plane.h"
#include "core/machine/numbers_where.h"
#include "core/machine/threads.h"
#include "core/sharpening/face_placement.h"
#include "core/sharpening/faces_at.h"
#include "core/sharpening/fill_gap.h"
#include "core/sharpening/filled_gaps.h"
#include "core/sharpening/gap.h"

namespace raycone {
namespace {

using Faces = std::vector<std::uint32_t>;

class CornerGaps {
 public:
  CornerGaps(const SurfaceMesh& surface, const SharpenInput& input, const SharpenLimits& limits,
             const std::vector<Placed>& placed)
      : surface_(surface), input_(input.mesh), distance_(input.distance), limits_(limits), placed_(placed) {}

  // Fills what can be filled without faults. Returns whether a gap has been; and whether there are others, which might
  // be, too, but have a face in common with these.
  struct Filled {
    bool any = false, overlap = false;
  };
  [[nodiscard]] Filled fill(SurfaceMesh& surface, const Lattice& lattice) const {
    constexpr int kRounds = 10, kGiveUp = 4;  // what is at faults then is left
    const Faces off = numbers_where(placed_.size(), [&](std::uint32_t face) { return is_off(face); });
    if (off.empty()) return {};
    distance_.prepare_points();
    const FacesAt faces_at(surface);
    const std::vector<Faces> gaps = gaps_of(off, faces_at);
    std::vector<std::optional<FilledGap>> found(gaps.size());
    std::vector<int> passed_over(gaps.size(), 0);
    std::vector<std::size_t> wanted(gaps.size());
    std::iota(wanted.begin(), wanted.end(), std::size_t{0});
    for (int round = 0; round < kRounds; ++round) {
      parallel_for_each(wanted.size(), [&](std::size_t n) {
        const std::size_t gap = wanted[n];
        found[gap] = round < kGiveUp ? fill_of(gaps[gap], faces_at, passed_over[gap]) : std::nullopt;
      });
      auto [fills, numbers, overlap] = disjoint(found);
      if (fills.empty()) break;
      const std::vector<std::size_t> at_faults = fill_all(surface, fills, lattice);
      if (at_faults.empty()) return {true, overlap};
      wanted.clear();
      for (const std::size_t n : at_faults) {
        wanted.push_back(numbers[n]);
        ++passed_over[numbers[n]];
      }
    }
    return {};
  }

 private:
  // How far around a corner faces are made anew, beside those of the gap: some steps, by these parts of reach.
  static constexpr int kSteps = 9;
  static constexpr double kStep = 0.125;
  static constexpr std::size_t kMostAround = 128;  // faces

  // Of what has been found, what has no face in common with others before it, and their numbers.
  struct Disjoint {
    std::vector<FilledGap> fills;
    std::vector<std::size_t> numbers;
    bool overlap = false;  // whether there are others
  };
  [[nodiscard]] Disjoint disjoint(const std::vector<std::optional<FilledGap>>& found) const {
    Disjoint result;
    std::vector<bool> taken(placed_.size(), false);
    for (std::size_t n = 0; n < found.size(); ++n) {
      if (!found[n]) continue;
      const Faces& faces = found[n]->faces;
      if (std::ranges::any_of(faces, [&](std::uint32_t face) { return taken[face]; })) {
        result.overlap = true;
        continue;
      }
      for (const std::uint32_t face : faces) taken[face] = true;
      result.fills.push_back(*found[n]);
      result.numbers.push_back(n);
    }
    return result;
  }

  [[nodiscard]] bool is_off(std::uint32_t face) const { return placed_[face] != Placed::kInPlane; }

  // Large ones are not at a corner.
  [[nodiscard]] std::vector<Faces> gaps_of(const Faces& off, const FacesAt& faces_at) const {
    constexpr std::size_t kMostFaces = 64;
    std::vector<bool> seen(placed_.size(), false);
    const auto joins = [&](std::uint32_t face) {
      if (!is_off(face) || seen[face]) return false;
      seen[face] = true;
      return true;
    };
    std::vector<Faces> gaps;
    for (const std::uint32_t first : off) {
      if (!joins(first)) continue;
      Faces gap = faces_joined_to(first, faces_at, joins);
      if (gap.size() <= kMostFaces) gaps.push_back(std::move(gap));
    }
    return gaps;
  }

  // The gap as it is; else all that is around a corner of the mesh, ever farther. The first of these that can be
  // filled, but for those that are passed over.
  [[nodiscard]] std::optional<FilledGap> fill_of(const Faces& gap, const FacesAt& faces_at, int passed_over) const {
    const auto fill_alone = [&](const GapLoop& loop, const GapLimits& limits) {
      return fill_gap(loop, input_, limits);
    };
    if (std::optional<FilledGap> fill = filled(gap, faces_at, fill_alone); fill && passed_over-- == 0) return fill;
    for (const Corner& near : corners_near(gap, faces_at)) {
      const Vec3& corner = near.second;
      const auto fill_from = [&](const GapLoop& loop, const GapLimits& limits) {
        return fill_gap_from(corner, loop, input_, limits);
      };
      Region region(gap);
      for (int step = 0; step < kSteps; ++step) {
        const double radius = step * kStep * limits_.reach;
        if (!grow(region, corner, radius, faces_at) && step > 0) continue;
        if (region.faces.size() > kMostAround) break;
        std::optional<FilledGap> fill = filled(closed(region.faces, faces_at), faces_at, fill_from);
        if (fill && passed_over-- == 0) return fill;
      }
    }
    return std::nullopt;
  }

  // Corners of the triangles that are sources of the gap's faces, or of faces beyond, which are in the planes of all of
  // the latter, where the gap has one border; with the square of the distance of its vertices; the nearest ones, none
  // farther than reach.
  using Corner = std::pair<double, Vec3>;
  [[nodiscard]] std::vector<Corner> corners_near(const Faces& gap, const FacesAt& faces_at) const {
    constexpr std::size_t kMost = 3;
    std::vector<std::int32_t> sources, all;
    for (const GapSide& side : border_of(gap, faces_at)) sources.push_back(surface_.sources[side.beyond]);
    if (std::ranges::find(sources, kHole) != sources.end()) return {};
    std::ranges::sort(sources);
    sources.erase(std::unique(sources.begin(), sources.end()), sources.end());
    all = sources;
    for (const std::uint32_t face : gap) all.push_back(surface_.sources[face]);
    std::vector<SourcePlane> planes;
    for (const std::int32_t source : sources) planes.push_back(source_plane(input_, source));
    std::vector<Corner> corners;
    for (const std::int32_t source : all) {
      for (const std::uint32_t v : input_.triangles[static_cast<std::size_t>(source)]) {
        const Vec3& p = input_.vertices[v];
        const auto has_corner = [&](const SourcePlane& plane) { return std::abs(plane.height(p)) <= limits_.off; };
        const bool is_known = std::ranges::find(corners, p, &Corner::second) != corners.end();
        if (is_known || !std::ranges::all_of(planes, has_corner)) continue;
        const double square = square_to(p, gap, faces_at);
        if (square <= limits_.reach * limits_.reach) corners.emplace_back(square, p);
      }
    }
    std::ranges::stable_sort(corners, {}, &Corner::first);
    corners.resize(std::min(corners.size(), kMost));
    return corners;
  }

  [[nodiscard]] static double square_to(const Vec3& p, const Faces& gap, const FacesAt& faces_at) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const std::uint32_t face : gap) {
      for (const std::uint32_t v : faces_at.triangle(face)) {
        const Vec3 step = faces_at.position(v) - p;
        nearest = std::min(nearest, dot(step, step));
      }
    }
    return nearest;
  }

  // Faces that hang together, and those beside them that did not belong to them when they were looked at last.
  struct Region {
    explicit Region(const Faces& gap) : faces(gap), known(gap) {}
    Faces faces, beside;
    Faces known;                // all of these; increasing
    std::size_t looked_at = 0;  // of the faces, beyond how many has been looked
  };

  // Adds what has a vertex within the radius, or is another gap. Returns whether there is any.
  bool grow(Region& region, const Vec3& corner, double radius, const FacesAt& faces_at) const {
    const auto is_within = [&](std::uint32_t v) {
      const Vec3 step = faces_at.position(v) - corner;
      return dot(step, step) <= radius * radius;
    };
    const std::size_t before = region.faces.size();
    std::size_t next = region.looked_at;
    Faces waiting = std::exchange(region.beside, {});
    for (;;) {
      for (const std::uint32_t face : waiting) {
        const bool joins = is_off(face) || std::ranges::any_of(faces_at.triangle(face), is_within);
        (joins ? region.faces : region.beside).push_back(face);
      }
      waiting.clear();
      if (next == region.faces.size() || region.faces.size() > kMostAround) break;
      for (; next < region.faces.size(); ++next) {
        const Triangle& t = faces_at.triangle(region.faces[next]);
        for (std::size_t i = 0; i < 3; ++i) {
          const std::uint32_t face = faces_at.face_with(t[(i + 1) % 3], t[i]);
          const auto place = std::ranges::lower_bound(region.known, face);
          if (face == kNoFace || (place != region.known.end() && *place == face)) continue;
          region.known.insert(place, face);
          waiting.push_back(face);
        }
      }
    }
    region.looked_at = next;
    return region.faces.size() > before;
  }

  // With what lies between them: faces of which they have all corners, and those around a corner that their border
  // comes to twice. Increasing.
  [[nodiscard]] static Faces closed(Faces faces, const FacesAt& faces_at) {
    constexpr int kRounds = 4;
    std::ranges::sort(faces);
    for (int round = 0; round < kRounds && faces.size() <= kMostAround; ++round) {
      Faces ends, corners;  // of the border, where each side begins; all
      for (const std::uint32_t face : faces) {
        const Triangle& t = faces_at.triangle(face);
        corners.insert(corners.end(), t.begin(), t.end());
        for (std::size_t i = 0; i < 3; ++i) {
          if (!std::ranges::binary_search(faces, faces_at.face_with(t[(i + 1) % 3], t[i]))) ends.push_back(t[i]);
        }
      }
      std::ranges::sort(corners);
      std::ranges::sort(ends);
      Faces added;
      for (std::size_t n = 0; n < ends.size(); ++n) {
        const bool comes_twice = n > 0 && ends[n] == ends[n - 1];
        for (const std::uint32_t face : faces_at.of(ends[n])) {
          const auto is_there = [&](std::uint32_t v) { return std::ranges::binary_search(corners, v); };
          const bool is_between = comes_twice || std::ranges::all_of(faces_at.triangle(face), is_there);
          if (is_between && !std::ranges::binary_search(faces, face)) added.push_back(face);
        }
      }
      if (added.empty()) break;
      faces.insert(faces.end(), added.begin(), added.end());
      std::ranges::sort(faces);
      faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    }
    return faces;
  }

  [[nodiscard]] static std::vector<GapSide> border_of(const Faces& gap, const FacesAt& faces_at) {
    constexpr std::size_t kMostSides = 64;
    return border_of_gap(gap, faces_at, kMostSides);
  }

  // Whether no corner comes twice. Then what is within may be anything, also a tunnel, which vanishes.
  [[nodiscard]] static bool is_simple(const std::vector<GapSide>& border) {
    Faces corners(border.size());
    std::ranges::transform(border, corners.begin(), &GapSide::from);
    std::ranges::sort(corners);
    return std::ranges::adjacent_find(corners) == corners.end();
  }

  template <class FillLoop>
  [[nodiscard]] std::optional<FilledGap> filled(const Faces& gap, const FacesAt& faces_at,
                                                const FillLoop& fill_loop) const {
    const std::vector<GapSide> border = border_of(gap, faces_at);
    if (border.empty() || !is_simple(border)) return std::nullopt;
    const std::optional<GapLoop> loop = loop_along(border, faces_at);
    if (!loop) return std::nullopt;
    FilledGap fill{gap, {}, {}};
    for (const GapSide& side : border) fill.loop.push_back(side.from);
    const auto are_all = [&](std::span<const Vec3> points) { return are_on_mesh(points, distance_, limits_.off); };
    constexpr std::size_t kMostCorners = 4;
    std::optional<GapFill> found =
        fill_loop(*loop, {limits_.off, limits_.reach, kMostCorners, limits_.precision, are_all});
    if (!found || has_edge_elsewhere(*found, fill, faces_at)) return std::nullopt;
    fill.filled = *std::move(found);
    return fill;
  }

  // Whether a new line leads from one corner of the loop to another one as an edge beyond does, which would have four
  // faces then.
  [[nodiscard]] static bool has_edge_elsewhere(const GapFill& filled, const FilledGap& gap, const FacesAt& faces_at) {
    const std::size_t count = gap.loop.size();
    for (const Triangle& t : filled.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t u = t[i], v = t[(i + 1) % 3];
        if (u >= count || v >= count || (u + 1) % count == v) continue;
        const std::uint32_t face = faces_at.face_with(gap.loop[u], gap.loop[v]);
        if (face != kNoFace && !std::ranges::binary_search(gap.faces, face)) return true;
      }
    }
    return false;
  }

  const SurfaceMesh& surface_;
  const TriangleMesh& input_;
  const DistanceEvaluator& distance_;
  const SharpenLimits& limits_;
  const std::vector<Placed>& placed_;
};

}  // namespace

// Gaps may widen into the same faces. Then the first one is filled, and others are looked at again.
bool fill_corner_gaps(SurfaceMesh& surface, const SharpenInput& input, const Lattice& lattice,
                      const SharpenLimits& limits) {
  constexpr int kTimes = 2;
  bool any = false;
  for (int time = 0; time < kTimes; ++time) {
    const std::vector<Placed> placed = placements(surface, input.mesh, input.normals, limits.off);
    if (!are_mostly_in_planes(placed, limits.fewer)) break;
    const auto [filled, overlap] = CornerGaps(surface, input, limits, placed).fill(surface, lattice);
    any = any || filled;
    if (!overlap) break;
  }
  return any;
}

}  // namespace raycone
