// Polygons against winding numbers of the polygon itself, counted in integers.
//
// Polygons have integer coordinates (s, t) in a plane that is put into space by integer vectors, so that everything is
// exact and the oracle need not know how the code projects.
#include "core/mesh/polygons.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <map>
#include <utility>

#include "core/exact/projection.h"
#include "core/mesh/polygon_cut.h"
#include "core/sampling/random.h"

namespace raycone {
namespace {

using Int = __int128;
using Flat = std::array<std::int64_t, 2>;  // coordinates in the plane
using Corners = std::vector<Flat>;

Int turn(const Flat& a, const Flat& b, const Flat& c) {
  return Int(b[0] - a[0]) * (c[1] - a[1]) - Int(b[1] - a[1]) * (c[0] - a[0]);
}

Int doubled_area(const Corners& corners) {
  Int sum = 0;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) sum += turn(corners[0], corners[i], corners[i + 1]);
  return sum;
}

bool on_segment(const Flat& a, const Flat& b, const Flat& p) {
  return turn(a, b, p) == 0 && std::min(a[0], b[0]) <= p[0] && p[0] <= std::max(a[0], b[0]) &&
         std::min(a[1], b[1]) <= p[1] && p[1] <= std::max(a[1], b[1]);
}

bool on_boundary(const Corners& corners, const Flat& p) {
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (on_segment(corners[i], corners[(i + 1) % corners.size()], p)) return true;
  return false;
}

// Upward edges to the right of p less downward ones. p must not lie on an edge.
int winding(const Corners& corners, const Flat& p) {
  int sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Flat &a = corners[i], &b = corners[(i + 1) % corners.size()];
    if (a[1] <= p[1] && b[1] > p[1] && turn(a, b, p) > 0) ++sum;
    if (b[1] <= p[1] && a[1] > p[1] && turn(a, b, p) < 0) --sum;
  }
  return sum;
}

// Whether two edges cross where no corner is.
bool edges_cross(const Corners& c) {
  const auto opposite = [](Int x, Int y) { return (x > 0 && y < 0) || (x < 0 && y > 0); };
  const auto corner_on_both = [&](const Flat& a, const Flat& b, const Flat& p, const Flat& q) {
    return std::any_of(c.begin(), c.end(),
                       [&](const Flat& corner) { return on_segment(a, b, corner) && on_segment(p, q, corner); });
  };
  for (std::size_t i = 0; i < c.size(); ++i) {
    for (std::size_t j = i + 1; j < c.size(); ++j) {
      const Flat &a = c[i], &b = c[(i + 1) % c.size()], &p = c[j], &q = c[(j + 1) % c.size()];
      if (opposite(turn(a, b, p), turn(a, b, q)) && opposite(turn(p, q, a), turn(p, q, b)) &&
          !corner_on_both(a, b, p, q))
        return true;
    }
  }
  return false;
}

// Points all over the polygon's box that lie on none of its edges.
std::vector<Flat> probes(const Corners& corners, int per_side) {
  Flat low = corners[0], high = corners[0];
  for (const Flat& corner : corners) {
    for (std::size_t k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], corner[k]);
      high[k] = std::max(high[k], corner[k]);
    }
  }
  std::vector<Flat> points;
  for (int i = 0; i < per_side; ++i) {
    for (int j = 0; j < per_side; ++j) {
      const Flat p{low[0] + (high[0] - low[0]) * i / per_side + 5, low[1] + (high[1] - low[1]) * j / per_side + 11};
      if (!on_boundary(corners, p)) points.push_back(p);
    }
  }
  return points;
}

// origin + s u + t v
struct Plane {
  Vec3 origin{0, 0, 0}, u{1, 0, 0}, v{0, 1, 0};
  [[nodiscard]] Vec3 at(const Flat& p) const {
    return origin + static_cast<double>(p[0]) * u + static_cast<double>(p[1]) * v;
  }
};

