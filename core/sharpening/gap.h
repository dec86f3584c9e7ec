// Gaps of a surface: faces in no plane of the mesh that hang together by sides, and what is around them.
//
// `Faces` gives what a function asks of a surface: triangle(face), source(face), position(vertex), and face_with(from,
// to), the face that has a side in this direction, kNoFace where that is not known.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/cells/surface_mesh.h"
#include "core/data/triangle_mesh.h"
#include "core/data/vec3.h"
#include "core/sharpening/fill_gap.h"

namespace raycone {

inline constexpr std::uint32_t kNoFace = UINT32_MAX;

// Whether a triangle has this side, in this direction.
[[nodiscard]] inline bool has_side(const Triangle& t, std::uint32_t from, std::uint32_t to) {
  return (t[0] == from && t[1] == to) || (t[1] == from && t[2] == to) || (t[2] == from && t[0] == to);
}

// A side of a face of a gap, in its direction, and the face beyond.
struct GapSide {
  std::uint32_t from, to, face, beyond;
};

// `first` and the faces that hang together with it by sides, as far as joins(face) holds; increasing. joins() must hold
// once for each face and then no longer, and not for `first`.
template <class Faces, class Joins>
[[nodiscard]] std::vector<std::uint32_t> faces_joined_to(std::uint32_t first, const Faces& faces, const Joins& joins) {
  std::vector<std::uint32_t> gap{first};
  for (std::size_t next = 0; next < gap.size(); ++next) {
    const Triangle& t = faces.triangle(gap[next]);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t face = faces.face_with(t[(i + 1) % 3], t[i]);
      if (face != kNoFace && joins(face)) gap.push_back(face);
    }
  }
  std::ranges::sort(gap);
  return gap;
}

// The sides of a gap's border, one after the other; around each corner they go on within the gap. The first one depends
// on positions alone. Nothing where there are several borders or more than `most_sides`, or where a face beyond is not
// known. `gap`: increasing.
template <class Faces>
[[nodiscard]] std::vector<GapSide> border_of_gap(const std::vector<std::uint32_t>& gap, const Faces& faces,
                                                 std::size_t most_sides) {
  const auto is_inside = [&](std::uint32_t face) { return std::ranges::binary_search(gap, face); };
  std::vector<GapSide> all;
  for (const std::uint32_t face : gap) {
    const Triangle& t = faces.triangle(face);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = t[i], to = t[(i + 1) % 3], beyond = faces.face_with(to, from);
      if (beyond == kNoFace) return {};
      if (!is_inside(beyond)) all.push_back({from, to, face, beyond});
    }
  }
  if (all.empty() || all.size() > most_sides) return {};
  const auto is_lower = [&](const GapSide& a, const GapSide& b) {
    const auto order = lexicographic_order(faces.position(a.from), faces.position(b.from));
    return order != 0 ? order < 0 : lexicographic_order(faces.position(a.to), faces.position(b.to)) < 0;
  };
  std::vector<GapSide> border{*std::ranges::min_element(all, is_lower)};
  while (border.size() <= all.size()) {
    GapSide side = border.back();
    for (side.beyond = side.face; is_inside(side.beyond); side.beyond = faces.face_with(side.to, side.from)) {
      const Triangle& t = faces.triangle(side.face = side.beyond);
      const std::uint32_t around = border.back().to;
      side.from = around;
      side.to = t[0] == around ? t[1] : t[1] == around ? t[2] : t[0];
    }
    if (side.from == border.front().from && side.to == border.front().to) break;
    border.push_back(side);
  }
  if (border.size() != all.size()) return {};
  return border;
}

// The loop that goes around the fill of a gap with this border. Nothing where a face beyond closes a hole.
template <class Faces>
[[nodiscard]] std::optional<GapLoop> loop_along(const std::vector<GapSide>& border, const Faces& faces) {
  GapLoop loop;
  for (const GapSide& side : border) {
    if (faces.source(side.beyond) == kHole) return std::nullopt;
    const Triangle& t = faces.triangle(side.beyond);
    const Vec3& first = faces.position(t[0]);
    loop.corners.push_back(faces.position(side.from));
    loop.sources.push_back(faces.source(side.beyond));
    loop.fronts.push_back(cross(faces.position(t[1]) - first, faces.position(t[2]) - first));
  }
  return loop;
}

// The vertices of a gap that are not on its border, increasing. None where the gap is no disc.
template <class Faces>
[[nodiscard]] std::optional<std::vector<std::uint32_t>> vertices_within(const std::vector<std::uint32_t>& gap,
                                                                        const std::vector<GapSide>& border,
                                                                        const Faces& faces) {
  std::vector<std::uint32_t> on_border, within;
  for (const GapSide& side : border) on_border.push_back(side.from);
  std::ranges::sort(on_border);
  for (const std::uint32_t face : gap) {
    for (const std::uint32_t v : faces.triangle(face)) {
      if (!std::ranges::binary_search(on_border, v)) within.push_back(v);
    }
  }
  std::ranges::sort(within);
  within.erase(std::unique(within.begin(), within.end()), within.end());
  if (gap.size() + 2 != border.size() + 2 * within.size()) return std::nullopt;
  return within;
}

}  // namespace raycone
