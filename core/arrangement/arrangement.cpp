#include "core/arrangement/arrangement.h"

#include <algorithm>
#include <span>
#include <utility>

#include "core/arrangement/contact.h"
#include "core/arrangement/effort.h"
#include "core/arrangement/plane_arrangement.h"
#include "core/exact/predicates.h"
#include "core/intersections/self_intersections.h"
#include "core/machine/threads.h"
#include "core/mesh/disjoint_sets.h"

namespace raycone {
namespace {

using Number = ExactPoints::Number;

std::vector<std::uint32_t> faces_with_area(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> faces;
  for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face) {
    const auto [a, b, c] = corners_of(mesh, mesh.triangles[face]);
    if (!collinear(a, b, c)) faces.push_back(face);
  }
  return faces;
}

std::optional<std::vector<TrianglePair>> intersecting_pairs_of(const TriangleMesh& mesh,
                                                               const std::vector<std::uint32_t>& faces,
                                                               std::size_t most_pairs) {
  TriangleMesh part{mesh.vertices, {}};
  for (const std::uint32_t face : faces) part.triangles.push_back(mesh.triangles[face]);
  std::optional<std::vector<TrianglePair>> pairs = intersecting_pairs(part, most_pairs);
  if (!pairs) return std::nullopt;
  for (TrianglePair& pair : *pairs) pair = {faces[pair[0]], faces[pair[1]]};
  return pairs;
}

}  // namespace

class Arrangement::Builder {
 public:
  Builder(const TriangleMesh& mesh, Arrangement& result) : mesh_(mesh), result_(result) {}

  bool build(std::size_t most_pairs) {
    const std::vector<std::uint32_t> faces = faces_with_area(mesh_);
    const std::optional<std::vector<TrianglePair>> pairs = intersecting_pairs_of(mesh_, faces, most_pairs);
    if (!pairs) return false;
    add_vertices(*pairs);
    const std::vector<std::uint32_t> group_of = make_groups(*pairs);
    constexpr std::uint64_t kLeastSteps = 1 << 20, kStepsPerPair = 64;
    Effort effort(kLeastSteps + kStepsPerPair * most_pairs);
    if (!cut_groups(effort)) return false;
    for (const std::uint32_t face : faces) {
      if (group_of[face] == kNone) add(mesh_.triangles[face], face, 1);
    }
    return true;
  }

 private:
  using Ends = std::vector<Number>;  // of what two faces have in common: one point, or two ends of a segment

  // Before all points that are made, so that one of these that is where a vertex is becomes that one.
  void add_vertices(const std::vector<TrianglePair>& pairs) {
    for (const TrianglePair& pair : pairs) {
      for (const std::uint32_t face : pair) {
        for (const std::uint32_t vertex : mesh_.triangles[face]) {
          if (result_.points_.add(mesh_.vertices[vertex]) == corners_.size()) corners_.push_back(vertex);
        }
      }
    }
  }

  // Groups of the faces that meet others, those of one plane that meet in one. The group of each face, or kNone.
  std::vector<std::uint32_t> make_groups(const std::vector<TrianglePair>& pairs) {
    DisjointSets planes(mesh_.triangles.size());
    const std::vector<Ends> ends = ends_of(pairs, planes);
    std::vector<bool> is_cut(mesh_.triangles.size(), false);
    for (const auto& [s, t] : pairs) is_cut[s] = is_cut[t] = true;
    std::vector<std::uint32_t> group_of = planes.indices([&](std::size_t face) { return is_cut[face]; }, kNone);
    for (std::uint32_t face = 0; face < group_of.size(); ++face) {
      if (group_of[face] == kNone) continue;
      if (group_of[face] == groups_.size()) groups_.emplace_back();
      groups_[group_of[face]].faces.push_back(group_face(face));
    }
    for (std::size_t n = 0; n < pairs.size(); ++n) {
      for (const std::uint32_t face : pairs[n]) add(ends[n], groups_[group_of[face]]);
    }
    return group_of;
  }

  // What pairs have in common, but for those of one plane, which are joined. Takes few at once, for they are large
  // until they are points.
  std::vector<Ends> ends_of(const std::vector<TrianglePair>& pairs, DisjointSets<>& planes) {
    constexpr std::size_t kAtOnce = 4096, kGrain = 16;
    std::vector<Ends> result;
    for (std::size_t begin = 0; begin < pairs.size(); begin += kAtOnce) {
      std::vector<Contact> contacts(std::min(kAtOnce, pairs.size() - begin));
      parallel_for_each(contacts.size(), kGrain, [&](std::size_t n) {
        const auto& [s, t] = pairs[begin + n];
        contacts[n] = contact_of(corners_of(mesh_, mesh_.triangles[s]), corners_of(mesh_, mesh_.triangles[t]));
      });
      for (std::size_t n = 0; n < contacts.size(); ++n) {
        if (contacts[n].is_of_one_plane) planes.join(pairs[begin + n][0], pairs[begin + n][1]);
      }
      add_ends(contacts, result);
    }
    return result;
  }

  void add_ends(const std::vector<Contact>& contacts, std::vector<Ends>& result) {
    std::vector<ExactPoints::OnPlane> passes;
    for (const Contact& contact : contacts) {
      passes.insert(passes.end(), contact.passes.begin(), contact.passes.end());
    }
    const std::vector<Number> made = result_.points_.add(passes);
    auto next = made.begin();
    for (const Contact& contact : contacts) {
      const auto end = next + static_cast<std::ptrdiff_t>(contact.passes.size());
      Ends ends(next, end);
      for (const Vec3& corner : contact.corners) ends.push_back(result_.points_.add(corner));
      std::ranges::sort(ends);
      ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
      result.push_back(std::move(ends));
      next = end;
    }
  }

