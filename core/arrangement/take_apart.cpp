#include "core/arrangement/take_apart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include "core/arrangement/fan_cone.h"
#include "core/data/single_precision.h"
#include "core/data/vec3.h"
#include "core/exact/predicates.h"
#include "core/exact/projection.h"
#include "core/mesh/disjoint_sets.h"
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
// the edge, from low to high, it turns to the right. Nothing where a face lies on another one.
std::optional<std::vector<FaceEdge>> in_turning_order(const TriangleMesh& mesh, std::span<const FaceEdge> faces) {
  const Vec3 &low = mesh.vertices[faces[0].low], &high = mesh.vertices[faces[0].high];
  const auto apex = [&](const FaceEdge& face) -> const Vec3& { return mesh.vertices[apex_of(mesh, face)]; };
  const Vec3& first = apex(faces[0]);
  const Vec3 normal = area_direction(std::array{low, high, first});
  const auto is_on_first = [&](const FaceEdge& face) {
    return plane_side(low, high, first, apex(face)) == 0 && turn(normal, low, high, apex(face)) > 0;
  };
  if (std::any_of(faces.begin() + 1, faces.end(), is_on_first)) return std::nullopt;
  const auto half_turn = [&](const FaceEdge& face) {  // whether it takes half a turn or more from the first
    return plane_side(low, high, first, apex(face)) <= 0;
  };
  std::vector<FaceEdge> order(faces.begin() + 1, faces.end());
  std::ranges::stable_sort(order, [&](const FaceEdge& a, const FaceEdge& b) {
    const bool a_late = half_turn(a), b_late = half_turn(b);
    if (a_late != b_late) return b_late;
    return plane_side(low, high, apex(a), apex(b)) > 0;
  });
  const auto are_on_each_other = [&](const FaceEdge& a, const FaceEdge& b) {
    return half_turn(a) == half_turn(b) && plane_side(low, high, apex(a), apex(b)) == 0;
  };
  if (std::ranges::adjacent_find(order, are_on_each_other) != order.end()) return std::nullopt;
  order.insert(order.begin(), faces[0]);
  return order;
}

// The solid is behind faces: those that have the edge forward meet it when they turn back. False where faces of either
// direction do not alternate, or of more than two one lies on another.
bool add_pairs(const TriangleMesh& mesh, std::span<const FaceEdge> faces, std::vector<FacePair>& pairs) {
  const std::optional<std::vector<FaceEdge>> order =
      faces.size() == 2 ? std::vector<FaceEdge>(faces.begin(), faces.end()) : in_turning_order(mesh, faces);
  if (!order) return false;
  for (std::size_t n = 0; n < order->size(); ++n) {
    const FaceEdge &before = (*order)[(n + order->size() - 1) % order->size()], &here = (*order)[n];
    if (before.is_forward == here.is_forward) return false;
    if (here.is_forward) pairs.push_back({here, before});
  }
  return true;
}

// Corners of faces, numbered 3 * face + place, in sets that are joined across edges: the fans around the vertices.
class Fans {
 public:
  Fans(const TriangleMesh& mesh, const std::vector<FacePair>& pairs) : mesh_(mesh), fans_(3 * mesh.triangles.size()) {
    for (const auto& [forward, backward] : pairs) {
      for (const std::uint32_t vertex : {forward.low, forward.high}) {
        fans_.join(corner(forward.face, vertex), corner(backward.face, vertex));
      }
    }
  }

  [[nodiscard]] std::size_t corner(std::uint32_t face, std::uint32_t vertex) const {
    const Triangle& t = mesh_.triangles[face];
    return std::size_t{3} * face + static_cast<std::size_t>(std::ranges::find(t, vertex) - t.begin());
  }
  // The first corner of the same fan.
  [[nodiscard]] std::size_t first_of(std::size_t corner) { return fans_.lowest(corner); }