Plane random_plane(Random& random) {
  const auto component = [&] { return std::floor(random.uniform() * 2001.0) - 1000.0; };
  const auto vector = [&] { return Vec3{component(), component(), component()}; };
  Plane plane{vector(), vector(), vector()};
  while (cross(plane.u, plane.v) == Vec3{}) plane.v = vector();
  return plane;
}

TriangleMesh fan(const std::vector<Vec3>& corners) {
  TriangleMesh mesh{corners, {}};
  for (std::uint32_t i = 1; i + 1 < corners.size(); ++i) mesh.triangles.push_back({0, i, i + 1});
  return mesh;
}

TriangleMesh fan(const Corners& corners, const Plane& plane) {
  std::vector<Vec3> vertices;
  for (const Flat& corner : corners) vertices.push_back(plane.at(corner));
  return fan(vertices);
}

std::uint64_t cut(TriangleMesh& mesh) {
  const PolygonFan polygon{0, mesh.triangles.size()};
  return cut_concave_polygons(mesh, {&polygon, 1});
}

// Directed edges between positions, opposite ones cancelled.
std::map<std::pair<Flat, Flat>, int> boundary(const std::vector<Corners>& polygons) {
  std::map<std::pair<Flat, Flat>, int> net;
  for (const Corners& polygon : polygons) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Flat &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      if (a < b) ++net[{a, b}];
      if (b < a) --net[{b, a}];
    }
  }
  std::erase_if(net, [](const auto& entry) { return entry.second == 0; });
  return net;
}

std::vector<Corners> flat_triangles(const TriangleMesh& mesh, const Corners& corners) {
  std::vector<Corners> triangles;
  for (const Triangle& t : mesh.triangles) triangles.push_back({corners[t[0]], corners[t[1]], corners[t[2]]});
  return triangles;
}

// What is wrong with the triangles as a cover of the polygon; "" where nothing is.
std::string defect(const TriangleMesh& mesh, const Corners& corners, int per_side) {
  const std::vector<Corners> triangles = flat_triangles(mesh, corners);
  const int sign = doubled_area(corners) < 0 ? -1 : 1;
  Int area = 0;
  for (const Corners& triangle : triangles) {
    if (doubled_area(triangle) * sign < 0) return "a triangle is turned over";
    area += doubled_area(triangle);
  }
  if (area != doubled_area(corners)) return "the areas do not add up";
  if (boundary(triangles) != boundary({corners})) return "the boundary is another";
  for (const Flat& p : probes(corners, per_side)) {
    int count = 0;
    for (const Corners& triangle : triangles) {
      if (on_boundary(triangle, p)) {
        count = -1000;
        break;
      }
      count += winding(triangle, p);
    }
    if (count > -1000 && count != winding(corners, p)) return "a point is covered by another number of triangles";
  }
  return "";
}

// By its definition, but for probes in place of all points.
bool is_simple(const Corners& corners) {
  const Int area = doubled_area(corners);
  if (area == 0) {
    return std::all_of(corners.begin(), corners.end(), [&](const Flat& p) {
      return std::all_of(corners.begin(), corners.end(), [&](const Flat& q) { return turn(corners[0], p, q) == 0; });
    });
  }
  if (edges_cross(corners)) return false;
  const auto points = probes(corners, 60);
  return std::all_of(points.begin(), points.end(), [&](const Flat& p) {
    const int w = winding(corners, p) * (area < 0 ? -1 : 1);
    return w == 0 || w == 1;
  });
}

// Room between coordinates for probes.
constexpr std::int64_t kUnit = 10007;

Corners scaled(Corners corners) {
  for (Flat& corner : corners) corner = {corner[0] * kUnit, corner[1] * kUnit};
  return corners;
}

Corners rotated(Corners corners, std::size_t shift) {
  std::rotate(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(shift), corners.end());
  return corners;
}

const Corners kL = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}};

