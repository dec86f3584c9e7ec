#include "core/mesh/near_vertices.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "tests/support/shapes.h"

namespace raycone {
namespace {

constexpr double kLargestDouble = std::numeric_limits<double>::max();
constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kTiniest = std::numeric_limits<double>::denorm_min();

// The rule, word by word: each vertex against all representatives so far.
Representatives by_definition(const std::vector<Vec3>& vertices, double distance) {
  std::vector<std::uint32_t> order(vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t i, std::uint32_t j) { return lexicographic_order(vertices[i], vertices[j]) < 0; });
  Representatives result{{}, std::vector<std::uint32_t>(vertices.size())};
  for (const std::uint32_t i : order) {
    const auto found = std::find_if(result.vertices.begin(), result.vertices.end(),
                                    [&](const Vec3& r) { return is_near(r, vertices[i], distance); });
    result.of[i] = static_cast<std::uint32_t>(found - result.vertices.begin());
    if (found == result.vertices.end()) result.vertices.push_back(vertices[i]);
  }
  return result;
}

struct Family {
  std::string name;
  std::vector<double> distances;
  std::function<Vec3(test::Random&)> vertex;
};

double uniform(test::Random& random, double lower, double upper) {
  return lower + (upper - lower) * std::uniform_real_distribution<double>(0.0, 1.0)(random);
}

double integer(test::Random& random, int lower, int upper) {
  return std::uniform_int_distribution<int>(lower, upper)(random);
}

double any_magnitude(test::Random& random, int lower, int upper) {
  return std::ldexp(uniform(random, -1.0, 1.0), static_cast<int>(integer(random, lower, upper)));
}

template <class Coordinate>
std::function<Vec3(test::Random&)> of(const Coordinate& coordinate) {
  return [=](test::Random& random) {
    const double x = coordinate(random), y = coordinate(random), z = coordinate(random);
    return Vec3{x, y, z};
  };
}

std::vector<Family> families() {
  return {
      {"random", {1e-3, 0.03, 0.1, 0.5, 3.0}, of([](auto& r) { return uniform(r, 0, 1); })},
      {"about the origin", {1e-3, 0.1, 0.7, 100.0}, of([](auto& r) { return uniform(r, -1, 1); })},
      {"lattice", {0.5, 1.0, std::sqrt(2.0), std::sqrt(3.0), 2.0, 5.0}, of([](auto& r) { return integer(r, -4, 4); })},
      {"just above the distance", {1.0, 1.5, 2.0}, of([](auto& r) { return 1.0000001 * integer(r, 0, 9); })},
      {"tenths", {0.1, 0.2, 0.1 + 0.2}, of([](auto& r) { return 0.1 * integer(r, 0, 12); })},
      {"clusters", {1e-9, 1e-6, 1e-3}, of([](auto& r) { return integer(r, 0, 2) + uniform(r, 0, 1e-6); })},
      {"far from the origin", {1e-10, 0.25, 1.0, 8.0}, of([](auto& r) { return 0x1p52 + integer(r, 0, 40); })},
      {"huge", {1e-10, 1e284, 1e299, 1e300, kLargestDouble}, of([](auto& r) { return 1.7e308 * uniform(r, -1, 1); })},
      {"all magnitudes", {1e-300, 1e-10, 1.0, 1e200}, of([](auto& r) { return any_magnitude(r, -1074, 1023); })},
      {"small magnitudes", {1e-15, 1e-3, 1.0}, of([](auto& r) { return any_magnitude(r, -60, 3); })},
      {"denormal", {kTiniest, 3 * kTiniest, 1e-300}, of([](auto& r) { return kTiniest * integer(r, -9, 9); })},
      {"last bits", {0x1p-52, 0x1p-51, 1e-15}, of([](auto& r) { return 1.0 + 0x1p-52 * integer(r, -9, 9); })},
      {"partly not finite", {0.5, 2.0, kLargestDouble}, of([](auto& r) {
         const double x = integer(r, 0, 12);
         return x == 12 ? kNaN : x == 11 ? kInfinite : x == 10 ? -kInfinite : x;
       })},
  };
}

TEST(NearVertices, AreThoseOfTheDefinitionInAllFamilies) {
  for (const Family& family : families()) {
    bool joined = false, separate = false;
    for (const double distance : family.distances) {
      for (std::uint64_t seed = 0; seed < 5; ++seed) {
        test::Random random(seed);
        std::vector<Vec3> vertices(300);
        for (Vec3& p : vertices) p = family.vertex(random);
        const Representatives expected = by_definition(vertices, distance);
        const Representatives found = representatives_within(vertices, distance);
        ASSERT_EQ(found.of, expected.of) << family.name << ", " << distance << ", seed " << seed;
        ASSERT_EQ(found.vertices.size(), expected.vertices.size());
        joined = joined || expected.vertices.size() < vertices.size();
        separate = separate || expected.vertices.size() > 1;
      }
    }
    EXPECT_TRUE(joined) << family.name;
    EXPECT_TRUE(separate) << family.name;
  }
}

TEST(NearVertices, DoNotDependOnTheirOrder) {
  for (const Family& family : families()) {
    test::Random random(9);
    std::vector<Vec3> vertices(200);
    for (Vec3& p : vertices) p = family.vertex(random);
    const Representatives expected = representatives_within(vertices, family.distances.back());
    std::vector<std::uint32_t> order(vertices.size());
    std::iota(order.begin(), order.end(), 0U);
    std::shuffle(order.begin(), order.end(), random);
    std::vector<Vec3> shuffled;
    for (const std::uint32_t i : order) shuffled.push_back(vertices[i]);
    const Representatives found = representatives_within(shuffled, family.distances.back());
    ASSERT_EQ(found.vertices.size(), expected.vertices.size()) << family.name;
    for (std::size_t i = 0; i < order.size(); ++i) {
      ASSERT_TRUE(lexicographic_order(found.vertices[found.of[i]], expected.vertices[expected.of[order[i]]]) == 0);
    }
  }
}

TEST(NearVertices, AreNearByTheirDistanceUpToItsRounding) {
  test::Random random(4);
  int near = 0, far = 0;
  for (int n = 0; n < 200'000; ++n) {
    const Vec3 a = of([](auto& r) { return uniform(r, 0, 1); })(random);
    const Vec3 b = of([](auto& r) { return uniform(r, 0, 1); })(random);
    const auto dx = static_cast<__float128>(a.x) - b.x, dy = static_cast<__float128>(a.y) - b.y,
               dz = static_cast<__float128>(a.z) - b.z;
    const __float128 square = dx * dx + dy * dy + dz * dz;
    const double distance = std::sqrt(static_cast<double>(square)) * (1.0 + integer(random, -1, 1) * 1e-15);
    // The differences round once (u = 2^-53), hypot() less than three times: outside of 4 u nothing is a matter of
    // taste.
    constexpr double u = 0x1p-53;
    const __float128 least = static_cast<__float128>(distance) * (1 - 4 * u),
                     most = static_cast<__float128>(distance) * (1 + 4 * u);
    const bool is_within = square <= least * least, is_outside = square > most * most;
    EXPECT_FALSE(is_within && !is_near(a, b, distance));
    EXPECT_FALSE(is_outside && is_near(a, b, distance));
    near += is_within;
    far += is_outside;
  }
  EXPECT_GT(near, 50'000);
  EXPECT_GT(far, 50'000);
}

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// A hundred thousand vertices take a second at most; pair by pair they took minutes.
template <class VertexAt>
void expect_soon(const char* name, double distance, std::size_t representatives, const VertexAt& vertex_at) {
  std::vector<Vec3> vertices;
  for (int i = 0; i < 100'000; ++i) vertices.push_back(vertex_at(i));
  const double before = cpu_seconds();
  EXPECT_EQ(representatives_within(vertices, distance).vertices.size(), representatives) << name;
  EXPECT_LT(cpu_seconds() - before, 20.0) << name;  // sanitizers and busy machines included
}

TEST(NearVertices, TakeNoLongerWhereTheyAreChosenToCrowd) {
  constexpr std::size_t kAll = 100'000;
  expect_soon("beyond the range of cells", 1e-10, kAll, [](int i) {
    return Vec3{1e300, 1e300, 1e300 * (1 + i * 1e-9)};
  });
  expect_soon("quotients that overflow", 1e-10, kAll, [](int i) { return Vec3{1e299 + 1e290 * i, 1e300, 1e300}; });
  expect_soon("one vertex far away", 1e-10, kAll, [](int i) {
    return i == 0 ? Vec3{1e300, 1e300, 1e300} : Vec3{1e-3 * i, 0, 0};
  });
  expect_soon("within one distance", 1.0, 1, [](int i) { return Vec3{1e-6 * i, 0.5e-6 * i, 0}; });
  expect_soon("just too far apart", 1.0, kAll, [](int i) {
    return Vec3{1.0000001 * (i % 50), 1.0000001 * (i / 50 % 50), 1.0000001 * (i / 2500)};
  });
  expect_soon("in one plane", 1.0, kAll, [](int i) { return Vec3{0, 1.0000001 * (i % 300), 1.0000001 * (i / 300)}; });
  expect_soon("not numbers", 1.0, kAll, [](int i) { return Vec3{0, kNaN, 1e-9 * i}; });
  expect_soon("denormal distance", kTiniest, kAll, [](int i) { return Vec3{1e-3 * i, 0, 0}; });
}

}  // namespace
}  // namespace raycone
