#include "core/arrangement/take_apart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include "core/data/single_precision.h"
#include "core/data/vec3.h"
#include "core/exact/predicates.h"
#include "core/mesh/face_edges.h"

namespace raycone {
namespace {

// Two faces at an edge between which the solid is.
struct FacePair {
  FaceEdge forward, backward;
};

std::uint32_t apex_of(const TriangleMesh& mesh, const FaceEdge& edge) {
  for (const std::uint32_t corner : mesh.triangles[edge.face]) {
    if (corner != edge.low && corner != edge.high) return corner;
  }
  return edge.low;
}

// The faces at an edge, in the order in which a plane that turns around it meets them, the first one first: seen along
// the edge, from low to high, it turns to the right.
std::vector<FaceEdge> in_turning_order(const TriangleMesh& mesh, std::span<const FaceEdge> faces) {
  const Vec3 &low = mesh.vertices[faces[0].low], &high = mesh.vertices[faces[0].high];
  const auto apex = [&](const FaceEdge& face) -> const Vec3& { return mesh.vertices[apex_of(mesh, face)]; };
  const Vec3& first = apex(faces[0]);
  const auto half_turn = [&](const FaceEdge& face) {  // whether it takes half a turn or more from the first
    return plane_side(low, high, first, apex(face)) <= 0;
  };
  std::vector<FaceEdge> order(faces.begin() + 1, faces.end());
  std::ranges::stable_sort(order, [&](const FaceEdge& a, const FaceEdge& b) {
    const bool a_late = half_turn(a), b_late = half_turn(b);
    if (a_late != b_late) return b_late;
    return plane_side(low, high, apex(a), apex(b)) > 0;
  });
  order.insert(order.begin(), faces[0]);
  return order;
}

// The solid is behind faces: those that have the edge forward meet it when they turn back. Nothing where faces of
// either direction do not alternate.
bool add_pairs(const TriangleMesh& mesh, std::span<const FaceEdge> faces, std::vector<FacePair>& pairs) {
  const std::vector<FaceEdge> order =
      faces.size() == 2 ? std::vector<FaceEdge>(faces.begin(), faces.end()) : in_turning_order(mesh, faces);
  for (std::size_t n = 0; n < order.size(); ++n) {
    const FaceEdge& before = order[(n + order.size() - 1) % order.size()];
    if (before.is_forward == order[n].is_forward) return false;
    if (order[n].is_forward) pairs.push_back({order[n], before});
  }
  return true;
}

// Corners of faces, numbered 3 * face + place, in sets that are joined across edges: the fans around the vertices.
class Fans {
 public:
  Fans(const TriangleMesh& mesh, const std::vector<FacePair>& pairs)
      : mesh_(mesh), parents_(3 * mesh.triangles.size()) {
    std::iota(parents_.begin(), parents_.end(), 0);
    for (const auto& [forward, backward] : pairs) {
      for (const std::uint32_t vertex : {forward.low, forward.high}) {
        const std::size_t a = root(corner(forward.face, vertex)), b = root(corner(backward.face, vertex));
        parents_[std::max(a, b)] = std::min(a, b);
      }
    }
  }

  [[nodiscard]] std::size_t corner(std::uint32_t face, std::uint32_t vertex) const {
    const Triangle& t = mesh_.triangles[face];
    return std::size_t{3} * face + static_cast<std::size_t>(std::ranges::find(t, vertex) - t.begin());
  }
  // The first corner of the same fan.
  [[nodiscard]] std::size_t root(std::size_t corner) {
    while (parents_[corner] != corner) corner = parents_[corner] = parents_[parents_[corner]];
    return corner;
  }

 private:
  const TriangleMesh& mesh_;
  std::vector<std::size_t> parents_;
};

// The faces of a fan, as seen from its vertex: a cone that the solid is behind. In doubles.
class Cone {
 public:
  Cone(const TriangleMesh& mesh, std::uint32_t vertex, const std::vector<std::uint32_t>& faces) : faces_(faces) {
    for (const std::uint32_t face : faces) {
      const Triangle& t = mesh.triangles[face];
      const auto at = static_cast<std::size_t>(std::ranges::find(t, vertex) - t.begin());
      const auto way_to = [&](std::size_t corner) {
        const Vec3 step = mesh.vertices[t[corner % 3]] - mesh.vertices[vertex];
        return (1.0 / safe_norm(step)) * step;
      };
      sectors_.push_back({way_to(at + 1), way_to(at + 2)});
    }
  }

  [[nodiscard]] const std::vector<std::uint32_t>& faces() const { return faces_; }

  // Away from the vertex, within a face; not in its middle, for what is symmetric would be level with edges of others.
  [[nodiscard]] Vec3 way_along() const { return 0.41 * sectors_.front()[0] + 0.59 * sectors_.front()[1]; }