std::vector<std::array<Vec3, 3>> sorted_triangles(const TriangleMesh& mesh) {
  std::vector<std::array<Vec3, 3>> triangles;
  const auto order = [](const Vec3& a, const Vec3& b) { return lexicographic_order(a, b) < 0; };
  for (const Triangle& t : mesh.triangles) {
    std::array<Vec3, 3> triangle{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
    std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end(), order), triangle.end());
    triangles.push_back(triangle);
  }
  std::sort(triangles.begin(), triangles.end(), [&](const auto& a, const auto& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), order);
  });
  return triangles;
}

// From every first corner, and in both orientations.
void expect_cut(const Corners& corners, int per_side = 24) {
  Random random(7, corners.size());
  for (std::size_t shift = 0; shift < corners.size(); shift += 1 + corners.size() / 24) {
    for (const bool reversed : {false, true}) {
      Corners polygon = rotated(scaled(corners), shift);
      if (reversed) std::reverse(polygon.begin(), polygon.end());
      TriangleMesh mesh = fan(polygon, random_plane(random));
      EXPECT_EQ(cut(mesh), 0U) << shift;
      EXPECT_EQ(defect(mesh, polygon, per_side), "") << shift;
    }
  }
}

void expect_bad(const Corners& corners) {
  for (std::size_t shift = 0; shift < corners.size(); ++shift) {
    TriangleMesh mesh = fan(rotated(scaled(corners), shift), {});
    const TriangleMesh before = mesh;
    EXPECT_EQ(cut(mesh), 1U) << shift;
    EXPECT_EQ(mesh.triangles, before.triangles);
  }
}

// What the other tests rely on: they would notice a plain fan.
TEST(Polygons, FanOfAConcavePolygonIsFound) {
  const Corners corners = rotated(scaled(kL), 1);
  EXPECT_EQ(defect(fan(corners, {}), corners, 24), "a triangle is turned over");
}

TEST(Polygons, ConcaveOnesAreCut) {
  expect_cut(kL);
  expect_cut({{0, 0}, {4, 0}, {4, 4}, {3, 1}});                                  // an arrow
  expect_cut({{0, 0}, {9, 0}, {9, 9}, {0, 9}, {0, 5}, {6, 5}, {6, 4}, {0, 4}});  // a slit
}

TEST(Polygons, PlacesBehindThoseThatBecomeFewerTrianglesMove) {
  // A square with a spike, 6 corners: 2 triangles. It is there twice, with single triangles around each.
  const std::vector<Vec3> vertices{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {2, 2, 0}, {0, 1, 0}};
  const std::vector<Triangle> single{{0, 1, 4}}, spike{{0, 1, 2}, {0, 2, 3}, {0, 3, 2}, {0, 2, 4}};
  TriangleMesh mesh{vertices, {}};
  for (const auto* const faces : {&single, &spike, &single, &spike, &spike, &single}) {
    mesh.triangles.insert(mesh.triangles.end(), faces->begin(), faces->end());
  }
  const std::vector<PolygonFan> fans{{1, 4}, {6, 4}, {10, 4}};
  std::vector<std::uint64_t> places{0, 1, 5, 6, 10, 14, 15};
  EXPECT_EQ(cut_concave_polygons(mesh, fans, places), 0U);
  EXPECT_EQ(mesh.triangles.size(), 9U);
  EXPECT_EQ(places, (std::vector<std::uint64_t>{0, 1, 3, 4, 6, 8, 9}));
}

TEST(Polygons, ConvexOnesKeepTheirFan) {
  for (const Corners& corners : {Corners{{0, 0}, {2, 0}, {2, 2}, {0, 2}},
                                 Corners{{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}},
                                 Corners{{0, 0}, {2, 0}, {3, 1}, {2, 2}, {0, 2}, {-1, 1}}}) {
    Random random(1, 2);
    for (std::size_t shift = 0; shift < corners.size(); ++shift) {
      TriangleMesh mesh = fan(rotated(scaled(corners), shift), random_plane(random));
      const TriangleMesh before = mesh;
      EXPECT_EQ(cut(mesh), 0U);
      EXPECT_EQ(mesh.triangles, before.triangles) << shift;
    }
  }
}