 private:
  const TriangleMesh& mesh_;
  DisjointSets<std::size_t> fans_;
};

class Apart {
 public:
  Apart(TriangleMesh& border, std::vector<std::uint32_t>& sources, const ApartOptions& options)
      : border_(border), sources_(sources), options_(options), originals_(border.vertices.size()) {
    std::iota(originals_.begin(), originals_.end(), 0);
  }

  // Of each vertex the one that it is a copy of, or itself.
  [[nodiscard]] std::vector<std::uint32_t>& originals() { return originals_; }

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
      const auto fan = [&](std::uint32_t vertex) { return fans.first_of(fans.corner(edge.face, vertex)); };
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
    const Vec3 halfway = 0.5 * border_.vertices[low] + 0.5 * border_.vertices[high];
    const std::uint32_t middle = add_vertex(halfway, static_cast<std::uint32_t>(border_.vertices.size()));
    for (const std::uint32_t face : faces) {
      Triangle other = border_.triangles[face];
      std::ranges::replace(border_.triangles[face], high, middle);
      std::ranges::replace(other, low, middle);
      add_face(other, sources_[face]);
    }
  }

  // What a fan gets a vertex of its own by.
  struct Move {
    std::uint32_t vertex;
    std::vector<std::uint32_t> faces;
    Vec3 to;
  };
  // Or what its vertex is cut off by, with a lid within the solid (side -1), or outside of it.
  struct Cut {
    std::uint32_t vertex;
    std::vector<std::uint32_t> faces;
    double side;
  };

  // Gives each fan its vertex: the last one at a vertex, or one that cannot be moved, keeps it. Of several of these,
  // all but that with most faces are cut off.
  bool split_vertices(Fans& fans) {
    std::vector<std::uint32_t> count(border_.vertices.size(), 0);
    for_each_corner([&](std::uint32_t face, std::uint32_t vertex) {
      const std::size_t corner = fans.corner(face, vertex);
      if (fans.first_of(corner) == corner) ++count[vertex];
    });
    std::map<std::uint32_t, std::map<std::size_t, std::vector<std::uint32_t>>> shared;  // vertices, their fans' faces
    for_each_corner([&](std::uint32_t face, std::uint32_t vertex) {
      if (count[vertex] > 1) shared[vertex][fans.first_of(fans.corner(face, vertex))].push_back(face);
    });
    constexpr std::size_t kMostCones = 64, kMostCuts = 256;  // each looks at others, or at all faces
    std::vector<Move> moves;
    std::vector<Cut> cuts;
    for (const auto& [vertex, fans_of_vertex] : shared) {
      if (fans_of_vertex.size() > kMostCones) return false;
      std::vector<FanCone> cones;
      for (const auto& [root, faces] : fans_of_vertex) cones.emplace_back(border_, vertex, faces);
      if (!part(vertex, cones, moves, cuts)) return false;
    }
    if (cuts.size() > kMostCuts) return false;
    for (const Move& move : moves) give_copy(move.vertex, move.to, move.faces);
    for (Cut& cut : cuts) cut.vertex = give_copy(cut.vertex, border_.vertices[cut.vertex], cut.faces);
    return std::ranges::all_of(cuts, [&](const Cut& cut) { return apply(cut); });
  }

  struct Way {
    bool against_perturbation;
    double distance;
  };
  // The first one to try first.
  [[nodiscard]] std::vector<Way> ways() const {
    constexpr double kFarther = 4.0;
    const bool first = options_.against_perturbation;
    const double near = options_.distance, far = kFarther * near;
    if (!options_.other_ways) return {{first, near}};
    return {{first, near}, {!first, near}, {first, far}, {!first, far}};
  }

  // What a vertex is taken apart by.
  struct Parting {
    std::vector<Move> moves;
    std::vector<Cut> cuts;
    std::vector<std::size_t> order;  // of moves against the perturbation: the fans, the one that stays first
  };

  // The first of the ways that there are, but for those that were in vain. Whether there is one.
  bool part(std::uint32_t vertex, const std::vector<FanCone>& cones, std::vector<Move>& moves, std::vector<Cut>& cuts) {
    std::size_t in_vain = vertex < options_.in_vain.size() ? options_.in_vain[vertex] : 0;
    for (const Way& way : ways()) {
      std::optional<Parting> parting = way.against_perturbation ? parting_against(vertex, cones, way.distance)
                                                                : parting_inside(vertex, cones, way.distance);
      if (!parting || in_vain-- > 0) continue;
      moves.insert(moves.end(), parting->moves.begin(), parting->moves.end());
      cuts.insert(cuts.end(), parting->cuts.begin(), parting->cuts.end());
      for (std::size_t i = 0; i < parting->order.size(); ++i) {
        for (const std::uint32_t face : cones[parting->order[i]].faces()) steps_[{face, vertex}] = static_cast<int>(i);
      }
      return true;
    }
    return false;
  }

  static std::vector<Vec3> ways_along_others(const std::vector<FanCone>& cones, std::size_t n) {
    std::vector<Vec3> others;
    for (std::size_t m = 0; m < cones.size(); ++m) {
      if (m != n) others.push_back(cones[m].way_along());
    }
    return others;
  }

  // Against the perturbation: a small number of times as far along y as along x, and along z as along y, as faces are
  // hardly ever nearer to level without being so.
  static Vec3 way_against(double along_y, double along_z) {
    constexpr double kMuchLess = 0x1p-5;
    const Vec3 way{-1.0, -kMuchLess * along_y, -kMuchLess * kMuchLess * along_y * along_z};
    return (1.0 / norm(way)) * way;
  }

  // Whether an axis alone would do is asked of ways a bit off it: along it, faces may be level.
  static constexpr double kAcross = 0x1p-6, kLessAcross = 0x1p-8;

  static bool leaves_all(const std::vector<FanCone>& cones, std::size_t n, const Vec3& way) {
    for (std::size_t m = 0; m < cones.size(); ++m) {
      if (m != n && !cones[n].leaves(cones[m], way)) return false;
    }
    return true;
  }

  // Along an axis alone, a fan leaves faces in their planes that it need not move: samples may be some roundings off
  // them. Nothing where it takes more than that, whichever way the others go.
  static std::optional<Vec3> way_along_one_axis(const std::vector<FanCone>& cones, std::size_t n) {
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 way;
      way[axis] = -1.0;
      bool does = cones[n].goes_against_perturbation(way);
      for (const double first : {kAcross, -kAcross}) {
        for (const double second : {kLessAcross, -kLessAcross}) {
          Vec3 near = way;
          near[(axis + 1) % 3] = first;
          near[(axis + 2) % 3] = second;
          does = does && leaves_all(cones, n, near);
        }
      }
      if (does) return way;
    }
    return std::nullopt;
  }

  // The way of a fan. Farther along y, or z, where that takes it off all others and the axis before does not: so if
  // different fans are ahead at the two ends of an edge, they pass each other between these where no solid is. Not much
  // farther: of a few fans, one that is more steps ahead stays ahead along all axes.
  static Vec3 way_of(const std::vector<FanCone>& cones, std::size_t n) {
    constexpr double kFarther = 1.25;
    if (const std::optional<Vec3> way = way_along_one_axis(cones, n)) return *way;
    const bool x = leaves_all(cones, n, {-1.0, kAcross, kLessAcross});
    const bool y = leaves_all(cones, n, {kLessAcross, -1.0, kAcross});
    const bool z = leaves_all(cones, n, {kAcross, kLessAcross, -1.0});
    return way_against(y && !x ? kFarther : 1.0, z && !y ? kFarther : 1.0);
  }

  // The first fan stays, and each other one goes farther than those before it, away from them. Of two that may leave
  // each other, the one that is ahead at the other ends of their edges is ahead, or the one whose faces are.
  [[nodiscard]] std::optional<Parting> parting_against(std::uint32_t vertex, const std::vector<FanCone>& cones,
                                                       double distance) const {
    const std::size_t count = cones.size();
    const Vec3 way = way_against(1.0, 1.0);
    std::vector<std::vector<bool>> leaves(count, std::vector<bool>(count, false));
    std::vector<std::pair<int, std::size_t>> order;  // how many each is ahead of, and which it is
    for (std::size_t n = 0; n < count; ++n) {
      for (std::size_t m = 0; m < count; ++m) leaves[n][m] = n != m && cones[n].leaves(cones[m], way);
      order.emplace_back(0, n);
    }
    for (std::size_t n = 0; n < count; ++n) {
      for (std::size_t m = 0; m < n; ++m) {
        const int ends = ahead_at_other_ends(cones[n], cones[m]);
        const bool is_ahead = ends != 0 ? ends > 0 : cones[n].lead(cones[m], way) > 0.0;
        ++order[leaves[n][m] && (is_ahead || !leaves[m][n]) ? n : m].first;
      }
    }
    std::ranges::sort(order);
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (!leaves[order[i].second][order[j].second]) return std::nullopt;
      }
    }
    Parting parting;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t n = order[i].second;
      parting.order.push_back(n);
      const Vec3 step = static_cast<double>(i) * distance * way_of(cones, n);
      if (i > 0) parting.moves.push_back({vertex, cones[n].faces(), border_.vertices[vertex] + step});
    }
    return parting;
  }

  // At how many corners that faces of both have one has gone farther, less those at which the other one has.
  [[nodiscard]] int ahead_at_other_ends(const FanCone& one, const FanCone& other) const {
    int ahead = 0;
    for (const std::uint32_t face : one.faces()) {
      for (const std::uint32_t corner : border_.triangles[face]) {
        const auto here = steps_.find({face, corner});
        if (here == steps_.end()) continue;
        for (const std::uint32_t beside : other.faces()) {
          const auto there = steps_.find({beside, corner});
          if (there != steps_.end()) ahead += (here->second > there->second) - (here->second < there->second);
        }
      }
    }
    return ahead;
  }

  [[nodiscard]] std::optional<Parting> parting_inside(std::uint32_t vertex, const std::vector<FanCone>& cones,
                                                      double distance) const {
    Parting parting;
    std::vector<std::size_t> stuck;
    for (std::size_t n = 0; n < cones.size(); ++n) {
      const bool may_stay = stuck.empty() && n + 1 == cones.size();
      const std::optional<Vec3> way = may_stay ? std::nullopt : cones[n].way_from(ways_along_others(cones, n));
      if (way) {
        parting.moves.push_back({vertex, cones[n].faces(), border_.vertices[vertex] + distance * *way});
      } else {
        stuck.push_back(n);
      }
    }
    // One stays: the one that cannot be cut off, or that with most faces.
    std::vector<std::optional<double>> sides(cones.size());
    for (const std::size_t n : stuck) sides[n] = cones[n].side_of_lid();
    std::ranges::stable_sort(stuck, std::greater(),
                             [&](std::size_t n) { return std::pair(!sides[n], cones[n].faces().size()); });
    if (std::any_of(stuck.begin() + 1, stuck.end(), [&](std::size_t n) { return !sides[n]; })) return std::nullopt;
    for (std::size_t i = 1; i < stuck.size(); ++i) {
      parting.cuts.push_back({vertex, cones[stuck[i]].faces(), *sides[stuck[i]]});
    }
    return parting;
  }

  [[nodiscard]] Vec3 rounded(const Vec3& p) const { return options_.single_precision ? rounded_to_float(p) : p; }

  template <class Visit>
  void for_each_corner(const Visit& visit) const {
    for (std::uint32_t face = 0; face < border_.triangles.size(); ++face) {
      for (const std::uint32_t vertex : border_.triangles[face]) visit(face, vertex);
    }
  }

  std::uint32_t add_vertex(const Vec3& p, std::uint32_t original) {
    border_.vertices.push_back(rounded(p));
    originals_.push_back(original);
    return static_cast<std::uint32_t>(border_.vertices.size() - 1);
  }

  std::uint32_t give_copy(std::uint32_t vertex, const Vec3& at, const std::vector<std::uint32_t>& faces) {
    const std::uint32_t copy = add_vertex(at, vertex);
    for (const std::uint32_t face : faces) std::ranges::replace(border_.triangles[face], vertex, copy);
    return copy;
  }

  // The other corners of the faces around a vertex that is of one fan, one after the other; and those faces. Empty
  // where they do not go around it once.
  struct Ring {
    std::vector<std::uint32_t> corners, faces;
  };
  [[nodiscard]] Ring ring_of(std::uint32_t vertex) const {
    std::map<std::uint32_t, std::array<std::uint32_t, 2>> next;  // corner, and face between
    for_each_corner([&](std::uint32_t face, std::uint32_t corner) {
      if (corner != vertex) return;
      const Triangle& t = border_.triangles[face];
      const auto at = static_cast<std::size_t>(std::ranges::find(t, vertex) - t.begin());
      next[t[(at + 1) % 3]] = {t[(at + 2) % 3], face};
    });
    Ring ring;
    auto here = next.begin();
    for (; here != next.end() && ring.faces.size() < next.size(); here = next.find(here->second[0])) {
      ring.corners.push_back(here->first);
      ring.faces.push_back(here->second[1]);
    }
    if (here != next.begin()) ring = {};
    return ring;
  }

  // Each edge that leads to the vertex ends before it, and a lid is between these ends.
  bool apply(const Cut& cut) {
    constexpr double kOfEdge = 0x1p-12;  // so that what is apart at the other end of an edge is apart here
    const Vec3 apex = border_.vertices[cut.vertex];
    const auto [corners, faces] = ring_of(cut.vertex);
    std::vector<Vec3> steps, ways;
    for (const std::uint32_t corner : corners) {
      steps.push_back(border_.vertices[corner] - apex);
      ways.push_back((1.0 / safe_norm(steps.back())) * steps.back());
    }
    const std::optional<std::vector<std::array<std::size_t, 3>>> lid = lid_of(ways, cut.side);
    if (!lid) return false;
    std::vector<std::uint32_t> ends{cut.vertex};  // which is free now
    border_.vertices[cut.vertex] = rounded(apex + kOfEdge * steps[0]);
    for (std::size_t n = 1; n < steps.size(); ++n)
      ends.push_back(add_vertex(apex + kOfEdge * steps[n], originals_[cut.vertex]));
    for (std::size_t n = 0; n < corners.size(); ++n) {
      const std::size_t m = (n + 1) % corners.size();
      border_.triangles[faces[n]] = {ends[n], corners[n], corners[m]};
      add_face({ends[n], corners[m], ends[m]}, sources_[faces[n]]);
    }
    for (const auto& [a, b, c] : *lid) add_face({ends[a], ends[b], ends[c]}, sources_[faces[a]]);
    return true;
  }

  void add_face(const Triangle& face, std::uint32_t source) {
    border_.triangles.push_back(face);
    sources_.push_back(source);
  }

  TriangleMesh& border_;
  std::vector<std::uint32_t>& sources_;
  const ApartOptions& options_;
  std::vector<std::uint32_t> originals_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> steps_;  // of faces at corners, how many along the way
};

}  // namespace

std::optional<std::vector<std::uint32_t>> take_apart(TriangleMesh& border, std::vector<std::uint32_t>& sources,
                                                     const ApartOptions& options) {
  Apart apart(border, sources, options);
  if (!apart.take()) return std::nullopt;
  return std::move(apart.originals());
}

}  // namespace raycone
