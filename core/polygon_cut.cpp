// The winding number of a polygon is constant in each face of a triangulation that has the polygon's edges among its
// own: the faces where it is 1 are the polygon, and where it is neither 0 nor 1 the polygon is not simple.
#include "core/polygon_cut.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Gmpzf.h>
#include <CGAL/Spatial_sort_traits_adapter_2.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>

#include <algorithm>
#include <cassert>
#include <climits>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>

#include "core/floating_point.h"

namespace raycone {
namespace {

// --- Numbers --------------------------------------------------------------------------------------------------------

using Exact = CGAL::Gmpzf;  // sums and products of doubles
using ExactVec3 = std::array<Exact, 3>;

ExactVec3 difference(const Vec3& a, const Vec3& b) {
  return {Exact(a.x) - Exact(b.x), Exact(a.y) - Exact(b.y), Exact(a.z) - Exact(b.z)};
}

ExactVec3 cross(const ExactVec3& a, const ExactVec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// --- Projection -----------------------------------------------------------------------------------------------------

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Point = Kernel::Point_2;

// Maps space to a plane such that the direction becomes a point and turns keep their signs.
class Projection {
 public:
  explicit Projection(const Vec3& direction) {
    for (int axis = 1; axis < 3; ++axis)
      if (std::abs(direction[axis]) > std::abs(direction[along_])) along_ = axis;
    const bool backwards = direction[along_] < 0.0;
    across_ = {(along_ + (backwards ? 2 : 1)) % 3, (along_ + (backwards ? 1 : 2)) % 3};
    direction_ = direction;
  }

  [[nodiscard]] Point operator()(const Vec3& p) const { return {coordinate(p, across_[0]), coordinate(p, across_[1])}; }

 private:
  // Of coordinates that change along the direction, the multiple of another that changes alike is taken away.
  [[nodiscard]] Kernel::FT coordinate(const Vec3& p, int axis) const {
    if (direction_[axis] == 0.0) return {p[axis]};
    const double sign = direction_[along_] < 0.0 ? -1.0 : 1.0;
    Kernel::FT result =
        Kernel::FT(sign * direction_[along_]) * p[axis] - Kernel::FT(sign * direction_[axis]) * p[along_];
    CGAL::exact(result);  // lets go of its terms
    return result;
  }

  Vec3 direction_;
  int along_ = 0;  // axis of its largest component
  std::array<int, 2> across_{};
};

// --- Triangulation --------------------------------------------------------------------------------------------------

constexpr std::uint32_t kNoCorner = 0xFFFFFFFF;

struct Corner {
  std::uint32_t index = kNoCorner;  // of one of those that are at the vertex
  std::uint32_t uses = 0;           // how many are
};

struct Face {
  int winding = 0;  // number of the polygon
  bool visited = false;
};

using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<Corner, Kernel>;
using FaceBase =
    CGAL::Constrained_triangulation_face_base_2<Kernel, CGAL::Triangulation_face_base_with_info_2<Face, Kernel>>;
// Throws at edges that cross, lets those pass that share a line.
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>,
                                               CGAL::No_constraint_intersection_requiring_constructions_tag>;
using Vertex = Triangulation::Vertex_handle;

// An edge of the triangulation that the polygon runs along.
struct Step {
  std::uint32_t low, high;  // corners at its ends
  int direction;            // +1 from low to high

  [[nodiscard]] bool is_along(const Step& other) const { return low == other.low && high == other.high; }
};

Step step(const Vertex& from, const Vertex& to) {
  const std::uint32_t a = from->info().index, b = to->info().index;
  return {std::min(a, b), std::max(a, b), a < b ? 1 : -1};
}

bool precedes(const Step& a, const Step& b) { return a.low != b.low ? a.low < b.low : a.high < b.high; }

// The numbers below `count` in an order that looks random: edges inserted in the polygon's order may each cross nearly
// all of the triangulation, in a random one few of it (Shewchuk and Brown, "Fast segment insertion and incremental
// construction of constrained Delaunay triangulations", 2015).
std::vector<std::size_t> shuffled(std::size_t count) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::mt19937_64 random;  // NOLINT(cert-msc51-cpp): the same order every time
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[random() % i]);
  return order;
}

class PolygonCut {
 public:
  PolygonCut(std::span<const Vec3> corners, const Vec3& direction) : corners_(corners), projection_(direction) {}

