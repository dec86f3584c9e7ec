#include "core/arrangement/arrangement.h"

#include <algorithm>
#include <map>

#include "core/arrangement/contact.h"
#include "core/arrangement/plane_arrangement.h"
#include "core/exact/predicates.h"
#include "core/intersections/self_intersections.h"
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

}  // namespace

class Arrangement::Builder {
 public:
  Builder(const TriangleMesh& mesh, Arrangement& result) : mesh_(mesh), result_(result) {}

  bool build(std::size_t most_pairs) {
    const std::vector<std::uint32_t> faces = faces_with_area(mesh_);
    TriangleMesh with_area{mesh_.vertices, {}};
    for (const std::uint32_t face : faces) with_area.triangles.push_back(mesh_.triangles[face]);
    std::optional<std::vector<TrianglePair>> pairs = intersecting_pairs(with_area, most_pairs);
    if (!pairs) return false;
    for (TrianglePair& pair : *pairs) pair = {faces[pair[0]], faces[pair[1]]};
    add_vertices(*pairs);
    add_contacts(*pairs);
    std::vector<bool> is_cut(mesh_.triangles.size(), false);
    constexpr std::uint64_t kLeastSteps = 1 << 20, kStepsPerPair = 64;
    Effort effort(kLeastSteps + kStepsPerPair * most_pairs);
    for (const auto& [first, group] : groups_) {
      if (!cut_group(group, effort)) return false;
      for (const PlaneGroup::Face& face : group.faces) is_cut[face.number] = true;
    }
    for (const std::uint32_t face : faces) {
      if (!is_cut[face]) add(mesh_.triangles[face], face, 1);
    }
    return true;
  }

 private:
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

  void add_contacts(const std::vector<TrianglePair>& pairs) {
    std::vector<Contact> contacts;
    DisjointSets planes(mesh_.triangles.size());
    for (const auto& [s, t] : pairs) {
      contacts.push_back(
          contact_of(corners_of(mesh_, mesh_.triangles[s]), corners_of(mesh_, mesh_.triangles[t]), result_.points_));
      if (contacts.back().is_of_one_plane) planes.join(s, t);
    }
    std::vector<std::uint32_t> faces;
    for (const TrianglePair& pair : pairs) faces.insert(faces.end(), pair.begin(), pair.end());
    std::ranges::sort(faces);
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    for (const std::uint32_t face : faces) groups_[planes.lowest(face)].faces.push_back(group_face(face));
    for (std::size_t n = 0; n < pairs.size(); ++n) {
      for (const std::uint32_t face : pairs[n]) add(contacts[n].ends, groups_[planes.lowest(face)]);
    }
  }

  PlaneGroup::Face group_face(std::uint32_t face) {
    PlaneGroup::Face result{face, {}};
    std::ranges::transform(mesh_.triangles[face], result.corners.begin(),
                           [&](std::uint32_t vertex) { return result_.points_.add(mesh_.vertices[vertex]); });
    return result;
  }

  static void add(const std::vector<Number>& ends, PlaneGroup& group) {
    if (ends.size() == 2) {
      group.segments.emplace_back(ends[0], ends[1]);
    } else {
      group.points.insert(group.points.end(), ends.begin(), ends.end());
    }
  }

  bool cut_group(const PlaneGroup& group, Effort& effort) {
    const std::optional<std::vector<PlanePiece>> pieces = cut(group, result_.points_, effort);
    if (!pieces) return false;
    for (const PlanePiece& piece : *pieces) {
      Triangle corners{};
      std::ranges::transform(piece.corners, corners.begin(), [&](Number point) { return corner(point); });
      add(corners, piece.face, piece.multiplicity);
    }
    return true;
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
  std::vector<std::uint32_t> corners_;          // of points
  std::map<std::uint32_t, PlaneGroup> groups_;  // by their first face
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
