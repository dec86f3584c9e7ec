#include "tests/support/shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/mesh/weld.h"

namespace raycone::test {
namespace {

int below(Random& random, int n) { return static_cast<int>(random() % static_cast<std::uint64_t>(n)); }

void add_quad(TriangleMesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  add_triangle(mesh, a, b, c);
  add_triangle(mesh, a, c, d);
}

// One side of a box, seen from outside counter-clockwise; side 2 * axis is the lower one, 2 * axis + 1 the upper one.
void add_side(TriangleMesh& mesh, const Vec3& lower, const Vec3& upper, int side) {
  const int axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
  Vec3 a = lower, b = lower, c = upper, d = lower;
  b[u] = upper[u];
  d[v] = upper[v];
  c[axis] = lower[axis];
  if (side % 2 == 0) return add_quad(mesh, a, d, c, b);
  for (Vec3* p : {&a, &b, &c, &d}) (*p)[axis] = upper[axis];
  add_quad(mesh, a, b, c, d);
}

}  // namespace

double uniform(Random& random, double lower, double upper) {
  return lower + (upper - lower) * (static_cast<double>(random() >> 11) * 0x1p-53);
}

Vec3 uniform_point(Random& random, const Box& box) {
  const double x = uniform(random, box.lower.x, box.upper.x);
  const double y = uniform(random, box.lower.y, box.upper.y);
  return {x, y, uniform(random, box.lower.z, box.upper.z)};
}

void add_triangle(TriangleMesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {a, b, c});
  mesh.triangles.push_back({first, first + 1, first + 2});
}

TriangleMesh box_mesh(const Vec3& lower, const Vec3& upper) {
  TriangleMesh mesh;
  for (int side = 0; side < 6; ++side) add_side(mesh, lower, upper, side);
  return weld(mesh, {});
}

TriangleMesh open_box() {
  TriangleMesh mesh;
  for (int side = 0; side < 5; ++side) add_side(mesh, {0, 0, 0}, {1, 1, 1}, side);
  return weld(mesh, {});
}

TriangleMesh octahedron(double radius) {
  const double r = radius;
  return {{{r, 0, 0}, {-r, 0, 0}, {0, r, 0}, {0, -r, 0}, {0, 0, r}, {0, 0, -r}},
          {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
}

TriangleMesh prism(const std::vector<std::array<double, 2>>& corners, double height) {
  const auto n = static_cast<std::uint32_t>(corners.size());
  TriangleMesh mesh;
  for (const double z : {0.0, height}) {
    for (const auto& [x, y] : corners) mesh.vertices.push_back({x, y, z});
  }
  for (std::uint32_t i = 1; i + 1 < n; ++i) {
    mesh.triangles.push_back({0, i + 1, i});
    mesh.triangles.push_back({n, n + i, n + i + 1});
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    mesh.triangles.push_back({i, next, n + next});
    mesh.triangles.push_back({i, n + next, n + i});
  }
  return mesh;
}

TriangleMesh sphere(int rings) {
  const int slices = 2 * rings;
  const auto at = [&](int ring, int slice) -> Vec3 {
    if (ring == 0) return {0, 0, 1};
    if (ring == rings) return {0, 0, -1};
    const double theta = std::numbers::pi * ring / rings, phi = 2 * std::numbers::pi * (slice % slices) / slices;
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
  };
  TriangleMesh mesh;
  for (int ring = 0; ring < rings; ++ring) {
    for (int slice = 0; slice < slices; ++slice) {
      const Vec3 a = at(ring, slice), b = at(ring + 1, slice), c = at(ring + 1, slice + 1), d = at(ring, slice + 1);
      if (ring + 1 < rings) add_triangle(mesh, a, b, c);
      if (ring > 0) add_triangle(mesh, a, c, d);
    }
  }
  return weld(mesh, {});
}

TriangleMesh sieve(int rings, std::size_t each) {
  const TriangleMesh whole = sphere(rings);
  TriangleMesh mesh{whole.vertices, {}};
  for (std::size_t n = 0; n < whole.triangles.size(); ++n) {
    if (n % each != 0) mesh.triangles.push_back(whole.triangles[n]);
  }
  return mesh;
}

TriangleMesh soup(Random& random, int triangles) {
  TriangleMesh mesh;
  const Box unit{{0, 0, 0}, {1, 1, 1}};
  for (int i = 0; i < triangles; ++i) {
    const Vec3 a = uniform_point(random, unit), b = uniform_point(random, unit);
    add_triangle(mesh, a, b, uniform_point(random, unit));
  }
  return mesh;
}

TriangleMesh lattice_soup(Random& random, int triangles, int size) {
  TriangleMesh mesh;
  const auto corner = [&] {
    const double x = below(random, size + 1), y = below(random, size + 1);
    return Vec3{x, y, static_cast<double>(below(random, size + 1))};
  };
  for (int i = 0; i < triangles; ++i) {
    const Vec3 a = corner(), b = corner();
    add_triangle(mesh, a, b, corner());
  }
  return weld(mesh, {});
}

TriangleMesh dust(Random& random, int triangles) {
  TriangleMesh mesh;
  for (int n = 0; n < triangles; ++n) {
    const Vec3 middle{0.4 * std::cos(0.7 * n), 0.4 * std::sin(0.7 * n), uniform(random, -0.4, 0.4)};
    const auto corner = [&] { return middle + uniform_point(random, {{-0.01, -0.01, -0.01}, {0.01, 0.01, 0.01}}); };
    const Vec3 a = corner(), b = corner();
    add_triangle(mesh, a, b, corner());
  }
  return mesh;
}

TriangleMesh cells_mesh(const std::vector<std::array<int, 3>>& cells) {
  TriangleMesh mesh;
  const auto is_filled = [&](const std::array<int, 3>& cell) { return std::ranges::find(cells, cell) != cells.end(); };
  for (const auto& [i, j, k] : cells) {
    const Vec3 lower{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
    for (int side = 0; side < 6; ++side) {
      std::array<int, 3> beyond{i, j, k};
      beyond[static_cast<std::size_t>(side / 2)] += side % 2 == 0 ? -1 : 1;
      if (!is_filled(beyond)) add_side(mesh, lower, lower + Vec3{1, 1, 1}, side);
    }
  }
  return weld(mesh, {});
}

TriangleMesh random_cells(Random& random, int size) {
  std::vector<std::array<int, 3>> cells;
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j < size; ++j) {
      for (int k = 0; k < size; ++k) {
        if (below(random, 2) == 1 || (i == 0 && j == 0 && k == 0)) cells.push_back({i, j, k});
      }
    }
  }
  return cells_mesh(cells);
}

TriangleMesh notched_fan() {
  constexpr std::uint32_t kCorners = 700;
  TriangleMesh mesh;
  for (std::uint32_t n = 0; n < kCorners; ++n) {
    const double angle = 2 * std::numbers::pi * n / kCorners, radius = n % 2 == 0 ? 0.45 : 0.4;
    mesh.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), 0.0});
  }
  mesh.vertices.push_back({0.01, 0.02, -0.45});
  for (std::uint32_t n = 0; n < kCorners; ++n) mesh.triangles.push_back({n, kCorners, (n + 1) % kCorners});
  return mesh;
}

