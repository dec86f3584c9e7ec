#include "core/orientation/doubled_quads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "core/data/box.h"
#include "core/data/vec3.h"

namespace raycone {
namespace {

// Two triangles that agree at the edge between them.
struct Quad {
  std::array<std::uint32_t, 4> corners;   // in rising order
  std::array<std::uint32_t, 2> diagonal;  // likewise
  std::uint32_t one, other;               // unique faces
  std::size_t corner;                     // of `one`: from there to its next one

  friend auto operator<=>(const Quad&, const Quad&) = default;
};

std::size_t next(std::size_t corner) { return corner < 2 ? corner + 1 : 0; }
std::size_t last(std::size_t corner) { return corner > 0 ? corner - 1 : 2; }

// The corner from which the face runs to `to`. Precondition: it has that corner.
std::size_t corner_before(const Triangle& t, std::uint32_t to) {
  return last(static_cast<std::size_t>(std::ranges::find(t, to) - t.begin()));
}

// Those of a face, found from one of their triangles, that of the lower number.
void add_quads(const std::vector<Triangle>& faces, const FaceNeighbours& neighbours, std::uint32_t face,
               std::vector<Quad>& quads) {
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const FaceNeighbour beyond = neighbours.neighbour(face, corner);
    if (beyond.agrees != 1) continue;
    std::uint32_t one = face, other = beyond.face;
    std::size_t from = corner;
    if (other < one) {
      from = corner_before(faces[other], faces[one][corner]);
      std::swap(one, other);
    }
    const Triangle& t = faces[one];
    const std::uint32_t a = t[from], c = t[next(from)];
    const std::uint32_t opposite = faces[other][last(corner_before(faces[other], a))];
    Quad quad{{a, c, t[last(from)], opposite}, {std::min(a, c), std::max(a, c)}, one, other, from};
    std::ranges::sort(quad.corners);
    if (std::ranges::adjacent_find(quad.corners) == quad.corners.end()) quads.push_back(quad);
  }
}

std::vector<Quad> quads_at_crowded_edges(const std::vector<Triangle>& faces, const FaceNeighbours& neighbours) {
  std::vector<Quad> quads;
  for (const UnpairedEdge& edge : neighbours.unpaired()) {
    if (edge.faces.size() < 3) continue;
    for (const FaceAtEdge& at : edge.faces) add_quads(faces, neighbours, at.face, quads);
  }
  std::ranges::sort(quads);
  quads.erase(std::unique(quads.begin(), quads.end()), quads.end());
  return quads;
}

bool have_one_corner(const Quad& a, const Quad& b) {
  return std::ranges::any_of(a.diagonal, [&](std::uint32_t v) { return std::ranges::count(b.diagonal, v) > 0; });
}

class Matcher {
 public:
  Matcher(std::vector<Triangle>& triangles, const std::vector<Vec3>& vertices, const UniqueFaces& unique)
      : triangles_(triangles),
        vertices_(vertices),
        unique_(unique),
        rounding_(0x1p-22 * largest_coordinate(bounding_box(triangles, vertices))) {}

  [[nodiscard]] bool are_copies(const Quad& first, const Quad& second) const {
    return !have_one_corner(first, second) && is_flat(first) && is_flat(second);
  }

  // Whether its diagonal does. The order of faces must not decide.
  [[nodiscard]] bool ends_at_lowest_corner(const Quad& quad) const {
    const auto is_before = [&](std::uint32_t a, std::uint32_t b) {
      return lexicographic_order(vertices_[a], vertices_[b]) < 0;
    };
    const std::uint32_t lowest = *std::ranges::min_element(quad.corners, is_before);
    return std::ranges::count(quad.diagonal, lowest) > 0;
  }

  // Along the other diagonal.
  void cut_anew(const Quad& quad) {
    Triangle &t = triangles_[unique_.first[quad.one]], &u = triangles_[unique_.first[quad.other]];
    const std::uint32_t a = t[quad.corner], c = t[next(quad.corner)], x = t[last(quad.corner)];
    const std::uint32_t representative = unique_.corners[quad.one][quad.corner];
    const std::uint32_t y = u[last(corner_before(unique_.corners[quad.other], representative))];
    t = {x, a, y};
    u = {y, c, x};
  }

 private:
  [[nodiscard]] Vec3 normal(std::uint32_t face) const {
    const Triangle& t = triangles_[unique_.first[face]];
    const Vec3& a = vertices_[t[0]];
    return cross(vertices_[t[1]] - a, vertices_[t[2]] - a);
  }

  // Whether its two triangles are in one plane, and look the same way.
  [[nodiscard]] bool is_flat(const Quad& quad) const {
    constexpr double kFlat = 0x1p-20;
    const Vec3 one = normal(quad.one), other = normal(quad.other);
    const Vec3& a = vertices_[quad.corners[0]];
    double longest = 0.0, height = 0.0;
    for (const std::uint32_t corner : quad.corners) {
      const Vec3 way = vertices_[corner] - a;
      longest = std::max(longest, safe_norm(way));
      for (const Vec3& n : {one, other}) {
        if (const double size = safe_norm(n); size > 0.0) height = std::max(height, std::abs(dot(n, way)) / size);
      }
    }
    return dot(one, other) > 0.0 && height <= std::max(kFlat * longest, rounding_);
  }

  std::vector<Triangle>& triangles_;
  const std::vector<Vec3>& vertices_;
  const UniqueFaces& unique_;
  double rounding_;
};

// Of each two copies the one that is to be cut anew; no face is of two.
std::vector<Quad> second_copies(const std::vector<Quad>& quads, std::size_t faces, const Matcher& matcher) {
  std::vector<bool> is_taken(faces, false);
  std::vector<Quad> seconds;
  for (auto begin = quads.begin(); begin != quads.end();) {
    const auto end = std::find_if(begin, quads.end(), [&](const Quad& q) { return q.corners != begin->corners; });
    if (end - begin == 2 && matcher.are_copies(begin[0], begin[1])) {
      const std::array four{begin[0].one, begin[0].other, begin[1].one, begin[1].other};
      if (std::ranges::none_of(four, [&](std::uint32_t face) { return is_taken[face]; })) {
        seconds.push_back(begin[matcher.ends_at_lowest_corner(begin[0]) ? 1 : 0]);
        for (const std::uint32_t face : four) is_taken[face] = true;
      }
    }
    begin = end;
  }
  return seconds;
}

}  // namespace

bool match_diagonals(std::vector<Triangle>& triangles, const std::vector<Vec3>& vertices, const UniqueFaces& unique,
                     const FaceNeighbours& neighbours) {
  constexpr std::size_t kPart = 16;
  const std::vector<Quad> quads = quads_at_crowded_edges(unique.corners, neighbours);
  if (quads.empty()) return false;
  Matcher matcher(triangles, vertices, unique);
  const std::vector<Quad> seconds = second_copies(quads, unique.corners.size(), matcher);
  const std::size_t doubled = 4 * seconds.size() + unique.copies.size(), faces = triangles.size();
  if (seconds.empty() || doubled < faces - faces / kPart) return false;
  for (const Quad& quad : seconds) matcher.cut_anew(quad);
  return true;
}

}  // namespace raycone
