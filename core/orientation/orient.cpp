#include "core/orientation/orient.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/crossings/check_counts.h"
#include "core/data/keep_where.h"
#include "core/exact/scale.h"
#include "core/machine/floating_point.h"
#include "core/machine/numbers_where.h"
#include "core/mesh/equal_vertices.h"
#include "core/orientation/closed_patches.h"
#include "core/orientation/doubled_quads.h"
#include "core/orientation/face_neighbours.h"
#include "core/orientation/open_bodies.h"
#include "core/orientation/open_patches.h"
#include "core/orientation/patches.h"
#include "core/orientation/pieces.h"
#include "core/orientation/surface_samples.h"
#include "core/orientation/unique_faces.h"
#include "core/orientation/unit_box.h"

namespace raycone {
namespace {

void reverse(Triangle& t) { std::swap(t[1], t[2]); }

OrientedMesh flipped(TriangleMesh mesh) {
  for (Triangle& t : mesh.triangles) reverse(t);
  const std::uint64_t faces = mesh.triangles.size();
  OrientationCounts counts;
  counts.flipped_faces = faces;
  return {std::move(mesh), counts};
}

// The faces of each piece, turned to agree.
struct PieceFaces {
  std::vector<Triangle> faces;
  int stored = 0;  // as ClosedPatch::stored
};

std::vector<PieceFaces> faces_of_pieces(const UniqueFaces& unique, const Patches& patches, const Pieces& pieces) {
  std::vector<PieceFaces> all(pieces.size());
  std::vector<std::uint8_t> agreed(pieces.size(), 1);
  for (std::size_t patch = 0; patch < patches.size(); ++patch) {
    const std::uint32_t piece = pieces.of_patch[patch];
    PieceFaces& its = all[piece];
    if (its.faces.empty()) its.faces.reserve(patches[patch].size());
    for (const std::uint32_t face : patches[patch]) {
      const int sign = patches.sign[face] * pieces.sign[patch];
      its.faces.push_back(unique.corners[face]);
      if (sign < 0) reverse(its.faces.back());
      const int stored = unique.vote[face] * sign;
      if (its.stored == 0) its.stored = stored;
      if (stored == 0 || stored != its.stored) agreed[piece] = 0;
    }
  }
  for (std::size_t piece = 0; piece < all.size(); ++piece) {
    if (!agreed[piece]) all[piece].stored = 0;
  }
  return all;
}

// In the scale in which predicates are fast.
std::vector<Vec3> scaled_vertices(const TriangleMesh& mesh) {
  const PowerOfTwo scale = unit_scale(mesh);
  std::vector<Vec3> vertices = mesh.vertices;
  for (Vec3& p : vertices) p = scale(p);
  return vertices;
}

void append(const std::vector<Triangle>& faces, int sign, std::vector<Triangle>& to) {
  for (Triangle t : faces) {
    if (sign < 0) reverse(t);
    to.push_back(t);
  }
}

// The pieces of a mesh, closed and open ones apart.
class PieceTurner {
 public:
  PieceTurner(std::vector<PieceFaces> pieces, const Pieces& kinds, const std::vector<Vec3>& vertices)
      : vertices_(vertices), sign_(pieces.size(), 1) {
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (kinds.is_closed[i]) {
        closed_numbers_.push_back(i);
        closed_.push_back({{std::move(pieces[i].faces)}, pieces[i].stored});
      } else {
        open_numbers_.push_back(i);
        open_.push_back({std::move(pieces[i].faces)});
        open_stored_.push_back(pieces[i].stored);
      }
    }
  }

  // For each piece 1 or -1.
  std::vector<int> turn() {
    ClosedSigns of_closed = turn_closed_patches(closed_, vertices_);
    if (!open_.empty()) {
      std::vector<Triangle> closed = settled(of_closed.sign);
      const NumberedVertices moved(moved_vertices(), vertices_);
      OpenSurfaceTurner turner(open_, moved);
      std::vector<int> of_open = turner.turn(closed);
      // What lies in a cavity may have to be turned, too.
      if (turn_within_open_bodies(closed_, bodies(of_open), moved, of_closed)) {
        closed = settled(of_closed.sign);
        of_open = turner.turn(closed);
      }
      for (std::size_t i = 0; i < open_.size(); ++i) sign_[open_numbers_[i]] = of_open[i];
    }
    for (std::size_t i = 0; i < closed_.size(); ++i) sign_[closed_numbers_[i]] = of_closed.sign[i];
    return std::move(sign_);
  }