TEST(Polygons, RepeatedCornersAndThoseInARowDoNotMatter) {
  expect_cut({{0, 0}, {0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 1}, {1, 1}, {1, 2}, {1, 3}, {0, 3}, {0, 2}, {0, 1}});
}

// A bridge, of two edges that cancel, leads to the hole.
TEST(Polygons, HolesBehindABridgeStayOpen) {
  expect_cut({{0, 0}, {9, 0}, {9, 9}, {0, 9}, {0, 0}, {3, 3}, {3, 6}, {6, 6}, {6, 3}, {3, 3}});
  expect_cut({{0, 0},
              {9, 0},
              {9, 9},
              {0, 9},
              {0, 0},
              {2, 2},
              {2, 4},
              {4, 4},
              {5, 5},
              {5, 7},
              {7, 7},
              {7, 5},
              {5, 5},
              {4, 4},
              {4, 2},
              {2, 2}});
}

TEST(Polygons, MayTouchThemselves) {
  expect_cut({{0, 0}, {4, 0}, {2, 2}, {4, 4}, {0, 4}, {2, 2}});          // at a vertex
  expect_cut({{0, 0}, {8, 0}, {8, 8}, {4, 0}, {0, 8}});                  // a vertex on an edge
  expect_cut({{0, 0}, {6, 0}, {6, 3}, {9, 3}, {6, 3}, {6, 6}, {0, 6}});  // a spur outside
  expect_cut({{0, 0}, {6, 0}, {6, 3}, {3, 3}, {6, 3}, {6, 6}, {0, 6}});  // a spur inside
  expect_cut({{0, 0}, {8, 0}, {8, 8}, {6, 0}, {4, 4}, {2, 0}, {0, 8}});  // two vertices on one edge
}

TEST(Polygons, ThoseThatCrossThemselvesAreCounted) {
  expect_bad({{0, 0}, {2, 2}, {2, 0}, {0, 2}});  // no area
  expect_bad({{0, 0}, {4, 3}, {4, 0}, {0, 2}});
  expect_bad({{0, 3}, {-2, -3}, {3, 1}, {-3, 1}, {2, -3}});      // a pentagram turns left everywhere
  expect_bad({{0, 0}, {2, 0}, {0, 2}, {0, 0}, {2, 0}, {0, 2}});  // twice the same triangle
  expect_bad({{0, 0}, {1, 0}, {1, 1}, {-1, 1}, {-1, 0}, {1, 0}, {1, 1}, {-1, 1}, {-1, 0}});
}

TEST(Polygons, OnALineNothingCanBeLeft) {
  for (const Corners& corners : {Corners{{0, 0}, {1, 2}, {3, 6}, {2, 4}}, Corners{{0, 0}, {0, 0}, {0, 0}, {0, 0}},
                                 Corners{{0, 0}, {1, 0}, {0, 0}, {1, 0}}}) {
    TriangleMesh mesh = fan(corners, {});
    const TriangleMesh before = mesh;
    EXPECT_EQ(cut(mesh), 0U);
    EXPECT_EQ(mesh.triangles, before.triangles);
  }
}

// Every way to draw few corners on a small grid has its turn to come: crossings, spurs, holes, repetitions.
std::string printed(const Corners& corners) {
  std::string text;
  for (const Flat& corner : corners)
    text += "(" + std::to_string(corner[0] / kUnit) + "," + std::to_string(corner[1] / kUnit) + ") ";
  return text;
}