  // False where the polygon is not simple.
  bool cut() {
    if (!insert_corners()) return false;
    try {
      for (const std::size_t i : shuffled(corners_.size())) insert_edge(at_[i], at_[(i + 1) % corners_.size()]);
    } catch (const Triangulation::Intersection_of_constraints_exception&) {
      return false;
    }
    // Only now do edges stay where they are.
    for (std::size_t i = 0; i < corners_.size(); ++i) follow_edge(at_[i], at_[(i + 1) % corners_.size()]);
    sum_steps();
    if (!find_windings()) return false;
    for (const auto face : triangulation_.finite_face_handles())
      if (face->info().winding == 1) add(face->vertex(0), face->vertex(1), face->vertex(2));
    return true;
  }

  [[nodiscard]] std::vector<std::array<std::uint32_t, 3>> take() {
    std::sort(triangles_.begin(), triangles_.end());
    return std::move(triangles_);
  }

 private:
  // False where corners at different places project to one, or all of them to a line.
  bool insert_corners() {
    std::vector<Point> points;
    points.reserve(corners_.size());
    for (const Vec3& corner : corners_) points.push_back(projection_(corner));
    at_.resize(points.size());
    Triangulation::Face_handle near;
    for (const std::size_t i : one_of_each_place(points)) {
      const Vertex vertex = triangulation_.insert(points[i], near);
      if (vertex->info().index != kNoCorner) return false;
      vertex->info().index = static_cast<std::uint32_t>(i);
      at_[i] = vertex;
      near = vertex->face();
    }
    for (std::size_t i = 0; i < at_.size(); ++i) {
      at_[i] = at_[same_place_[i]];
      ++at_[i]->info().uses;
    }
    return triangulation_.dimension() == 2;
  }

  // The first of the corners at each place, each close to the one before; sets same_place_. A triangulation would take
  // long to find again a corner that many edges meet at.
  std::vector<std::size_t> one_of_each_place(const std::vector<Point>& points) {
    std::vector<std::size_t> order(corners_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto place = [this](std::size_t i) { return std::array{corners_[i].x, corners_[i].y, corners_[i].z}; };
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return place(a) < place(b); });
    same_place_.resize(order.size());
    std::size_t kept = 0;
    for (const std::size_t i : order) {
      if (kept == 0 || place(order[kept - 1]) != place(i)) order[kept++] = i;
      same_place_[i] = order[kept - 1];
    }
    order.resize(kept);
    const auto map = CGAL::make_property_map(points);
    CGAL::spatial_sort(order.begin(), order.end(), CGAL::Spatial_sort_traits_adapter_2<Kernel, decltype(map)>(map));
    return order;
  }

  // Looking for an edge takes as long as a vertex has edges: where corners meet at one, it starts at the other.
  static bool starts_at_second(const Vertex& a, const Vertex& b) { return a->info().uses > b->info().uses; }

  void insert_edge(Vertex a, Vertex b) {
    if (starts_at_second(a, b)) std::swap(a, b);
    if (a != b) triangulation_.insert_constraint(a, b);
  }

  // Notes the steps from a to b, and joins corners between them to the edge.
  void follow_edge(const Vertex& a, const Vertex& b) {
    if (a == b) return;
    const bool reversed = starts_at_second(a, b);
    std::vector<Vertex> line{reversed ? b : a};
    const Vertex last = reversed ? a : b;
    while (line.back() != last) line.push_back(next_on_line(line.back(), last));
    if (reversed) std::reverse(line.begin(), line.end());
    for (std::size_t i = 0; i + 1 < line.size(); ++i) steps_.push_back(step(line[i], line[i + 1]));
    for (std::size_t i = line.size() - 1; i >= 2; --i) add(a, line[i], line[i - 1]);
  }

