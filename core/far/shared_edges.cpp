#include "core/far/shared_edges.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <new>
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
  if (triangles.size() > kMostTriangles) throw std::length_error("raycone: 2^30 or more triangles share edges");
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

// To fill it takes as long as the boundaries of many sets, where there are millions of edges.
SharedEdges::Scratch SharedEdges::take_scratch() const {
  {
    const std::lock_guard lock(mutex_);
    if (!spare_.empty()) {
      Scratch scratch = std::move(spare_.back());
      spare_.pop_back();
      return scratch;
    }
  }
  return {std::vector<std::int32_t>(edges_.size()), std::vector<std::uint32_t>(vertices_.size(), kNone)};
}

void SharedEdges::give_back(Scratch scratch) const noexcept {
  const std::lock_guard lock(mutex_);
  try {
    spare_.push_back(std::move(scratch));
  } catch (const std::bad_alloc&) {
    return;  // the next one is filled again
  }
}

std::optional<std::span<const ChainStep>> SharedEdges::Boundary::of(std::span<const std::uint32_t> triangles,
                                                                    std::size_t most) {
  const bool was_at_work = std::exchange(is_at_work_, true);
  const bool are_few = set_multiplicities(triangles) <= most;
  if (are_few) {
    set_chains();
  } else {
    for (const std::uint32_t edge : touched_) scratch_.multiplicities[edge] = 0;
  }
  is_at_work_ = was_at_work;
  return are_few ? std::optional(std::span<const ChainStep>(steps_)) : std::nullopt;
}

std::size_t SharedEdges::Boundary::set_multiplicities(std::span<const std::uint32_t> triangles) {
  touched_.clear();
  std::int64_t left = 0;
  for (const std::uint32_t n : triangles) {
    for (std::size_t i = 3 * std::size_t{n}; i < 3 * std::size_t{n} + 3; ++i) {
      const Side side = all_.sides_[i];
      if (side.edge == kNone) continue;
      std::int32_t& multiplicity = scratch_.multiplicities[side.edge];
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
  std::erase_if(touched_, [&](std::uint32_t edge) { return scratch_.multiplicities[edge] == 0; });
  for (const std::uint32_t edge : touched_) {
    scratch_.leaving[scratch_.multiplicities[edge] > 0 ? all_.edges_[edge].from : all_.edges_[edge].to] = edge;
  }
  for (const std::uint32_t edge : touched_) {
    if (scratch_.multiplicities[edge] != 0) add_chain(edge);
  }
  for (const std::uint32_t edge : touched_) {
    scratch_.leaving[all_.edges_[edge].from] = scratch_.leaving[all_.edges_[edge].to] = kNone;
  }
}

// As long as there is an edge that has not been added.
void SharedEdges::Boundary::add_chain(std::uint32_t edge) {
  bool begins = true;
  while (edge != kNone && scratch_.multiplicities[edge] != 0) {
    std::int32_t& multiplicity = scratch_.multiplicities[edge];
    auto [from, to] = all_.edges_[edge];
    if (multiplicity < 0) std::swap(from, to);
    for (; multiplicity != 0; multiplicity += multiplicity < 0 ? 1 : -1) {
      if (begins) steps_.push_back({all_.vertices_[from], false, false});
      steps_.push_back({all_.vertices_[to], true, false});
      begins = true;  // a second copy begins where this one did
    }
    begins = false;
    edge = scratch_.leaving[to];
  }
}

}  // namespace raycone
