#include "tests/property/cases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/mesh/weld.h"

namespace raycone::test {
namespace {

int below(Random& random, int n) { return static_cast<int>(random() % static_cast<std::uint64_t>(n)); }
bool chance(Random& random, double probability) { return uniform(random, 0, 1) < probability; }

// --- Meshes ---

TriangleMesh any_soup(Random& random) { return weld(soup(random, 1 + below(random, 60)), {}); }

TriangleMesh any_lattice_soup(Random& random) {
  return lattice_soup(random, 1 + below(random, 40), 1 + below(random, 4));
}

TriangleMesh any_cells(Random& random) { return random_cells(random, 1 + below(random, 4)); }

TriangleMesh any_fan(Random& random) {
  const int triangles = 2 + below(random, 8);
  return fan(triangles, below(random, triangles + 1));
}

// Faces of a base mesh duplicated, reversed and dropped.
TriangleMesh any_duplicates(Random& random) {
  TriangleMesh mesh = chance(random, 0.5) ? random_cells(random, 2) : sphere(4 + below(random, 4));
  const std::vector<Triangle> faces = mesh.triangles;
  mesh.triangles.clear();
  for (const Triangle& t : faces) {
    if (chance(random, 0.1)) continue;
    mesh.triangles.push_back(t);
    while (chance(random, 0.2)) mesh.triangles.push_back({t[1], t[2], t[0]});
    if (chance(random, 0.1)) mesh.triangles.push_back({t[0], t[2], t[1]});
  }
  if (mesh.triangles.empty()) mesh.triangles = faces;
  return mesh;
}

// Closed boxes on a common lattice: overlapping, touching in faces, edges and vertices.
TriangleMesh any_boxes(Random& random) {
  TriangleMesh mesh;
  for (int i = 1 + below(random, 4); i > 0; --i) {
    Vec3 lower, upper;
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = below(random, 3);
      upper[axis] = lower[axis] + 1 + below(random, 2);
    }
    const TriangleMesh box = box_mesh(lower, upper);
    mesh = mesh.triangles.empty() ? box : joined(mesh, chance(random, 0.3) ? reversed(box) : box);
  }
  return mesh;
}

// T-junctions: some faces split at the middle of an edge, their neighbours not.
TriangleMesh any_t_junctions(Random& random) {
  TriangleMesh mesh = chance(random, 0.5) ? sphere(5) : random_cells(random, 2);
  const std::size_t faces = mesh.triangles.size();
  for (std::size_t i = 0; i < faces; ++i) {
    if (!chance(random, 0.3)) continue;
    const Triangle t = mesh.triangles[i];
    const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(0.5 * (mesh.vertices[t[0]] + mesh.vertices[t[1]]));
    mesh.triangles[i] = {t[0], middle, t[2]};
    mesh.triangles.push_back({middle, t[1], t[2]});
  }
  return weld(mesh, {});
}

// Triangles whose third corner is on, or within 1e-6 to 1e-16 of, the opposite edge.
TriangleMesh any_slivers(Random& random) {
  TriangleMesh mesh;
  const Box unit{{0, 0, 0}, {1, 1, 1}};
  for (int i = 1 + below(random, 30); i > 0; --i) {
    const Vec3 a = uniform_point(random, unit), b = uniform_point(random, unit);
    const double offset = chance(random, 0.2) ? 0.0 : std::pow(10.0, -uniform(random, 6, 16));
    const Vec3 c = a + uniform(random, -0.5, 1.5) * (b - a) + offset * uniform_point(random, unit);
    add_triangle(mesh, a, b, c);
  }
  return weld(mesh, {});
}

// The connectivity of a closed mesh with uniformly random vertices ("Fast and Exact Winding Numbers", Fig. 4).
TriangleMesh any_scrambled(Random& random) {
  TriangleMesh mesh = sphere(3 + below(random, 8));
  if (chance(random, 0.3)) mesh.triangles.resize(mesh.triangles.size() - 1 - random() % 5);
  for (Vec3& v : mesh.vertices) v = uniform_point(random, {{0, 0, 0}, {1, 1, 1}});
  return mesh;
}

// A rolled-up strip ("Fast and Exact Winding Numbers", Fig. 5).
TriangleMesh any_swiss_roll(Random& random) {
  TriangleMesh mesh;
  const int steps = 20 + below(random, 60);
  const double turns = uniform(random, 1, 5);
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps, phi = 2 * std::numbers::pi * turns * t, r = 0.1 + t;
    for (const double z : {0.0, 1.0}) mesh.vertices.push_back({r * std::cos(phi), r * std::sin(phi), z});
  }
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(steps); ++i) {
    mesh.triangles.push_back({2 * i, 2 * i + 2, 2 * i + 1});
    mesh.triangles.push_back({2 * i + 1, 2 * i + 2, 2 * i + 3});
  }
  return mesh;
}

