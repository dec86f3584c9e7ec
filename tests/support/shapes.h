// Meshes for tests.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone::test {

using Random = std::mt19937_64;

// Uniform in [lower, upper); the same on every platform, unlike std::uniform_real_distribution.
[[nodiscard]] double uniform(Random& random, double lower, double upper);
[[nodiscard]] Vec3 uniform_point(Random& random, const Box& box);

// One more triangle, with vertices of its own; its front side sees a, b, c counter-clockwise.
void add_triangle(TriangleMesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c);

// The closed box with outward faces, two triangles a side.
[[nodiscard]] TriangleMesh box_mesh(const Vec3& lower, const Vec3& upper);
// The unit cube without its top (z = 1).
[[nodiscard]] TriangleMesh open_box();
// With its six corners on the axes, so far from the origin; closed, outward.
[[nodiscard]] TriangleMesh octahedron(double radius = 1.0);
// Upright from z = 0 on, over a polygon that is star-shaped from its first corner, counter-clockwise; closed, outward.
[[nodiscard]] TriangleMesh prism(const std::vector<std::array<double, 2>>& corners, double height);
// A closed sphere of radius 1 about the origin: `rings` bands of 2 * `rings` slices, outward.
[[nodiscard]] TriangleMesh sphere(int rings);
// sphere() with holes all over: of every so many faces, the first is missing.
[[nodiscard]] TriangleMesh sieve(int rings, std::size_t each);
// Unrelated triangles with uniform corners in the unit cube.
[[nodiscard]] TriangleMesh soup(Random& random, int triangles);
// Unrelated triangles with corners on the integer lattice {0 .. size}^3: every kind of degeneracy.
[[nodiscard]] TriangleMesh lattice_soup(Random& random, int triangles, int size);
// Unrelated triangles, up to 0.02 wide, near a cylinder of radius 0.4 about the z axis.
[[nodiscard]] TriangleMesh dust(Random& random, int triangles);
// The boundary of unit cubes, given by their lowest corners, each once.
[[nodiscard]] TriangleMesh cells_mesh(const std::vector<std::array<int, 3>>& cells);
// The closed boundary of a random set of unit cells of {0 .. size}^3: every lattice ray through it is degenerate, and
// cells touch in edges and vertices only.
[[nodiscard]] TriangleMesh random_cells(Random& random, int size);
// Triangles around one common edge, the first `same` of them in one direction, the others in the other.
[[nodiscard]] TriangleMesh fan(int triangles, int same);
// A cone without its base, whose rim of 700 corners lies in the plane z = 0 and is notched.
[[nodiscard]] TriangleMesh notched_fan();

// Large triangles and small ones, a needle, a segment and a point, across and along the axes, some reaching far out of
// [0, 1]^3.
[[nodiscard]] TriangleMesh assorted_triangles();

[[nodiscard]] TriangleMesh reversed(TriangleMesh mesh);
// Each face is missing with this probability.
[[nodiscard]] TriangleMesh with_holes(TriangleMesh mesh, Random& random, double probability);
// No two faces meet: each is moved along each axis by up to so much, at random.
[[nodiscard]] TriangleMesh loosened(const TriangleMesh& mesh, Random& random, double most);
// No two faces meet: each is shrunk about its middle by this factor.
[[nodiscard]] TriangleMesh shrunk_faces(const TriangleMesh& mesh, double factor);
[[nodiscard]] TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b);
// All vertices as A v + shift, A diagonal.
[[nodiscard]] TriangleMesh moved(TriangleMesh mesh, const Vec3& factors, const Vec3& shift);
// Faces in another order, each starting at another corner; vertices renumbered.
[[nodiscard]] TriangleMesh shuffled(const TriangleMesh& mesh, Random& random);

}  // namespace raycone::test
