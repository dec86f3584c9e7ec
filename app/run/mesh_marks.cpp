#include "app/run/mesh_marks.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/mesh/mesh_flaws.h"

namespace raycone {
namespace {

// Distinct for the colour-blind, too (Okabe and Ito 2008).
constexpr Colour kSound{200, 200, 200};
constexpr Colour kIntersecting{240, 228, 66};
constexpr Colour kNonmanifold{204, 121, 167};
constexpr Colour kInconsistent{0, 114, 178};
constexpr Colour kExterior{213, 94, 0};

// A bar's radius: of the box's diagonal, and at most of the edge's length.
constexpr double kRadiusOfBox = 2e-3;
constexpr double kRadiusOfEdge = 0.1;

Colour colour_of(const EdgeUse& edge) {
  return edge.is_nonmanifold() ? kNonmanifold : edge.is_inconsistent() ? kInconsistent : kExterior;
}

std::uint32_t add_vertex(ColouredMesh& marked, const Vec3& position, const Colour& colour) {
  marked.vertices.push_back({position, colour});
  return static_cast<std::uint32_t>(marked.vertices.size() - 1);
}

void add_triangles(ColouredMesh& marked, const TriangleMesh& mesh, const std::vector<bool>& intersecting) {
  for (const Vec3& vertex : mesh.vertices) {
    // One that no triangle uses may be infinite, which programs do not expect.
    add_vertex(marked, is_finite(vertex) ? vertex : Vec3{}, kSound);
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!intersecting[i]) {
      marked.faces.push_back({mesh.triangles[i], kSound});
      continue;
    }
    // Vertices of its own: programs that show only the colours of vertices would blend those of neighbours.
    Triangle corners{};
    std::ranges::transform(mesh.triangles[i], corners.begin(), [&](std::uint32_t corner) {
      return add_vertex(marked, mesh.vertices[corner], kIntersecting);
    });
    marked.faces.push_back({corners, kIntersecting});
  }
}

// Nothing where the edge has no length, or one beyond doubles.
void add_bar(ColouredMesh& marked, const Vec3& from, const Vec3& to, double radius_of_box, const Colour& colour) {
  const double length = safe_norm(to - from);
  const double radius = std::min(radius_of_box, kRadiusOfEdge * length);
  if (!(radius > 0.0) || !std::isfinite(length)) return;
  const Vec3 along = (1.0 / length) * (to - from);
  // Of the axes the one that is least along the edge.
  const double x = std::abs(along.x), y = std::abs(along.y), z = std::abs(along.z);
  const Vec3 axis = x <= y && x <= z ? Vec3{1, 0, 0} : y <= z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  const Vec3 across = cross(along, axis);
  const Vec3 u = (radius / safe_norm(across)) * across, v = cross(along, u);
  const double half = 0.5, root = std::sqrt(0.75);
  std::array<std::uint32_t, 6> ring{};  // the three at `from`, then those at `to`
  std::size_t next = 0;
  for (const Vec3& end : {from, to}) {
    for (const Vec3& offset : {u, -half * u + root * v, -half * u + -root * v}) {
      ring[next++] = add_vertex(marked, end + offset, colour);
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    marked.faces.push_back({{ring[i], ring[j], ring[j + 3]}, colour});
    marked.faces.push_back({{ring[i], ring[j + 3], ring[i + 3]}, colour});
  }
}

}  // namespace

ColouredMesh marked_mesh(const TriangleMesh& mesh, const std::vector<bool>& intersecting) {
  ColouredMesh marked;
  add_triangles(marked, mesh, intersecting);
  const Box box = bounding_box(mesh);
  const double radius = kRadiusOfBox * safe_norm(box.upper - box.lower);
  for (const EdgeUse& edge : flawed_edges(mesh)) {
    const Colour colour = colour_of(edge);
    const Vec3 &from = mesh.vertices[edge.low], &to = mesh.vertices[edge.high];
    marked.edges.push_back({{add_vertex(marked, from, colour), add_vertex(marked, to, colour)}, colour});
    add_bar(marked, from, to, radius, colour);
  }
  return marked;
}

}  // namespace raycone