TriangleMesh fan(int triangles, int same) {
  TriangleMesh mesh;
  const Vec3 a{0, 0, 0}, b{0.25, 0.5, 1};
  for (int i = 0; i < triangles; ++i) {
    const double phi = 2 * std::numbers::pi * i / triangles;
    const Vec3 tip{std::cos(phi), std::sin(phi), 0.5};
    if (i < same) {
      add_triangle(mesh, a, b, tip);
    } else {
      add_triangle(mesh, b, a, tip);
    }
  }
  return weld(mesh, {});
}

TriangleMesh assorted_triangles() {
  Random random(1);
  TriangleMesh mesh;
  const auto point = [&] { return uniform_point(random, {{0, 0, 0}, {1, 1, 1}}); };
  for (int n = 0; n < 6; ++n) {
    const Vec3 a = point(), b = point();
    add_triangle(mesh, a, b, point());
  }
  for (int n = 0; n < 200; ++n) {
    const Vec3 at = point(), side = 0.03 * point();
    add_triangle(mesh, at, at + side, at + 0.03 * point());
  }
  const Vec3 a = point(), b = point();
  add_triangle(mesh, a, b, a + 0.3 * (b - a) + 1e-9 * point());
  add_triangle(mesh, a, b, b);
  add_triangle(mesh, {0.9, 0.1, 0.1}, {0.9, 0.1, 0.1}, {0.9, 0.1, 0.1});
  add_triangle(mesh, {-3, 0.5, 0.5}, {5, 0.4, 0.5}, {5, 0.5, 0.6});
  add_triangle(mesh, {0.2, 0, 0}, {0.2, 1, 0}, {0.2, 0, 1});
  add_triangle(mesh, {0, 0.6, 0}, {1, 0.6, 0}, {0, 0.6, 1});
  return mesh;
}

TriangleMesh reversed(TriangleMesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

TriangleMesh with_holes(TriangleMesh mesh, Random& random, double probability) {
  std::erase_if(mesh.triangles, [&](const Triangle&) { return uniform(random, 0, 1) < probability; });
  return mesh;
}

TriangleMesh loosened(const TriangleMesh& mesh, Random& random, double most) {
  TriangleMesh loose;
  for (const Triangle& t : mesh.triangles) {
    const auto [a, b, c] = corners_of(mesh, t);
    const Vec3 shift = uniform_point(random, {{-most, -most, -most}, {most, most, most}});
    add_triangle(loose, a + shift, b + shift, c + shift);
  }
  return loose;
}

TriangleMesh shrunk_faces(const TriangleMesh& mesh, double factor) {
  TriangleMesh shrunk;
  for (const Triangle& t : mesh.triangles) {
    const auto [a, b, c] = corners_of(mesh, t);
    const Vec3 middle = (1.0 / 3.0) * (a + b + c);
    add_triangle(shrunk, middle + factor * (a - middle), middle + factor * (b - middle),
                 middle + factor * (c - middle));
  }
  return shrunk;
}

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh mesh = a;
  const auto shift = static_cast<std::uint32_t>(a.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const Triangle& t : b.triangles) mesh.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  return weld(mesh, {});
}

TriangleMesh moved(TriangleMesh mesh, const Vec3& factors, const Vec3& shift) {
  for (Vec3& p : mesh.vertices) p = Vec3{factors.x * p.x, factors.y * p.y, factors.z * p.z} + shift;
  return mesh;
}

TriangleMesh shuffled(const TriangleMesh& mesh, Random& random) {
  std::vector<std::uint32_t> place(mesh.vertices.size());
  std::iota(place.begin(), place.end(), 0U);
  std::shuffle(place.begin(), place.end(), random);
  TriangleMesh result = mesh;
  for (std::size_t v = 0; v < place.size(); ++v) result.vertices[place[v]] = mesh.vertices[v];
  for (Triangle& t : result.triangles) {
    t = {place[t[0]], place[t[1]], place[t[2]]};
    std::rotate(t.begin(), t.begin() + below(random, 3), t.end());
  }
  std::shuffle(result.triangles.begin(), result.triangles.end(), random);
  return result;
}

}  // namespace raycone::test