TEST(Polygons, RandomOnesOnASmallGrid) {
  Random random(1, 0);
  int bad = 0, cut_up = 0, kept = 0;
  for (int round = 0; round < 1500; ++round) {
    const std::size_t n = 4 + random.bits() % 6;
    Corners corners;
    for (std::size_t i = 0; i < n; ++i) {
      corners.push_back({static_cast<std::int64_t>(random.bits() % 4), static_cast<std::int64_t>(random.bits() % 4)});
    }
    corners = scaled(corners);
    TriangleMesh mesh = fan(corners, random_plane(random));
    const TriangleMesh before = mesh;
    const bool simple = is_simple(corners);
    EXPECT_EQ(cut(mesh), simple ? 0U : 1U) << printed(corners);
    if (simple) {
      ASSERT_EQ(defect(mesh, corners, 30), "") << printed(corners);
    } else {
      ASSERT_EQ(mesh.triangles, before.triangles) << printed(corners);
    }
    bad += !simple;
    cut_up += mesh.triangles != before.triangles;
    kept += simple && mesh.triangles == before.triangles;
  }
  EXPECT_GT(bad, 100);
  EXPECT_GT(cut_up, 100);
  EXPECT_GT(kept, 100);
}

// Around the origin, in order of their angle; of those at one angle a row outwards.
Corners star_shaped(Random& random, std::size_t n) {
  Corners corners;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 2 * 3.141592653589793 * static_cast<double>(i) / static_cast<double>(n);
    const double radius = (0.05 + random.uniform()) * 1e6;
    corners.push_back({std::llround(radius * std::cos(angle)), std::llround(radius * std::sin(angle))});
  }
  return corners;
}

Corners spiral(std::int64_t turns) {
  Corners outwards, inwards;
  for (std::int64_t r = 1; r <= turns; ++r) {
    for (const Flat& c : {Flat{-3 * r, -3 * r}, Flat{3 * r, -3 * r}, Flat{3 * r, 3 * r}, Flat{-3 * r - 3, 3 * r}})
      outwards.push_back(c);
    for (const Flat& c : {Flat{1 - 3 * r, 1 - 3 * r}, Flat{3 * r - 1, 1 - 3 * r}, Flat{3 * r - 1, 3 * r - 1},
                          Flat{-3 * r - 2, 3 * r - 1}})
      inwards.push_back(c);
  }
  outwards.insert(outwards.end(), inwards.rbegin(), inwards.rend());
  return outwards;
}

Corners comb(std::int64_t teeth) {
  Corners corners{{2 * teeth, 0}};
  for (std::int64_t i = teeth; i-- > 0;) {
    for (const Flat& c : {Flat{2 * i + 2, 100 * teeth}, Flat{2 * i + 1, 1}, Flat{2 * i, 1}}) corners.push_back(c);
  }
  corners.push_back({0, 0});
  return corners;
}

TEST(Polygons, ManyCorners) {
  Random random(3, 0);
  for (const Corners& corners : {star_shaped(random, 40), star_shaped(random, 300), spiral(12), comb(60)}) {
    const std::int64_t unit = corners[0][0] > 10000 || corners[1][0] > 10000 ? 1 : kUnit;
    Corners polygon = corners;
    for (Flat& corner : polygon) corner = {corner[0] * unit, corner[1] * unit};
    TriangleMesh mesh = fan(polygon, random_plane(random));
    EXPECT_EQ(cut(mesh), 0U);
    EXPECT_EQ(mesh.triangles.size(), corners.size() - 2);
    EXPECT_EQ(defect(mesh, polygon, 40), "");
  }
}

// Holes on bridges from one corner.
Corners bridges_from_a_corner(std::int64_t holes) {
  Corners corners{{0, 0}, {200 * holes, 0}, {200 * holes, 200 * holes}, {0, 200 * holes}, {0, 0}};
  for (std::int64_t i = 1; i < holes; ++i) {
    const Flat q{100 * (holes - i), 100 * i};
    for (const Flat& c : {q, Flat{q[0], q[1] + 5}, Flat{q[0] + 5, q[1]}, q, Flat{0, 0}}) corners.push_back(c);
  }
  return corners;
}

// All but one on a line, in runs each of which lies in the one before.
Corners nested_runs(std::int64_t runs) {
  Corners corners;
  for (std::int64_t i = 0; i < runs; ++i) {
    corners.push_back({i, 0});
    corners.push_back({4 * runs - i, 0});
  }
  corners.push_back({runs, 9});
  return corners;
}

