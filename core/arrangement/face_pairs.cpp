#include "core/arrangement/face_pairs.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/data/vec3.h"
#include "core/exact/predicates.h"
#include "core/exact/projection.h"

namespace raycone {
namespace {

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

}  // namespace

std::optional<std::vector<FacePair>> face_pairs(const TriangleMesh& border) {
  const std::vector<FaceEdge> edges = face_edges(border.triangles);
  std::vector<FacePair> pairs;
  bool has_sides = true;
  for_each_edge(edges, [&](std::span<const FaceEdge> faces) {
    has_sides = has_sides && faces.size() % 2 == 0 && add_pairs(border, faces, pairs);
  });
  if (!has_sides) return std::nullopt;
  return pairs;
}

}  // namespace raycone