 private:
  [[nodiscard]] std::vector<Triangle> settled(const std::vector<int>& sign) const {
    std::size_t count = 0;
    for (const ClosedPatch& patch : closed_) count += patch.surface.faces.size();
    std::vector<Triangle> faces;
    faces.reserve(count);
    for (std::size_t i = 0; i < closed_.size(); ++i) append(closed_[i].surface.faces, sign[i], faces);
    return faces;
  }

  [[nodiscard]] std::vector<Vec3> moved_vertices() const {
    std::vector<const std::vector<Triangle>*> faces;
    for (const ClosedPatch& patch : closed_) faces.push_back(&patch.surface.faces);
    for (const OpenSurface& surface : open_) faces.push_back(&surface.faces);
    return in_unit_box(vertices_, faces);
  }

  [[nodiscard]] OpenBodies bodies(const std::vector<int>& sign) const {
    OpenBodies bodies;
    bodies.relation = sign[0] * open_stored_[0];
    for (std::size_t i = 0; i < open_.size(); ++i) {
      if (sign[i] * open_stored_[i] != bodies.relation) bodies.relation = 0;
      append(open_[i].faces, sign[i], bodies.turned);
      if (open_stored_[i] != 0) append(open_[i].faces, open_stored_[i], bodies.as_stored);
    }
    return bodies;
  }