// All but one on a line, in runs at random.
Corners random_runs(Random& random, std::uint64_t runs) {
  Corners corners;
  for (std::uint64_t i = 0; i < runs; ++i)
    corners.push_back({static_cast<std::int64_t>(random.bits() % (2 * runs)), 0});
  corners.push_back({0, 5});
  return corners;
}

// Teeth that touch the side opposite to them.
Corners touching_teeth(std::int64_t teeth) {
  Corners corners{{0, 0}, {2 * teeth, 0}, {2 * teeth, 7}};
  for (std::int64_t i = teeth; i-- > 1;) {
    corners.push_back({2 * i + 1, 5});
    corners.push_back({2 * i, 0});
  }
  corners.push_back({1, 5});
  return corners;
}

TEST(Polygons, ManyCornersThatTouch) {
  Random random(5, 0);
  for (const Corners& corners :
       {bridges_from_a_corner(12), nested_runs(20), random_runs(random, 40), touching_teeth(20)})
    expect_cut(corners);
}

// Of each kind what took quadratic time would take minutes.
TEST(Polygons, HundredThousandCornersTakeNoLongTime) {
  Random random(6, 0);
  constexpr double kSeconds = 20;  // measured: 0.2 to 0.7 s; sanitizers take ten times as long
  for (const Corners& corners : {comb(33333), spiral(12500), bridges_from_a_corner(20000), nested_runs(50000),
                                 random_runs(random, 100000), touching_teeth(50000)}) {
    TriangleMesh mesh = fan(corners, {{}, {3, -7, 11}, {2, 13, -5}});
    const std::clock_t start = std::clock();
    EXPECT_EQ(cut(mesh), 0U);
    EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, kSeconds);
  }
}

// --- Walks on a lattice ---------------------------------------------------------------------------------------------

// Directed unit edges of a lattice.
class LatticeGraph {
 public:
  explicit LatticeGraph(std::int64_t cells) : cells_(cells) {}

  void add(const Flat& a, const Flat& b) { out_[a].push_back(b); }

  // The boundary of random cells, and the two ways of random edges, so many that all are connected.
  void fill(Random& random) {
    for (std::int64_t x = 0; x < cells_; ++x)
      for (std::int64_t y = 0; y < cells_; ++y)
        if (random.bits() % 2 == 0) add_cell(x, y);
    for (auto& [from, ends] : out_) cancel(from, ends);
    for (std::int64_t x = 0; x <= cells_; ++x) {
      for (std::int64_t y = 0; y <= cells_; ++y) {
        for (const Flat& to : {Flat{x + 1, y}, Flat{x, y + 1}}) {
          if (to[0] > cells_ || to[1] > cells_ || random.bits() % 3 != 0) continue;
          add({x, y}, to);
          add(to, {x, y});
        }
      }
    }
  }

  // A closed walk along each edge that can be reached from one end, once (Hierholzer 1873).
  Corners walk(Random& random) {
    std::vector<Flat> path{
        std::find_if(out_.begin(), out_.end(), [](const auto& e) { return !e.second.empty(); })->first};
    Corners circuit;
    while (!path.empty()) {
      std::vector<Flat>& ends = out_[path.back()];
      if (ends.empty()) {
        circuit.push_back(path.back());
        path.pop_back();
        continue;
      }
      std::swap(ends[random.bits() % ends.size()], ends.back());
      const Flat to = ends.back();
      ends.pop_back();
      path.push_back(to);
    }
    circuit.pop_back();
    std::reverse(circuit.begin(), circuit.end());
    return circuit;
  }

 private:
  void add_cell(std::int64_t x, std::int64_t y) {
    const std::array<Flat, 4> c{Flat{x, y}, Flat{x + 1, y}, Flat{x + 1, y + 1}, Flat{x, y + 1}};
    for (std::size_t i = 0; i < 4; ++i) add(c[i], c[(i + 1) % 4]);
  }

  void cancel(const Flat& from, std::vector<Flat>& ends) {
    std::erase_if(ends, [&](const Flat& to) { return from < to && std::erase(out_[to], from) > 0; });
  }

