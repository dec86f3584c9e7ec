#include "core/far/shared_edges.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "core/data/vec3.h"

namespace raycone {
namespace {

// The number of each corner among all different ones.
std::vector<std::uint32_t> numbered(std::span<const SolidTriangle> triangles, std::vector<Vec3>& vertices) {
  std::vector<std::pair<Vec3, std::uint32_t>> corners;
  corners.reserve(3 * triangles.size());
  for (const SolidTriangle& t : triangles) {
    for (const Vec3* corner : {&t.a, &t.b, &t.c})
      corners.emplace_back(*corner, static_cast<std::uint32_t>(corners.size()));
  }
  std::ranges::sort(corners, [](const auto& a, const auto& b) {
    const auto order = lexicographic_order(a.first, b.first);
    return order != 0 ? order < 0 : a.second < b.second;
  });
  std::vector<std::uint32_t> numbers(corners.size());
  for (const auto& [vertex, corner] : corners) {
    if (vertices.empty() || vertices.back() != vertex) vertices.push_back(vertex);
    numbers[corner] = static_cast<std::uint32_t>(vertices.size() - 1);
  }
  return numbers;
}

}  // namespace

SharedEdges::SharedEdges(std::span<const SolidTriangle> triangles) {
  if (triangles.size() >= std::size_t{1} << 30) throw std::length_error("raycone: 2^30 or more triangles share edges");
  const std::vector<std::uint32_t> corners = numbered(triangles, vertices_);
  struct Place {
    std::uint32_t low, high, side;
  };
  std::vector<Place> places;
  sides_.resize(corners.size(), {kNone, false});
  places.reserve(corners.size());
  for (std::uint32_t side = 0; side < corners.size(); ++side) {
    const std::uint32_t first = side / 3 * 3, from = corners[side], to = corners[first + (side - first + 1) % 3];
    const Vec3 &a = vertices_[from], &b = vertices_[to];
    if (a.y == b.y && a.z == b.z) continue;
    places.push_back({std::min(from, to), std::max(from, to), side});
    sides_[side].reversed = (to < from) != (triangles[side / 3].orientation < 0.0);
  }
  std::ranges::sort(places, {}, [](const Place& p) { return std::array{p.low, p.high, p.side}; });
  for (const auto& [low, high, side] : places) {
    if (edges_.empty() || edges_.back().from != low || edges_.back().to != high) edges_.push_back({low, high});
    sides_[side].edge = static_cast<std::uint32_t>(edges_.size() - 1);
  }
}

SharedEdges::Boundary::Boundary(const SharedEdges& edges)
    : all_(edges), multiplicities_(edges.edges_.size()), leaving_(edges.vertices_.size(), kNone) {}

std::optional<std::span<const ChainStep>> SharedEdges::Boundary::of(std::span<const std::uint32_t> triangles,
                                                                    std::size_t most) {
  if (set_multiplicities(triangles) > most) {
    for (const std::uint32_t edge : touched_) multiplicities_[edge] = 0;
    return std::nullopt;
  }
  set_chains();
  return steps_;
}

std::size_t SharedEdges::Boundary::set_multiplicities(std::span<const std::uint32_t> triangles) {
  touched_.clear();
  std::int64_t left = 0;
  for (const std::uint32_t n : triangles) {
    for (std::size_t i = 3 * std::size_t{n}; i < 3 * std::size_t{n} + 3; ++i) {
      const Side side = all_.sides_[i];
      if (side.edge == kNone) continue;
      std::int32_t& multiplicity = multiplicities_[side.edge];
      if (multiplicity == 0) touched_.push_back(side.edge);  // perhaps not for the first time
      left -= std::abs(multiplicity);
      multiplicity += side.reversed ? -1 : 1;
      left += std::abs(multiplicity);
    }
  }
  return static_cast<std::size_t>(left);
}

// All multiplicities are 0 afterwards.
void SharedEdges::Boundary::set_chains() {
  steps_.clear();
  std::erase_if(touched_, [&](std::uint32_t edge) { return multiplicities_[edge] == 0; });
  for (const std::uint32_t edge : touched_) {
    leaving_[multiplicities_[edge] > 0 ? all_.edges_[edge].from : all_.edges_[edge].to] = edge;
  }
  for (const std::uint32_t edge : touched_) {
    if (multiplicities_[edge] != 0) add_chain(edge);
  }
  for (const std::uint32_t edge : touched_) {
    leaving_[all_.edges_[edge].from] = leaving_[all_.edges_[edge].to] = kNone;
  }
}

// As long as there is an edge that has not been added.
void SharedEdges::Boundary::add_chain(std::uint32_t edge) {
  bool begins = true;
  while (edge != kNone && multiplicities_[edge] != 0) {
    std::int32_t& multiplicity = multiplicities_[edge];
    auto [from, to] = all_.edges_[edge];
    if (multiplicity < 0) std::swap(from, to);
    for (; multiplicity != 0; multiplicity += multiplicity < 0 ? 1 : -1) {
      if (begins) steps_.push_back({all_.vertices_[from], false, false});
      steps_.push_back({all_.vertices_[to], true, false});
      begins = true;  // a second copy begins where this one did
    }
    begins = false;
    edge = leaving_[to];
  }
}

}  // namespace raycone