  const std::vector<Vec3>& vertices_;
  std::vector<int> sign_;
  std::vector<std::size_t> closed_numbers_, open_numbers_;
  std::vector<ClosedPatch> closed_;
  std::vector<OpenSurface> open_;
  std::vector<int> open_stored_;
};

// What becomes of a face of the mesh.
enum class FaceFate : std::uint8_t { kAsStored, kReversed, kDropped };

// `sign`: per unique face, 1 as first stored or -1.
std::vector<FaceFate> fates(const UniqueFaces& unique, const std::vector<std::int8_t>& sign, std::size_t faces) {
  std::vector<FaceFate> fate(faces, FaceFate::kAsStored);
  for (std::size_t i = 0; i < sign.size(); ++i) {
    if (sign[i] < 0) fate[unique.first[i]] = FaceFate::kReversed;
  }
  // A copy that is stored as it should be is left, where there is one.
  for (auto it = unique.copies.begin(); it != unique.copies.end();) {
    const auto end = std::find_if(it, unique.copies.end(), [&](const FaceCopy& c) { return c.unique != it->unique; });
    const bool as_first = sign[it->unique] > 0;
    const auto right = std::find_if(it, end, [&](const FaceCopy& c) { return c.as_first == as_first; });
    const auto left = right != end ? right : it;
    for (auto copy = it; copy != end; ++copy) fate[copy->face] = FaceFate::kDropped;
    fate[left->face] = right != end ? FaceFate::kAsStored : FaceFate::kReversed;
    it = end;
  }
  return fate;
}

// Of faces with two corners at one position, the first of those with the same positions is left.
void drop_collapsed_copies(const std::vector<Triangle>& triangles, const std::vector<std::uint32_t>& position,
                           std::vector<FaceFate>& fate) {
  const auto positions_of = [&](std::uint32_t face) {
    Triangle t = triangles[face];
    for (std::uint32_t& corner : t) corner = position[corner];
    return t;
  };
  std::vector<std::pair<Triangle, std::uint32_t>> collapsed;  // corners in order, and face
  for (const std::uint32_t face :
       numbers_where(triangles.size(), [&](std::uint32_t face) { return is_collapsed(positions_of(face)); })) {
    Triangle t = positions_of(face);
    std::ranges::sort(t);
    collapsed.emplace_back(t, face);
  }
  std::ranges::sort(collapsed);
  for (std::size_t n = 1; n < collapsed.size(); ++n) {
    if (collapsed[n].first == collapsed[n - 1].first) fate[collapsed[n].second] = FaceFate::kDropped;
  }
}

OrientedMesh with_fates(TriangleMesh mesh, const std::vector<FaceFate>& fate) {
  OrientationCounts counts;
  for (std::size_t i = 0; i < fate.size(); ++i) {
    if (fate[i] == FaceFate::kDropped) ++counts.dropped_duplicates;
    if (fate[i] != FaceFate::kReversed) continue;
    reverse(mesh.triangles[i]);
    ++counts.flipped_faces;
  }
  std::vector<std::uint32_t> places;
  if (counts.dropped_duplicates > 0) {
    const auto stays = [&](std::size_t i) { return fate[i] != FaceFate::kDropped; };
    keep_where(stays, mesh.triangles);
    places = numbers_where(fate.size(), stays);
  }
  return {std::move(mesh), counts, std::move(places)};
}

// As OrientationCounts says. `sign` as for fates().
std::uint64_t wall_edges(const UniqueFaces& unique, const FaceNeighbours& neighbours,
                         const std::vector<std::int8_t>& sign) {
  std::uint64_t count = 0;
  for (const UnpairedEdge& edge : neighbours.unpaired()) {
    bool has_others = false;
    int walls = 0, others = 0;
    for (const FaceAtEdge& at : edge.faces) {
      const bool is_wall = unique.vote[at.face] == 0;
      (is_wall ? walls : others) += at.direction * sign[at.face];
      has_others |= !is_wall;
    }
    count += has_others && others == 0 && walls != 0;
  }
  return count;
}

// For each vertex the first one at its position.
std::vector<std::uint32_t> positions(const TriangleMesh& mesh, EqualVertices equal) {
  if (equal == EqualVertices::kMayBe) return first_equal_vertices(mesh.vertices);
  std::vector<std::uint32_t> positions(mesh.vertices.size());
  std::iota(positions.begin(), positions.end(), 0U);
  return positions;
}

OrientedMesh turned_to_agree(TriangleMesh mesh, EqualVertices equal) {
  const DefaultFloatingPoint guard;
  const std::vector<std::uint32_t> position = positions(mesh, equal);
  UniqueFaces unique = unique_faces(mesh, position);
  FaceNeighbours neighbours(unique.corners, mesh.vertices.size());
  const std::vector<Vec3> vertices = scaled_vertices(mesh);
  if (match_diagonals(mesh.triangles, vertices, unique, neighbours)) {
    unique = unique_faces(mesh, position);
    neighbours = FaceNeighbours(unique.corners, mesh.vertices.size());
  }
  const Patches patches = find_patches(unique.corners, neighbours, mesh.vertices);
  const Pieces pieces = find_pieces(patches, neighbours, unique.vote);
  const std::vector<int> sign_of_piece = PieceTurner(faces_of_pieces(unique, patches, pieces), pieces, vertices).turn();
  std::vector<std::int8_t> sign(patches.sign);
  for (std::size_t face = 0; face < sign.size(); ++face) {
    const std::uint32_t patch = patches.of_face[face];
    sign[face] = static_cast<std::int8_t>(sign[face] * pieces.sign[patch] * sign_of_piece[pieces.of_patch[patch]]);
  }
  std::vector<FaceFate> fate = fates(unique, sign, mesh.triangles.size());
  drop_collapsed_copies(mesh.triangles, position, fate);
  OrientedMesh result = with_fates(std::move(mesh), fate);
  result.counts.patches = patches.size();
  result.counts.cut_edges = patches.cut_edges;
  result.counts.wall_edges = wall_edges(unique, neighbours, sign);
  return result;
}

}  // namespace

OrientedMesh orient(TriangleMesh mesh, Orient how, EqualVertices equal) {
  check_counts(mesh);
  if (how == Orient::kKeep || mesh.triangles.empty()) return {std::move(mesh), {}};
  return how == Orient::kFlip ? flipped(std::move(mesh)) : turned_to_agree(std::move(mesh), equal);
}

}  // namespace raycone