  std::int64_t cells_;
  std::map<Flat, std::vector<Flat>> out_;
};

// Joins some of the steps in one direction to longer ones.
Corners joined(Random& random, const Corners& corners) {
  Corners kept;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Flat &a = kept.empty() ? corners.back() : kept.back(), &b = corners[i],
               &c = corners[(i + 1) % corners.size()];
    const bool straight = turn(a, b, c) == 0 && Int(b[0] - a[0]) * (c[0] - b[0]) + Int(b[1] - a[1]) * (c[1] - b[1]) > 0;
    if (!straight || random.bits() % 3 == 0) kept.push_back(b);
  }
  return kept;
}

// Such walks wind 0 or 1 times and cross nowhere but at corners; they touch and overlap themselves all the time.
TEST(Polygons, WalksOnALattice) {
  Random random(8, 0);
  int cut_up = 0;
  for (int round = 0; round < 400; ++round) {
    LatticeGraph graph(2 + static_cast<std::int64_t>(random.bits() % 4));
    graph.fill(random);
    Corners corners = scaled(joined(random, graph.walk(random)));
    if (corners.size() < 4 || doubled_area(corners) == 0 || edges_cross(corners)) continue;
    if (random.bits() % 2 == 0) std::reverse(corners.begin(), corners.end());
    TriangleMesh mesh = fan(corners, random_plane(random));
    ASSERT_EQ(cut(mesh), 0U) << printed(corners);
    ASSERT_EQ(defect(mesh, corners, 30), "") << printed(corners);
    ++cut_up;
  }
  EXPECT_GT(cut_up, 200);
}

// What lies along the direction is not seen.
TEST(Polygons, WarpsDoNotMatter) {
  Random random(9, 0);
  for (const Corners& corners : {kL, star_shaped(random, 60), spiral(6), bridges_from_a_corner(5), touching_teeth(6)}) {
    for (int round = 0; round < 20; ++round) {
      const Plane plane = random_plane(random);
      Vec3 direction = cross(plane.u, plane.v);
      if (doubled_area(corners) < 0) direction = -1.0 * direction;
      std::vector<Vec3> flat, warped;
      for (const Flat& corner : corners) {
        flat.push_back(plane.at(corner));
        const auto height = static_cast<double>((corner[0] * 7919 + corner[1] * 104729) % 1009);
        warped.push_back(flat.back() + height * direction);
      }
      direction = 0x1p-20 * direction;
      const auto expected = cut_polygon(flat, direction);
      ASSERT_TRUE(expected.has_value());
      EXPECT_EQ(cut_polygon(warped, direction), expected);
    }
  }
}

TEST(Polygons, TheFirstCornerDoesNotMatter) {
  Random random(4, 0);
  for (const Corners& corners : {kL, star_shaped(random, 50), comb(5), spiral(2), spiral(4)}) {
    TriangleMesh first = fan(corners, {});
    cut(first);
    for (std::size_t shift = 1; shift < corners.size(); ++shift) {
      TriangleMesh mesh = fan(rotated(corners, shift), {});
      cut(mesh);
      EXPECT_EQ(sorted_triangles(mesh), sorted_triangles(first)) << shift;
    }
  }
}

// Scaled by powers of two, an exact decision stays what it is, where products under- and overflow too.
TEST(Polygons, AnyMagnitude) {
  for (const double scale : {0x1p-1070, 0x1p-600, 0x1p-300, 0x1p300, 0x1p1000}) {
    for (std::size_t shift = 0; shift < kL.size(); ++shift) {
      const Plane plane{{}, {scale, 0, scale}, {0, scale, 2 * scale}};
      const Corners corners = rotated(kL, shift);
      TriangleMesh mesh = fan(corners, plane), unscaled = fan(corners, {{}, {1, 0, 1}, {0, 1, 2}});
      EXPECT_EQ(cut(mesh), 0U) << scale;
      cut(unscaled);
      EXPECT_EQ(mesh.triangles, unscaled.triangles);
      EXPECT_EQ(defect(mesh, corners, 1), "");
    }
  }
}