  // The end of the first edge from `from` towards `to`. Precondition: they are joined by edges in a straight line.
  [[nodiscard]] Vertex next_on_line(const Vertex& from, const Vertex& to) const {
    Vertex next;
    Triangulation::Face_handle face;
    int index = 0;
    [[maybe_unused]] const bool found = triangulation_.includes_edge(from, to, next, face, index);
    assert(found);
    return next;
  }

  // Of steps along the same edge keeps one, with the sum of their directions.
  void sum_steps() {
    std::sort(steps_.begin(), steps_.end(), precedes);
    std::size_t kept = 0;
    for (const Step& each : steps_) {
      if (kept > 0 && steps_[kept - 1].is_along(each))
        steps_[kept - 1].direction += each.direction;
      else
        steps_[kept++] = each;
    }
    steps_.resize(kept);
  }

  // How often the polygon runs from a to b, less the other way.
  [[nodiscard]] int runs(const Vertex& a, const Vertex& b) const {
    const Step wanted = step(a, b);
    const auto found = std::lower_bound(steps_.begin(), steps_.end(), wanted, precedes);
    return found != steps_.end() && found->is_along(wanted) ? found->direction * wanted.direction : 0;
  }

  // False where one is neither 0 nor 1.
  bool find_windings() {
    std::vector<Triangulation::Face_handle> reached{triangulation_.infinite_face()};
    reached.back()->info().visited = true;
    while (!reached.empty()) {
      const auto face = reached.back();
      reached.pop_back();
      for (int i = 0; i < 3; ++i) {
        const auto other = face->neighbor(i);
        if (other->info().visited) continue;
        const bool crosses = face->is_constrained(i);
        // The face lies to the left of its edges.
        const int left = crosses ? runs(face->vertex(Triangulation::ccw(i)), face->vertex(Triangulation::cw(i))) : 0;
        other->info() = {face->info().winding - left, true};
        if (other->info().winding < 0 || other->info().winding > 1) return false;
        reached.push_back(other);
      }
    }
    return true;
  }

  void add(const Vertex& a, const Vertex& b, const Vertex& c) {
    std::array<std::uint32_t, 3> triangle{a->info().index, b->info().index, c->info().index};
    std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
    triangles_.push_back(triangle);
  }

  std::span<const Vec3> corners_;
  Projection projection_;
  Triangulation triangulation_;
  std::vector<Vertex> at_;               // of each corner
  std::vector<std::size_t> same_place_;  // of each corner the first one at its place
  std::vector<Step> steps_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

}  // namespace

Vec3 exact_area_direction(std::span<const Vec3> corners) {
  assert(DefaultFloatingPoint::holds());
  ExactVec3 area;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const ExactVec3 part = cross(difference(corners[i], corners[0]), difference(corners[i + 1], corners[0]));
    for (std::size_t axis = 0; axis < 3; ++axis) area[axis] += part[axis];
  }
  std::array<std::pair<double, long>, 3> parts;  // mantissa and exponent
  long largest = LONG_MIN;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    parts[axis] = area[axis].to_double_exp();
    if (parts[axis].first != 0.0) largest = std::max(largest, parts[axis].second + std::ilogb(parts[axis].first));
  }
  Vec3 direction;
  for (int axis = 0; axis < 3; ++axis) {
    const auto& [mantissa, exponent] = parts[static_cast<std::size_t>(axis)];
    if (mantissa != 0.0) direction[axis] = std::ldexp(mantissa, static_cast<int>(std::max(exponent - largest, -4000L)));
  }
  return direction;
}

int exact_turn(const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& c) {
  assert(DefaultFloatingPoint::holds());
  const ExactVec3 normal = cross(difference(b, a), difference(c, a));
  const Exact volume = normal[0] * Exact(direction.x) + normal[1] * Exact(direction.y) + normal[2] * Exact(direction.z);
  return static_cast<int>(CGAL::sign(volume));
}

std::optional<std::vector<std::array<std::uint32_t, 3>>> cut_polygon(std::span<const Vec3> corners,
                                                                     const Vec3& direction) {
  assert(DefaultFloatingPoint::holds());
  PolygonCut polygon(corners, direction);
  return polygon.cut() ? std::optional(polygon.take()) : std::nullopt;
}

}  // namespace raycone
