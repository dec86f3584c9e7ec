#include "core/arrangement/fan_cone.h"

#include <algorithm>
#include <numeric>

namespace raycone {
namespace {

double determinant(const Vec3& a, const Vec3& b, const Vec3& c) { return dot(a, cross(b, c)); }

}  // namespace

FanCone::FanCone(const TriangleMesh& mesh, std::uint32_t vertex, const std::vector<std::uint32_t>& faces)
    : faces_(faces) {
  for (const std::uint32_t face : faces) {
    const Triangle& t = mesh.triangles[face];
    const auto at = static_cast<std::size_t>(std::ranges::find(t, vertex) - t.begin());
    const auto way_to = [&](std::size_t corner) {
      const Vec3 step = mesh.vertices[t[corner % 3]] - mesh.vertices[vertex];
      return (1.0 / safe_norm(step)) * step;
    };
    sectors_.push_back({way_to(at + 1), way_to(at + 2)});
  }
}

Vec3 FanCone::way_along() const { return 0.41 * sectors_.front()[0] + 0.59 * sectors_.front()[1]; }

std::optional<Vec3> FanCone::way_from(const std::vector<Vec3>& others) const {
  for (const double side : {-1.0, 1.0}) {
    const std::optional<Vec3> way = way_with_all_on_side(side);
    if (way && std::ranges::none_of(others, [&](const Vec3& other) { return are_on_one_side(*way, other); })) {
      return way;
    }
  }
  return std::nullopt;
}

// Its vertex stays on its side of the other one's faces, and that one's vertex on its side of its own. So do points of
// edges that both have.
bool FanCone::leaves(const FanCone& other, const Vec3& way) const {
  constexpr double kNextToEdge = 1e-6;
  const auto goes_away = [&](const Vec3& from, const Vec3& step) {
    return other.are_on_one_side(from + step, way_along()) && are_on_one_side(from - step, other.way_along());
  };
  return goes_away({}, way) && std::ranges::all_of(sectors_, [&](const Sector& sector) {
           return !other.has_edge(sector[0]) || goes_away(sector[0], kNextToEdge * way);
         });
}

bool FanCone::goes_against_perturbation(const Vec3& way) const {
  return std::ranges::all_of(sectors_, [&](const Sector& sector) {
    const Vec3 normal = cross(sector[0], sector[1]);
    const double perturbed = normal.x != 0.0 ? normal.x : normal.y != 0.0 ? normal.y : normal.z;
    return dot(normal, way) * perturbed <= 0.0;
  });
}

double FanCone::lead(const FanCone& other, const Vec3& way) const {
  double sum = 0.0;
  for (const Sector& sector : sectors_) {
    for (const auto& [edge, side] : {sector, Sector{sector[1], sector[0]}}) {
      if (!other.has_edge(edge)) continue;
      const Vec3 across = side - dot(side, edge) * edge;
      sum += dot(across, way) / safe_norm(across);
    }
  }
  return sum;
}

bool FanCone::has_edge(const Vec3& direction) const {
  return std::ranges::any_of(sectors_, [&](const Sector& s) { return s[0] == direction; });
}

std::optional<double> FanCone::side_of_lid() const {
  for (const double side : {-1.0, 1.0}) {
    if (lid_of(ring(), side)) return side;
  }
  return std::nullopt;
}

// The edges that leave the vertex, one after the other.
std::vector<Vec3> FanCone::ring() const {
  std::vector<Vec3> ring{sectors_.front()[0]};
  for (const Sector* sector = &sectors_.front(); ring.size() < sectors_.size();) {
    const Vec3& next = ring.emplace_back((*sector)[1]);
    const auto following = std::ranges::find(sectors_, next, [](const Sector& s) { return s[0]; });
    if (following == sectors_.end()) break;
    sector = &*following;
  }
  return ring;
}

// The direction that is farthest from being along a face, of those with all faces behind it (side 1) or in front
// (-1). It is as far from two or three of them, or across from one.
std::optional<Vec3> FanCone::way_with_all_on_side(double side) const {
  constexpr double kClearly = 0x1p-12;
  constexpr std::size_t kMostFaces = 64;
  std::vector<Vec3> normals;
  for (const auto& [first, second] : sectors_) {
    const Vec3 area = cross(first, second);
    const double size = safe_norm(area);
    if (!(size > 0.0) || sectors_.size() > kMostFaces) return std::nullopt;
    normals.push_back((side / size) * area);
  }
  Vec3 best;
  double least_of_best = kClearly;
  const auto look_at = [&](const Vec3& way) {
    const double length = safe_norm(way);
    if (!(length > 0.0)) return;
    double least = 1.0;
    for (const Vec3& normal : normals) least = std::min(least, dot(normal, way) / length);
    if (least > least_of_best) {
      best = (1.0 / length) * way;
      least_of_best = least;
    }
  };
  for (std::size_t i = 0; i < normals.size(); ++i) {
    look_at(normals[i]);
    for (std::size_t j = i + 1; j < normals.size(); ++j) {
      look_at(normals[i] + normals[j]);
      for (std::size_t k = j + 1; k < normals.size(); ++k) {
        const Vec3 way = cross(normals[j] - normals[i], normals[k] - normals[i]);
        look_at(dot(way, normals[i]) < 0.0 ? -1.0 * way : way);
      }
    }
  }
  if (!(least_of_best > kClearly)) return std::nullopt;
  return best;
}

// Whether the way that turns straight from one direction to the other crosses an even number of faces.
bool FanCone::are_on_one_side(const Vec3& from, const Vec3& to) const {
  const auto crosses = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {  // arcs a - b, c - d
    const Vec3 first = cross(a, b), second = cross(c, d);
    const Vec3 meeting = cross(first, second);
    const auto is_within = [&](const Vec3& normal, const Vec3& begin, const Vec3& end, double sign) {
      return sign * dot(cross(normal, begin), meeting) > 0.0 && sign * dot(cross(normal, end), meeting) < 0.0;
    };
    return (is_within(first, a, b, 1.0) && is_within(second, c, d, 1.0)) ||
           (is_within(first, a, b, -1.0) && is_within(second, c, d, -1.0));
  };
  return std::ranges::count_if(sectors_, [&](const Sector& s) { return crosses(from, to, s[0], s[1]); }) % 2 == 0;
}

// The ear that is cut off is always that with the largest determinant, for it is best shaped.
std::optional<std::vector<std::array<std::size_t, 3>>> lid_of(const std::vector<Vec3>& polygon, double side) {
  constexpr std::size_t kMostCorners = 256;  // its cube is looked at
  if (polygon.size() < 3 || polygon.size() > kMostCorners) return std::nullopt;
  std::vector<std::size_t> left(polygon.size());
  std::iota(left.begin(), left.end(), 0);
  const auto turn = [&](std::size_t a, std::size_t b, std::size_t c) {
    return side * determinant(polygon[a], polygon[b], polygon[c]);
  };
  std::vector<std::array<std::size_t, 3>> lid;
  while (left.size() >= 3) {
    double largest = 0.0;
    std::size_t best = 0;
    for (std::size_t n = 0; n < left.size(); ++n) {
      const std::size_t a = left[(n + left.size() - 1) % left.size()], b = left[n], c = left[(n + 1) % left.size()];
      const auto is_within = [&](std::size_t v) {
        return v != a && v != b && v != c && turn(a, b, v) >= 0.0 && turn(b, c, v) >= 0.0 && turn(c, a, v) >= 0.0;
      };
      if (turn(a, b, c) > largest && std::ranges::none_of(left, is_within)) largest = turn(a, b, c), best = n;
    }
    if (!(largest > 0.0)) return std::nullopt;
    lid.push_back({left[(best + left.size() - 1) % left.size()], left[best], left[(best + 1) % left.size()]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
  }
  return lid;
}

}  // namespace raycone
