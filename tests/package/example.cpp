// Winding numbers of a mesh in memory.
#include <raycone/weld.h>
#include <raycone/winding_number.h>

#include <cstddef>
#include <cstdio>
#include <vector>

int main() {
  // An octahedron; of its eight faces, counter-clockwise seen from outside, the one towards (-1, -1, -1) is missing.
  raycone::TriangleMesh mesh;
  mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {0, 3, 5}};

  const raycone::WindingNumberEvaluator evaluator(raycone::weld(mesh, {}));
  const std::vector<raycone::Vec3> points{{0, 0, 0}, {0.5, 0.25, 0}, {-1, -1, -1}};
  std::vector<double> values(points.size());
  evaluator.evaluate(points, values);

  std::printf("%zu exterior edges\n", static_cast<std::size_t>(evaluator.exterior_edges()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::printf("w(%g, %g, %g) = %.6f\n", points[i].x, points[i].y, points[i].z, values[i]);
  }
}