  PlaneGroup::Face group_face(std::uint32_t face) {
    PlaneGroup::Face result{face, {}};
    std::ranges::transform(mesh_.triangles[face], result.corners.begin(),
                           [&](std::uint32_t vertex) { return result_.points_.add(mesh_.vertices[vertex]); });
    return result;
  }

  static void add(const Ends& ends, PlaneGroup& group) {
    if (ends.size() == 2) {
      group.segments.emplace_back(ends[0], ends[1]);
    } else {
      group.points.insert(group.points.end(), ends.begin(), ends.end());
    }
  }

  // Some groups at once: where all take too long, little is done in vain, and what they need meanwhile is little. False
  // if that takes too long.
  bool cut_groups(Effort& effort) {
    constexpr std::size_t kSegmentsAtOnce = 4096;
    TrianglesAround around{};
    for (int axis = 0; axis < 3; ++axis) around[axis] = result_.points_.add_triangle_around(axis);
    for (auto next = groups_.begin(); next != groups_.end();) {
      const auto first = next;
      for (std::size_t segments = 0; next != groups_.end() && segments < kSegmentsAtOnce; ++next) {
        segments += next->segments.size() + 3 * next->faces.size();
      }
      const std::span<PlaneGroup> some(first, next);
      if (!add_crossings(some, effort) || !cut(some, around, effort)) return false;
    }
    return true;
  }

  // Adds to the points of each group where its segments cross. False if that takes too long.
  bool add_crossings(std::span<PlaneGroup> groups, Effort& effort) {
    std::vector<std::optional<std::vector<ExactPoints::Crossing>>> of_groups(groups.size());
    const bool is_done = parallel_for_each(groups.size(), effort, [&](std::size_t n, Effort& own) {
      of_groups[n] = crossings_of(groups[n], result_.points_, own);
      return of_groups[n].has_value();
    });
    if (!is_done) return false;
    std::vector<ExactPoints::Crossing> crossings;
    std::vector<std::ptrdiff_t> counts;
    for (std::optional<std::vector<ExactPoints::Crossing>>& of_group : of_groups) {
      counts.push_back(std::ssize(*of_group));
      if (crossings.empty()) {
        crossings = *std::move(of_group);
      } else {
        crossings.insert(crossings.end(), of_group->begin(), of_group->end());
      }
      of_group.reset();
    }
    const std::vector<Number> made = result_.points_.add(crossings);
    auto next = made.begin();
    for (std::size_t n = 0; n < groups.size(); next += counts[n++]) {
      groups[n].points.insert(groups[n].points.end(), next, next + counts[n]);
    }
    return true;
  }

  // Adds the pieces of each group, and takes what is in it. False if that takes too long.
  bool cut(std::span<PlaneGroup> groups, const TrianglesAround& around, Effort& effort) {
    std::vector<std::optional<std::vector<PlanePiece>>> pieces(groups.size());
    const bool is_done = parallel_for_each(groups.size(), effort, [&](std::size_t n, Effort& own) {
      pieces[n] = raycone::cut(groups[n], result_.points_, around, own);
      groups[n] = {};
      return pieces[n].has_value();
    });
    if (!is_done) return false;
    for (const auto& of_group : pieces) {
      for (const PlanePiece& piece : *of_group) add(piece);
    }
    return true;
  }

  void add(const PlanePiece& piece) {
    Triangle corners{};
    std::ranges::transform(piece.corners, corners.begin(), [&](Number point) { return corner(point); });
    add(corners, piece.face, piece.multiplicity);
  }

  void add(const Triangle& corners, std::uint32_t source, std::int32_t multiplicity) {
    result_.triangles_.push_back(corners);
    result_.sources_.push_back(source);
    result_.multiplicities_.push_back(multiplicity);
  }

  std::uint32_t corner(Number point) {
    if (point < corners_.size() && corners_[point] != kNone) return corners_[point];
    corners_.resize(std::max<std::size_t>(corners_.size(), point + 1), kNone);
    corners_[point] = static_cast<std::uint32_t>(result_.corners());
    result_.made_.push_back(point);
    return corners_[point];
  }

  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  const TriangleMesh& mesh_;
  Arrangement& result_;
  std::vector<std::uint32_t> corners_;  // of points
  std::vector<PlaneGroup> groups_;      // by their first faces
};

std::optional<Arrangement> Arrangement::of(const TriangleMesh& mesh, std::size_t most_pairs) {
  Arrangement result(mesh);
  if (!Builder(mesh, result).build(most_pairs)) return std::nullopt;
  return result;
}

Vec3 Arrangement::rounded(std::uint32_t corner) const {
  const std::size_t vertices = mesh_->vertices.size();
  return corner < vertices ? mesh_->vertices[corner] : points_.rounded(made_[corner - vertices]);
}

ExactPoints::Number Arrangement::point(std::uint32_t corner) {
  const std::size_t vertices = mesh_->vertices.size();
  return corner < vertices ? points_.add(mesh_->vertices[corner]) : made_[corner - vertices];
}

}  // namespace raycone
