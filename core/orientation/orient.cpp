#include "core/orientation/orient.h"

#include <algorithm>
#include <utility>

#include "core/crossings/check_counts.h"
#include "core/exact/scale.h"
#include "core/machine/floating_point.h"
#include "core/mesh/equal_vertices.h"
#include "core/orientation/closed_patches.h"
#include "core/orientation/face_edges.h"
#include "core/orientation/open_patches.h"
#include "core/orientation/patches.h"
#include "core/orientation/pieces.h"
#include "core/orientation/unique_faces.h"

namespace raycone {
namespace {

void reverse(Triangle& t) { std::swap(t[1], t[2]); }

OrientedMesh flipped(TriangleMesh mesh) {
  for (Triangle& t : mesh.triangles) reverse(t);
  const std::uint64_t faces = mesh.triangles.size();
  return {std::move(mesh), {.flipped_faces = faces, .dropped_duplicates = 0, .patches = 0, .cut_edges = 0}};
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

// For each piece 1 or -1.
std::vector<int> turn_pieces(std::vector<PieceFaces> pieces, const Pieces& kinds, const std::vector<Vec3>& vertices) {
  std::vector<std::size_t> closed_numbers, open_numbers;
  std::vector<ClosedPatch> closed;
  std::vector<OpenSurface> open;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (kinds.is_closed[i]) {
      closed_numbers.push_back(i);
      closed.push_back({{std::move(pieces[i].faces)}, pieces[i].stored});
    } else {
      open_numbers.push_back(i);
      open.push_back({std::move(pieces[i].faces)});
    }
  }
  std::vector<int> turn(pieces.size(), 1);
  const std::vector<int> turn_of_closed = turn_closed_patches(closed, vertices);
  for (std::size_t i = 0; i < closed.size(); ++i) turn[closed_numbers[i]] = turn_of_closed[i];
  if (open.empty()) return turn;

  std::vector<Triangle> settled;
  for (std::size_t i = 0; i < closed.size(); ++i) {
    for (Triangle t : closed[i].surface.faces) {
      if (turn_of_closed[i] < 0) reverse(t);
      settled.push_back(t);
    }
  }
  const std::vector<int> turn_of_open = turn_open_surfaces(open, settled, vertices);
  for (std::size_t i = 0; i < open.size(); ++i) turn[open_numbers[i]] = turn_of_open[i];
  return turn;
}

// What becomes of a face of the mesh.
enum class FaceFate : std::uint8_t { kAsStored, kReversed, kDropped };

// `turn`: per unique face, 1 as first stored or -1.
std::vector<FaceFate> fates(const UniqueFaces& unique, const std::vector<std::int8_t>& turn, std::size_t faces) {
  std::vector<FaceFate> fate(faces, FaceFate::kAsStored);
  for (std::size_t i = 0; i < turn.size(); ++i) {
    if (turn[i] < 0) fate[unique.first[i]] = FaceFate::kReversed;
  }
  // A copy that is stored as it should be is left, where there is one.
  for (auto it = unique.copies.begin(); it != unique.copies.end();) {
    const auto end = std::find_if(it, unique.copies.end(), [&](const FaceCopy& c) { return c.unique != it->unique; });
    const bool as_first = turn[it->unique] > 0;
    const auto right = std::find_if(it, end, [&](const FaceCopy& c) { return c.as_first == as_first; });
    const auto left = right != end ? right : it;
    for (auto copy = it; copy != end; ++copy) fate[copy->face] = FaceFate::kDropped;
    fate[left->face] = right != end ? FaceFate::kAsStored : FaceFate::kReversed;
    it = end;
  }
  return fate;
}

OrientedMesh with_fates(TriangleMesh mesh, const std::vector<FaceFate>& fate) {
  OrientationCounts counts;
  std::size_t left = 0;
  for (std::size_t i = 0; i < fate.size(); ++i) {
    if (fate[i] == FaceFate::kDropped) {
      ++counts.dropped_duplicates;
      continue;
    }
    mesh.triangles[left] = mesh.triangles[i];
    if (fate[i] == FaceFate::kReversed) {
      reverse(mesh.triangles[left]);
      ++counts.flipped_faces;
    }
    ++left;
  }
  mesh.triangles.resize(left);
  std::vector<std::uint32_t> places;
  for (std::size_t i = 0; counts.dropped_duplicates > 0 && i < fate.size(); ++i) {
    if (fate[i] != FaceFate::kDropped) places.push_back(static_cast<std::uint32_t>(i));
  }
  return {std::move(mesh), counts, std::move(places)};
}

OrientedMesh turned_to_agree(TriangleMesh mesh) {
  const DefaultFloatingPoint guard;
  const UniqueFaces unique = unique_faces(mesh, first_equal_vertices(mesh.vertices));
  const FaceEdges edges(unique.corners, mesh.vertices.size());
  const Patches patches = find_patches(unique.corners, edges, mesh.vertices);
  const Pieces pieces = find_pieces(patches, edges, unique.vote);
  const std::vector<int> turn_of_piece =
      turn_pieces(faces_of_pieces(unique, patches, pieces), pieces, scaled_vertices(mesh));
  std::vector<std::int8_t> turn(patches.sign);
  for (std::size_t face = 0; face < turn.size(); ++face) {
    const std::uint32_t patch = patches.of_face[face];
    turn[face] = static_cast<std::int8_t>(turn[face] * pieces.sign[patch] * turn_of_piece[pieces.of_patch[patch]]);
  }
  const std::vector<FaceFate> fate = fates(unique, turn, mesh.triangles.size());
  OrientedMesh result = with_fates(std::move(mesh), fate);
  result.counts.patches = patches.size();
  result.counts.cut_edges = patches.cut_edges;
  return result;
}

}  // namespace

OrientedMesh orient(TriangleMesh mesh, Orient how) {
  check_counts(mesh);
  if (how == Orient::kKeep || mesh.triangles.empty()) return {std::move(mesh), {}};
  return how == Orient::kFlip ? flipped(std::move(mesh)) : turned_to_agree(std::move(mesh));
}

}  // namespace raycone
