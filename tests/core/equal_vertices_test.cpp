#include "core/mesh/equal_vertices.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "tests/support/shapes.h"

namespace raycone {
namespace {

using Key = VertexHash::Key;

// All vertices have the hash 0.
constexpr Key kCollidingKey{};

Key key_of(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Key key;
  for (auto& word : key) word = static_cast<unsigned __int128>(random()) << 64 | random();
  return key;
}

std::vector<Vec3> vertices_with_repetitions(std::size_t count, std::uint64_t seed) {
  test::Random random(seed);
  std::vector<Vec3> vertices(count);
  const auto coordinate = [&] { return std::uniform_int_distribution<int>(-6, 6)(random) / 7.0; };
  for (Vec3& p : vertices) p = {coordinate(), coordinate(), coordinate()};
  return vertices;
}

std::vector<std::uint32_t> first_by_definition(const std::vector<Vec3>& vertices) {
  std::map<std::tuple<std::uint64_t, std::uint64_t, std::uint64_t>, std::uint32_t> seen;
  std::vector<std::uint32_t> first;
  for (const Vec3& p : vertices) {
    const std::tuple bits{std::bit_cast<std::uint64_t>(p.x), std::bit_cast<std::uint64_t>(p.y),
                          std::bit_cast<std::uint64_t>(p.z)};
    first.push_back(seen.try_emplace(bits, static_cast<std::uint32_t>(first.size())).first->second);
  }
  return first;
}

TEST(EqualVertices, AreThoseOfEqualBitsWhateverTheKey) {
  const std::vector<Vec3> vertices = vertices_with_repetitions(3000, 1);
  const std::vector<std::uint32_t> expected = first_by_definition(vertices);
  EXPECT_EQ(first_equal_vertices(vertices), expected);
  EXPECT_EQ(first_equal_vertices(vertices, VertexHash(kCollidingKey)), expected);
  EXPECT_EQ(first_equal_vertices(vertices, VertexHash(Key{0, ~static_cast<unsigned __int128>(0), 0, 0})), expected);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    EXPECT_EQ(first_equal_vertices(vertices, VertexHash(key_of(seed))), expected);
  }
}

TEST(EqualVertices, OfNoneThereAreNone) { EXPECT_TRUE(first_equal_vertices({}).empty()); }

// More than fill one bucket, one chunk of the distribution.
TEST(EqualVertices, AreFoundAmongMany) {
  const std::vector<Vec3> vertices = vertices_with_repetitions(200'000, 2);
  EXPECT_EQ(first_equal_vertices(vertices), first_by_definition(vertices));
}

// Pairs that share the bits of a slot, of those expected for any two vertices. What is chosen to differ in few bits, or
// by a common factor, must not share more.
double crowding(const std::vector<Vec3>& vertices, const std::function<std::uint64_t(const Vec3&)>& hash) {
  constexpr int kSlotsLog2 = 16;
  std::vector<double> slots(std::size_t{1} << kSlotsLog2, 0.0);
  for (const Vec3& p : vertices) ++slots[hash(p) & (slots.size() - 1)];
  double pairs = 0.0;
  for (const double count : slots) pairs += count * (count - 1.0);
  const auto n = static_cast<double>(vertices.size());
  return pairs * static_cast<double>(slots.size()) / (n * (n - 1.0));
}

struct Family {
  std::string name;
  std::function<Vec3(std::uint32_t)> vertex;
};

const std::vector<Family>& families() {
  static const std::vector<Family> all{
      {"integers along x",
       [](std::uint32_t i) {
         return Vec3{static_cast<double>(i), 0, 0};
       }},
      {"lattice",
       [](std::uint32_t i) {
         return Vec3{i % 40 * 1.0, i / 40 % 40 * 1.0, i / 1600 * 1.0};
       }},
      {"last bits",
       [](std::uint32_t i) {
         return Vec3{1.0 + i * 0x1p-52, 1.0, 1.0};
       }},
      {"exponents",
       [](std::uint32_t i) {
         return Vec3{std::ldexp(1.0, static_cast<int>(i % 2000) - 1000),
                     std::ldexp(i % 3 == 0 ? -1.0 : 1.0, static_cast<int>(i / 2000)), 1.0};
       }},
      // Of the issue: those of equal hashes for every seed that there was.
      {"opposite pairs",
       [](std::uint32_t i) {
         const double k = i / 2, sign = i % 2 == 0 ? 1.0 : -1.0;
         return Vec3{sign * (k + 2), sign * (262144 + k), 5.0};
       }},
  };
  return all;
}

// The mean over keys is at most 1. Single keys may crowd a family, as vertices in arithmetic progression have hashes in
// one: four times the mean occurs, hence a margin.
TEST(VertexHash, CrowdsNoFamilyOfVertices) {
  constexpr int kKeys = 100;
  for (const Family& family : families()) {
    std::vector<Vec3> vertices;
    for (std::uint32_t i = 0; i < 6000; ++i) vertices.push_back(family.vertex(i));
    double sum = 0.0;
    for (std::uint64_t seed = 0; seed < kKeys; ++seed) sum += crowding(vertices, VertexHash(key_of(seed)));
    EXPECT_LT(sum / kKeys, 1.5) << family.name;
    // What this measure must see: one slot for all.
    EXPECT_GT(crowding(vertices, VertexHash(kCollidingKey)), 1000.0);
  }
}

TEST(VertexHash, HasAnotherKeyEachTime) {
  const Vec3 p{1, 2, 3};
  EXPECT_NE(VertexHash()(p), VertexHash()(p));
}

// The upper ones, too, which products of 64 bits would lose.
TEST(VertexHash, SeesEachBit) {
  const VertexHash hash(key_of(3));
  const Vec3 p{1, 2, 3};
  for (int axis = 0; axis < 3; ++axis) {
    for (int bit = 0; bit < 64; ++bit) {
      Vec3 q = p;
      q[axis] = std::bit_cast<double>(std::bit_cast<std::uint64_t>(q[axis]) ^ std::uint64_t{1} << bit);
      EXPECT_NE(hash(q), hash(p)) << axis << ", " << bit;
    }
  }
}

}  // namespace
}  // namespace raycone