TEST(Polygons, ExactTurnsOfAnyMagnitude) {
  const Vec3 direction{0.25, 1, -0.5};
  const Vec3 b{1, 2, 3}, c{2, 1, 1};
  ASSERT_EQ(dot(cross(b, c), direction), 6.25);
  for (int power = -1070; power <= 1020; power += 10) {
    const double scale = std::ldexp(1.0, power);
    EXPECT_EQ(exact_turn(direction, {}, scale * b, scale * c), 1) << power;
    EXPECT_EQ(exact_turn(direction, {}, scale * c, scale * b), -1) << power;
    EXPECT_EQ(exact_turn(direction, {}, scale * b, -2.0 * scale * b), 0) << power;
    EXPECT_EQ(exact_turn(direction, -1.0 * scale * c, scale * c, scale * b), -1) << power;
  }
}

// A first corner that steps by last bits past the line through the next two, where differences round, to either side
// (Kettner et al., "Classroom examples of robustness problems in geometric computations", 2008).
TEST(Polygons, DecidedExactly) {
  constexpr double kBit = 0x1p-53;
  const auto integers = [](const Vec3& p) {
    return Flat{std::llround(p.x / kBit), std::llround(p.y / kBit)};
  };  // exact
  int reflex = 0;
  for (int i = 0; i < 64; ++i) {
    for (int j = 0; j < 64; ++j) {
      const std::vector<Vec3> corners{{0.50000000000002531 + i * kBit, 0.5000000000000171 + j * kBit, 0},
                                      {17.300000000000001, 17.300000000000001, 0},
                                      {24.00000000000005, 24.0000000000000517765, 0},
                                      {0, 30, 0}};
      TriangleMesh mesh = fan(corners);
      const TriangleMesh before = mesh;
      EXPECT_EQ(cut(mesh), 0U);
      const bool is_reflex = turn(integers(corners[0]), integers(corners[1]), integers(corners[2])) < 0;
      EXPECT_EQ(mesh.triangles != before.triangles, is_reflex) << i << " " << j;
      reflex += is_reflex;
    }
  }
  EXPECT_GT(reflex, 100);
  EXPECT_LT(reflex, 64 * 64 - 100);
}

// Along the area vector a square, along z two triangles over each other.
TEST(Polygons, AreSeenAlongTheirAreaVector) {
  TriangleMesh mesh = fan(std::vector<Vec3>{{0, 0, 0}, {0.125, 1, 0}, {0, 1, 1}, {0.125, 0, 1}});
  const TriangleMesh before = mesh;
  EXPECT_EQ(cut(mesh), 0U);
  EXPECT_EQ(mesh.triangles, before.triangles);
}

TEST(Polygons, OthersKeepTheirPlaceAndOrder) {
  TriangleMesh mesh;
  std::vector<PolygonFan> fans;
  for (int copy = 0; copy < 3; ++copy) {
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Flat& corner : rotated(kL, 1)) mesh.vertices.push_back(Plane{}.at(corner));
    mesh.triangles.push_back({base, base + 1, base + 2});
    fans.push_back({mesh.triangles.size(), 4});
    for (std::uint32_t i = 1; i < 5; ++i) mesh.triangles.push_back({base, base + i, base + i + 1});
  }
  const TriangleMesh before = mesh;
  EXPECT_EQ(cut_concave_polygons(mesh, fans), 0U);
  ASSERT_EQ(mesh.triangles.size(), before.triangles.size());
  for (std::size_t i = 0; i < 15; i += 5) EXPECT_EQ(mesh.triangles[i], before.triangles[i]);
  for (const PolygonFan& f : fans) {
    const auto first = mesh.triangles.begin() + static_cast<std::ptrdiff_t>(f.first);
    const auto low = (*std::min_element(first, first + 4))[0];
    EXPECT_EQ(low / 6, f.first / 5) << "triangles of another polygon";
  }
}

}  // namespace
}  // namespace raycone