// Faces in the planes of rays and of the lattice only: prisms over random polygons of lattice points.
TriangleMesh any_parallel_faces(Random& random) {
  TriangleMesh mesh;
  for (int i = 1 + below(random, 12); i > 0; --i) {
    const int axis = below(random, 3);
    std::array<Vec3, 3> corners;
    const double level = below(random, 3);
    for (Vec3& c : corners) {
      c = {static_cast<double>(below(random, 4)), static_cast<double>(below(random, 4)),
           static_cast<double>(below(random, 4))};
      c[axis] = level;
    }
    const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), corners.begin(), corners.end());
    mesh.triangles.push_back({n, n + 1, n + 2});
  }
  return weld(mesh, {});
}

struct Family {
  const char* name;
  TriangleMesh (*make)(Random&);
};
constexpr std::array<Family, 11> kFamilies{{{"soup", any_soup},
                                            {"lattice soup", any_lattice_soup},
                                            {"random cells", any_cells},
                                            {"fan", any_fan},
                                            {"duplicated and reversed faces", any_duplicates},
                                            {"boxes", any_boxes},
                                            {"T-junctions", any_t_junctions},
                                            {"slivers", any_slivers},
                                            {"scrambled vertices", any_scrambled},
                                            {"Swiss roll", any_swiss_roll},
                                            {"faces parallel to the axes", any_parallel_faces}}};

// Somewhere else, of another size, flat or stretched.
TriangleMesh moved_at_random(const TriangleMesh& mesh, Random& random) {
  if (chance(random, 0.5)) return mesh;
  Vec3 factors{1, 1, 1}, shift;
  if (chance(random, 0.3)) factors[below(random, 3)] = std::pow(10.0, uniform(random, -7, 7));
  if (chance(random, 0.1)) factors[below(random, 3)] = 0.0;
  if (chance(random, 0.3)) shift = {5e5, 4.6e6, uniform(random, -100, 100)};
  const double size = chance(random, 0.3) ? std::pow(10.0, uniform(random, -120, 120)) : 1.0;
  return weld(moved(mesh, size * factors, size * shift), {});
}

// --- Queries ---

Vec3 vertex_of(const TriangleMesh& mesh, Random& random) {
  return mesh.vertices[mesh.triangles[random() % mesh.triangles.size()][random() % 3]];
}

Vec3 query_near(const TriangleMesh& mesh, const Box& box, Random& random) {
  const Triangle& t = mesh.triangles[random() % mesh.triangles.size()];
  const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  const Vec3 extent = box.upper - box.lower;
  const double distance = std::pow(10.0, -uniform(random, 1, 15));
  const Vec3 noise = uniform_point(random, {(-distance) * extent, distance * extent});
  const double u = uniform(random, 0, 1), v = uniform(random, 0, 1 - u);
  switch (below(random, 3)) {
    case 0:
      return a + noise;
    case 1:
      return a + u * (b - a) + noise;
    default:
      return a + u * (b - a) + v * (c - a) + noise;
  }
}

// Coordinates of different vertices, or the means of two: on lattices a node or half a node.
Vec3 query_of_coordinates(const TriangleMesh& mesh, Random& random) {
  Vec3 q;
  for (int axis = 0; axis < 3; ++axis) {
    const double x = vertex_of(mesh, random)[axis];
    q[axis] = chance(random, 0.5) ? x : 0.5 * x + 0.5 * vertex_of(mesh, random)[axis];
  }
  return q;
}

Vec3 query_one_ulp_off(const TriangleMesh& mesh, Random& random) {
  Vec3 q = query_of_coordinates(mesh, random);
  const int axis = below(random, 3);
  q[axis] = std::nextafter(q[axis], chance(random, 0.5) ? 1e300 : -1e300);
  return q;
}

Vec3 query_far_away(const Box& box, Random& random) {
  const Vec3 extent = box.upper - box.lower;
  const double size = std::max({extent.x, extent.y, extent.z}) * std::pow(10.0, uniform(random, 1, 15));
  Vec3 q = uniform_point(random, box);
  q[below(random, 3)] += chance(random, 0.5) ? size : -size;
  return q;
}

Vec3 any_query(const TriangleMesh& mesh, const Box& box, Random& random) {
  const Vec3 margin = 0.1 * (box.upper - box.lower);
  switch (below(random, 8)) {
    case 0:
    case 1:
      return uniform_point(random, {box.lower - margin, box.upper + margin});
    case 2:
      return query_near(mesh, box, random);
    case 3: {
      const Vec3 level = vertex_of(mesh, random);
      return {uniform(random, box.lower.x - margin.x, box.upper.x), level.y, level.z};
    }
    case 4:
    case 5:
      return query_of_coordinates(mesh, random);
    case 6:
      return query_one_ulp_off(mesh, random);
    default:
      return query_far_away(box, random);
  }
}

}  // namespace

std::size_t family_count() { return kFamilies.size(); }

Case make_case(std::size_t family, std::uint64_t seed) {
  constexpr int kQueries = 64;
  Random random(seed * 1000 + family);
  Case result{kFamilies[family].name, moved_at_random(kFamilies[family].make(random), random), {}};
  const Box box = bounding_box(result.mesh);
  for (int i = 0; i < kQueries; ++i) result.queries.push_back(any_query(result.mesh, box, random));
  return result;
}

}  // namespace raycone::test
