#include "core/intersections/vertex_graph.h"

#include <cmath>

#include "core/exact/sure_sign.h"

namespace raycone {
namespace {

// Each factor is a difference that rounds once. Of three factors and two sums, 7 roundings are a bound but for
// second-order terms; of two factors and a sum, 4 are.
constexpr double kRoundings = 8 * 0x1p-53;
constexpr double kUnderflow = 0x1p-900;

Vec3 normal_of(const std::vector<Vec3>& vertices, std::uint32_t vertex, std::span<const FanStep> steps) {
  const Vec3& v = vertices[vertex];
  Vec3 normal;
  for (const auto& [next, last] : steps) normal = normal + cross(vertices[next] - v, vertices[last] - v);
  return normal;
}

// Whether the turn from a to b is surely positive, seen against a direction.
bool turns_left(const Vec3& direction, const Vec3& a, const Vec3& b) {
  constexpr Vec3 kTiny{0x1p-1000, 0x1p-1000, 0x1p-1000};  // more than what underflows in the cross product, times 2^50
  return dot(direction, cross(a, b)) > kRoundings * dot(absolute(direction), cross_terms(a, b) + kTiny) + kUnderflow;
}

// On which side of a plane along `direction` a vector is: 1, -1, or 0 where that is not sure. Two of the direction's
// coordinates, turned by a right angle, are exactly perpendicular to it.
int side_of(const Vec3& direction, int axis, const Vec3& v) {
  const int first = (axis + 1) % 3, second = (axis + 2) % 3;
  const double left = direction[second] * v[first], right = direction[first] * v[second];
  return sure_sign(left - right, kRoundings * (std::abs(left) + std::abs(right)) + kUnderflow);
}

// The axis that is farthest from a direction: the plane along both is sure to be one.
int axis_across(const Vec3& direction) {
  const Vec3 size = absolute(direction);
  return size.x <= size.y && size.x <= size.z ? 0 : size.y <= size.z ? 1 : 2;
}

}  // namespace

// Where all turns are to the left, faces go around as often as they pass the half of a plane that ends at the vertex.
// Seen along the direction each is then in an angle of its own.
bool is_surely_graph(const std::vector<Vec3>& vertices, std::uint32_t vertex, std::span<const FanStep> steps) {
  const Vec3& v = vertices[vertex];
  const Vec3 direction = normal_of(vertices, vertex, steps);
  const int axis = axis_across(direction);
  int rounds = 0;
  for (const auto& [next, last] : steps) {
    const Vec3 a = vertices[next] - v, b = vertices[last] - v;
    if (!turns_left(direction, a, b)) return false;
    const int from = side_of(direction, axis, a), to = side_of(direction, axis, b);
    if (from == 0 || to == 0) return false;
    rounds += from < to ? 1 : 0;
  }
  return rounds == 1;
}

}  // namespace raycone
