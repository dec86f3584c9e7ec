// Which vertices are bitwise equal.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/data/vec3.h"

namespace raycone {

// A hash with a secret key. Any two different vertices share a value with a probability of 2^-64 over the keys,
// whatever the vertices are: MULTILINEAR of Lemire and Kaser, "Strongly universal string hashing is fast", The Computer
// Journal 57(11), 2014. Who does not know the key cannot choose vertices that crowd a table.
class VertexHash {
 public:
  using Key = std::array<unsigned __int128, 4>;

  // A key of its own, from the system.
  VertexHash();
  explicit VertexHash(const Key& key) : key_(key) {}

  std::uint64_t operator()(const Vec3& p) const;

 private:
  Key key_;
};

// For each vertex the index of the first one with the same bits: equal are coordinates, never hashes alone. The key
// decides about the time only, which grows in proportion to the number of vertices for all but a few keys. At most 2^32
// - 1 vertices. Uses the threads that ThreadLimit allows.
[[nodiscard]] std::vector<std::uint32_t> first_equal_vertices(const std::vector<Vec3>& vertices,
                                                              const VertexHash& hash = VertexHash());

}  // namespace raycone