  // A direction of length 1 for the vertex to move in, with all faces on one side, so that it goes away from `others`,
  // which are directions: behind all faces if these are all in front, and the other way round.
  [[nodiscard]] std::optional<Vec3> way_from(const std::vector<Vec3>& others) const {
    for (const double side : {-1.0, 1.0}) {
      const std::optional<Vec3> way = way_with_all_on_side(side);
      if (way && std::ranges::none_of(others, [&](const Vec3& other) { return are_on_one_side(*way, other); })) {
        return way;
      }
    }
    return std::nullopt;
  }

 private:
  // The direction that is farthest from being along a face, of those with all faces behind it (side 1) or in front
  // (-1). It is as far from two or three of them, or across from one.
  [[nodiscard]] std::optional<Vec3> way_with_all_on_side(double side) const {
    constexpr double kClearly = 0x1p-12;
    constexpr std::size_t kMostFaces = 64;
    std::vector<Vec3> normals;
    for (const auto& [first, second] : sectors_) {
      const Vec3 area = cross(first, second);
      const double size = safe_norm(area);
      if (!(size > 0.0) || sectors_.size() > kMostFaces) return std::nullopt;
      normals.push_back((side / size) * area);
    }
    Vec3 best;
    double least_of_best = kClearly;
    const auto look_at = [&](const Vec3& way) {
      const double length = safe_norm(way);
      if (!(length > 0.0)) return;
      double least = 1.0;
      for (const Vec3& normal : normals) least = std::min(least, dot(normal, way) / length);
      if (least > least_of_best) {
        best = (1.0 / length) * way;
        least_of_best = least;
      }
    };
    for (std::size_t i = 0; i < normals.size(); ++i) {
      look_at(normals[i]);
      for (std::size_t j = i + 1; j < normals.size(); ++j) {
        look_at(normals[i] + normals[j]);
        for (std::size_t k = j + 1; k < normals.size(); ++k) {
          const Vec3 way = cross(normals[j] - normals[i], normals[k] - normals[i]);
          look_at(dot(way, normals[i]) < 0.0 ? -1.0 * way : way);
        }
      }
    }
    if (!(least_of_best > kClearly)) return std::nullopt;
    return best;
  }

  // Whether the way that turns straight from one direction to the other crosses an even number of faces.
  [[nodiscard]] bool are_on_one_side(const Vec3& from, const Vec3& to) const {
    const auto crosses = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {  // arcs a - b, c - d
      const Vec3 first = cross(a, b), second = cross(c, d);
      const Vec3 meeting = cross(first, second);
      const auto is_within = [&](const Vec3& normal, const Vec3& begin, const Vec3& end, double sign) {
        return sign * dot(cross(normal, begin), meeting) > 0.0 && sign * dot(cross(normal, end), meeting) < 0.0;
      };
      return (is_within(first, a, b, 1.0) && is_within(second, c, d, 1.0)) ||
             (is_within(first, a, b, -1.0) && is_within(second, c, d, -1.0));
    };
    return std::ranges::count_if(sectors_, [&](const auto& s) { return crosses(from, to, s[0], s[1]); }) % 2 == 0;
  }

  std::vector<std::uint32_t> faces_;
  std::vector<std::array<Vec3, 2>> sectors_;  // the edges of each face that leave the vertex
};

class Apart {
 public:
  Apart(TriangleMesh& border, std::vector<std::uint32_t>& sources, double distance, bool single_precision)
      : border_(border), sources_(sources), distance_(distance), single_precision_(single_precision) {}

  bool take() {
    constexpr int kRounds = 8;  // a face has three edges; more only go on where faces lie on each other
    for (int round = 0; round < kRounds; ++round) {
      std::vector<FacePair> pairs;
      if (!find_pairs(pairs)) return false;
      Fans fans(border_, pairs);
      if (!halve_edges(pairs, fans)) return split_vertices(fans);
    }
    return false;
  }

 private:
  bool find_pairs(std::vector<FacePair>& pairs) const {
    const std::vector<FaceEdge> edges = face_edges(border_.triangles);
    bool has_sides = true;
    for_each_edge(edges, [&](std::span<const FaceEdge> faces) {
      has_sides = has_sides && faces.size() % 2 == 0 && add_pairs(border_, faces, pairs);
    });
    return has_sides;
  }

