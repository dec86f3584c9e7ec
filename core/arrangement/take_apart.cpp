#include "core/arrangement/take_apart.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "core/arrangement/face_pairs.h"
#include "core/arrangement/fan_cone.h"
#include "core/arrangement/fan_parting.h"
#include "core/data/coordinate_precision.h"
#include "core/data/vec3.h"
#include "core/mesh/disjoint_sets.h"
#include "core/mesh/face_edges.h"

namespace raycone {
namespace {

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

class BorderSplitter {
 public:
  BorderSplitter(TriangleMesh& border, std::vector<std::uint32_t>& sources, const ApartOptions& options)
      : border_(border), sources_(sources), options_(options), originals_(border.vertices.size()) {
    std::iota(originals_.begin(), originals_.end(), 0);
  }

  // Of each vertex the one that it is a copy of, or itself.
  [[nodiscard]] std::vector<std::uint32_t>& originals() { return originals_; }

  bool split() {
    constexpr int kRounds = 8;  // a face has three edges; more only go on where faces lie on each other
    for (int round = 0; round < kRounds; ++round) {
      const std::optional<std::vector<FacePair>> pairs = face_pairs(border_);
      if (!pairs) return false;
      Fans fans(border_, *pairs);
      const std::vector<Edge> edges = edges_to_halve(*pairs, fans);
      if (edges.empty()) return split_vertices(fans);
      halve_edges(edges, *pairs);
    }
    return false;
  }

 private:
  using Edge = std::array<std::uint32_t, 2>;  // low, high

  // Edges of which two pairs of faces have the same ends, in order.
  static std::vector<Edge> edges_to_halve(const std::vector<FacePair>& pairs, Fans& fans) {
    std::set<std::array<std::size_t, 4>> known;  // edges, and the fans of their ends
    std::vector<Edge> twice;
    for (std::size_t n = 0; n < pairs.size(); ++n) {
      const FaceEdge& edge = pairs[n].forward;
      const bool is_shared = (n > 0 && pairs[n - 1].forward.is_same_edge(edge)) ||
                             (n + 1 < pairs.size() && pairs[n + 1].forward.is_same_edge(edge));
      if (!is_shared) continue;
      const auto fan = [&](std::uint32_t vertex) { return fans.first_of(fans.corner(edge.face, vertex)); };
      const bool is_new = known.insert({edge.low, edge.high, fan(edge.low), fan(edge.high)}).second;
      const Edge ends{edge.low, edge.high};
      if (!is_new && (twice.empty() || twice.back() != ends)) twice.push_back(ends);
    }
    return twice;
  }

  // Halves these edges, but only one of a face: its others wait for the next round.
  void halve_edges(const std::vector<Edge>& edges, const std::vector<FacePair>& pairs) {
    std::set<std::uint32_t> halved;
    auto pair = pairs.begin();
    for (const auto& [low, high] : edges) {
      std::vector<std::uint32_t> faces;
      while (pair->forward.low != low || pair->forward.high != high) ++pair;
      for (; pair != pairs.end() && pair->forward.low == low && pair->forward.high == high; ++pair) {
        faces.insert(faces.end(), {pair->forward.face, pair->backward.face});
      }
      if (std::ranges::any_of(faces, [&](std::uint32_t face) { return halved.contains(face); })) continue;
      halve_edge(low, high, faces);
      halved.insert(faces.begin(), faces.end());
    }
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

  struct Splits {
    std::vector<Move> moves;
    std::vector<Cut> cuts;
  };

  // Gives each fan its vertex. All of them are looked at before any moves: cones are those of the border as it was.
  bool split_vertices(Fans& fans) {
    constexpr std::size_t kMostCuts = 256;  // each looks at all faces
    std::optional<Splits> splits = find_splits(shared_vertices(fans));
    if (!splits || splits->cuts.size() > kMostCuts) return false;
    for (const Move& move : splits->moves) give_copy(move.vertex, move.to, move.faces);
    for (Cut& cut : splits->cuts) cut.vertex = give_copy(cut.vertex, border_.vertices[cut.vertex], cut.faces);
    return std::ranges::all_of(splits->cuts, [&](const Cut& cut) { return apply(cut); });
  }

  // The faces of each fan, by its first corner, of vertices that have several fans.
  using FacesOfFans = std::map<std::size_t, std::vector<std::uint32_t>>;
  [[nodiscard]] std::map<std::uint32_t, FacesOfFans> shared_vertices(Fans& fans) const {
    std::vector<std::uint32_t> count(border_.vertices.size(), 0);
    for_each_corner([&](std::uint32_t face, std::uint32_t vertex) {
      const std::size_t corner = fans.corner(face, vertex);
      if (fans.first_of(corner) == corner) ++count[vertex];
    });
    std::map<std::uint32_t, FacesOfFans> shared;
    for_each_corner([&](std::uint32_t face, std::uint32_t vertex) {
      if (count[vertex] > 1) shared[vertex][fans.first_of(fans.corner(face, vertex))].push_back(face);
    });
    return shared;
  }

  // Nothing where there is no way left at a vertex.
  [[nodiscard]] std::optional<Splits> find_splits(const std::map<std::uint32_t, FacesOfFans>& shared) const {
    constexpr std::size_t kMostFans = 64;  // each looks at all others
    FanSteps steps(border_);
    Splits splits;
    for (const auto& [vertex, fans_of_vertex] : shared) {
      if (fans_of_vertex.size() > kMostFans) return std::nullopt;
      std::vector<FanCone> fans;
      for (const auto& [first, faces] : fans_of_vertex) fans.emplace_back(border_, vertex, faces);
      const std::optional<FanParting> parting = parting_at(vertex, fans, steps);
      if (!parting) return std::nullopt;
      steps.note(vertex, fans, parting->order);
      for (const auto& [fan, step] : parting->moves) {
        splits.moves.push_back({vertex, fans[fan].faces(), border_.vertices[vertex] + step});
      }
      for (const auto& [fan, side] : parting->cuts) splits.cuts.push_back({vertex, fans[fan].faces(), side});
    }
    return splits;
  }

  struct Way {
    bool against_perturbation;
    double distance;
  };
  // In the order in which they are tried.
  [[nodiscard]] std::vector<Way> ways() const {
    constexpr double kFarther = 4.0;
    const bool first = options_.against_perturbation;
    const double near = options_.distance, far = kFarther * near;
    if (!options_.other_ways) return {{first, near}};
    return {{first, near}, {!first, near}, {first, far}, {!first, far}};
  }

  // The parting by the first way that is possible, after as many possible ways as were in vain at the vertex.
  [[nodiscard]] std::optional<FanParting> parting_at(std::uint32_t vertex, const std::vector<FanCone>& fans,
                                                     const FanSteps& steps) const {
    std::size_t in_vain = vertex < options_.in_vain.size() ? options_.in_vain[vertex] : 0;
    for (const Way& way : ways()) {
      std::optional<FanParting> parting = way.against_perturbation
                                              ? parting_against_perturbation(fans, way.distance, steps)
                                              : parting_inside(fans, way.distance);
      if (parting && in_vain-- == 0) return parting;
    }
    return std::nullopt;
  }

  [[nodiscard]] Vec3 rounded(const Vec3& p) const { return rounded_to(options_.precision, p); }

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
};

}  // namespace

std::optional<std::vector<std::uint32_t>> take_apart(TriangleMesh& border, std::vector<std::uint32_t>& sources,
                                                     const ApartOptions& options) {
  BorderSplitter splitter(border, sources, options);
  if (!splitter.split()) return std::nullopt;
  return std::move(splitter.originals());
}

}  // namespace raycone