  // Halves edges of which two pairs of faces have the same ends, but one of a face at most. Whether there were any.
  bool halve_edges(const std::vector<FacePair>& pairs, Fans& fans) {
    std::set<std::array<std::size_t, 4>> known;  // edges, and the fans of their ends
    std::vector<std::array<std::uint32_t, 2>> twice;
    for (std::size_t n = 0; n < pairs.size(); ++n) {
      const FaceEdge& edge = pairs[n].forward;
      const bool is_shared = (n > 0 && pairs[n - 1].forward.is_same_edge(edge)) ||
                             (n + 1 < pairs.size() && pairs[n + 1].forward.is_same_edge(edge));
      if (!is_shared) continue;
      const auto fan = [&](std::uint32_t vertex) { return fans.root(fans.corner(edge.face, vertex)); };
      const bool is_new = known.insert({edge.low, edge.high, fan(edge.low), fan(edge.high)}).second;
      if (!is_new && (twice.empty() || twice.back() != std::array{edge.low, edge.high})) {
        twice.push_back({edge.low, edge.high});
      }
    }
    std::set<std::uint32_t> halved;
    auto pair = pairs.begin();
    for (const auto& [low, high] : twice) {
      std::vector<std::uint32_t> faces;
      while (pair->forward.low != low || pair->forward.high != high) ++pair;
      for (; pair != pairs.end() && pair->forward.low == low && pair->forward.high == high; ++pair) {
        faces.insert(faces.end(), {pair->forward.face, pair->backward.face});
      }
      if (std::ranges::any_of(faces, [&](std::uint32_t face) { return halved.contains(face); })) continue;
      halve_edge(low, high, faces);
      halved.insert(faces.begin(), faces.end());
    }
    return !twice.empty();
  }

  void halve_edge(std::uint32_t low, std::uint32_t high, const std::vector<std::uint32_t>& faces) {
    const auto middle = static_cast<std::uint32_t>(border_.vertices.size());
    border_.vertices.push_back(rounded(0.5 * border_.vertices[low] + 0.5 * border_.vertices[high]));
    for (const std::uint32_t face : faces) {
      Triangle other = border_.triangles[face];
      std::ranges::replace(border_.triangles[face], high, middle);
      std::ranges::replace(other, low, middle);
      border_.triangles.push_back(other);
      sources_.push_back(sources_[face]);
    }
  }

  // What a fan gets a vertex of its own by.
  struct Move {
    std::uint32_t vertex;
    std::vector<std::uint32_t> faces;
    Vec3 to;
  };

  // Gives each fan its vertex: the last one at a vertex, or one that cannot be moved, keeps it.
  bool split_vertices(Fans& fans) {
    std::vector<std::uint32_t> count(border_.vertices.size(), 0);
    for_each_corner([&](std::uint32_t face, std::uint32_t vertex) {
      const std::size_t corner = fans.corner(face, vertex);
      if (fans.root(corner) == corner) ++count[vertex];
    });
    std::map<std::uint32_t, std::map<std::size_t, std::vector<std::uint32_t>>> shared;  // vertices, their fans' faces
    for_each_corner([&](std::uint32_t face, std::uint32_t vertex) {
      if (count[vertex] > 1) shared[vertex][fans.root(fans.corner(face, vertex))].push_back(face);
    });
    std::vector<Move> moves;
    for (const auto& [vertex, fans_of_vertex] : shared) {
      std::vector<Cone> cones;
      for (const auto& [root, faces] : fans_of_vertex) cones.emplace_back(border_, vertex, faces);
      if (!add_moves(vertex, cones, moves)) return false;
    }
    for (const Move& move : moves) apply(move);
    return true;
  }

  bool add_moves(std::uint32_t vertex, const std::vector<Cone>& cones, std::vector<Move>& moves) const {
    constexpr std::size_t kMostCones = 64;
    if (cones.size() > kMostCones) return false;
    std::size_t stay = 0;
    for (std::size_t n = 0; n < cones.size(); ++n) {
      std::vector<Vec3> others;
      for (std::size_t m = 0; m < cones.size(); ++m) {
        if (m != n) others.push_back(cones[m].way_along());
      }
      const bool may_stay = stay == 0 && n + 1 == cones.size();
      const std::optional<Vec3> way = may_stay ? std::nullopt : cones[n].way_from(others);
      if (way) {
        moves.push_back({vertex, cones[n].faces(), border_.vertices[vertex] + distance_ * *way});
      } else if (stay++ > 0) {
        return false;
      }
    }
    return true;
  }

  [[nodiscard]] Vec3 rounded(const Vec3& p) const { return single_precision_ ? rounded_to_float(p) : p; }

  template <class Visit>
  void for_each_corner(const Visit& visit) const {
    for (std::uint32_t face = 0; face < border_.triangles.size(); ++face) {
      for (const std::uint32_t vertex : border_.triangles[face]) visit(face, vertex);
    }
  }

  void apply(const Move& move) {
    const auto copy = static_cast<std::uint32_t>(border_.vertices.size());
    border_.vertices.push_back(rounded(move.to));
    for (const std::uint32_t face : move.faces) std::ranges::replace(border_.triangles[face], move.vertex, copy);
  }

  TriangleMesh& border_;
  std::vector<std::uint32_t>& sources_;
  double distance_;
  bool single_precision_;
};

}  // namespace

bool take_apart(TriangleMesh& border, std::vector<std::uint32_t>& sources, double distance, bool single_precision) {
  return Apart(border, sources, distance, single_precision).take();
}

}  // namespace raycone
