#include "core/merging/surface_bricks.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "core/machine/first_touch.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

constexpr std::size_t kTrianglesPerTask = 4096;

class BrickGrid {
 public:
  BrickGrid(const Lattice& lattice, double shift) : lattice_(lattice), shift_(shift) {}

  // How many the lattice has.
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(along(0) * along(1) * along(2)); }

  // The place of the brick of a point in all of the lattice's, x fastest.
  [[nodiscard]] std::uint32_t place_of(const Vec3& p) const {
    std::int64_t place = 0;
    for (int axis = 2; axis >= 0; --axis) {
      const double at = lattice_.steps_from_first(axis, p[axis]);
      const auto brick = static_cast<std::int64_t>(std::floor(at / kSide + shift_));
      place = place * along(axis) + std::clamp<std::int64_t>(brick, 0, along(axis) - 1);
    }
    return static_cast<std::uint32_t>(place);
  }

 private:
  static constexpr double kSide = 32.0;  // voxels: faces of a brick fit into a processor's cache

  // Bricks along an axis, whether they are shifted or not.
  [[nodiscard]] std::int64_t along(int axis) const {
    return static_cast<std::int64_t>(static_cast<double>(lattice_.counts[static_cast<std::size_t>(axis)]) / kSide) + 2;
  }

  const Lattice& lattice_;
  double shift_;
};

// Whoever comes second from another brick finds one there; none takes its place for good.
std::vector<std::uint32_t> owners_of(std::size_t vertices, const std::vector<Triangle>& triangles,
                                     const std::vector<std::uint32_t>& brick_of) {
  std::vector<std::uint32_t> owner(vertices, SurfaceBricks::kUnmet);
  parallel_for_each(brick_of.size(), kTrianglesPerTask, [&](std::size_t face) {
    for (const std::uint32_t corner : triangles[face]) {
      const std::atomic_ref of_corner(owner[corner]);
      std::uint32_t known = of_corner.load(std::memory_order_relaxed);
      const bool is_first = known == SurfaceBricks::kUnmet &&
                            of_corner.compare_exchange_strong(known, brick_of[face], std::memory_order_relaxed);
      const bool is_own = is_first || known == brick_of[face];
      if (!is_own) of_corner.store(SurfaceBricks::kNone, std::memory_order_relaxed);
    }
  });
  return owner;
}

SurfaceBricks sorted(std::size_t vertices, const std::vector<Triangle>& triangles,
                     const std::vector<std::uint32_t>& brick_of, std::vector<std::uint32_t> places, std::size_t count) {
  return {{count,
           [&](const auto& emit) {
             for (std::uint32_t face = 0; face < brick_of.size(); ++face) emit(brick_of[face], face);
           }},
          owners_of(vertices, triangles, brick_of),
          std::move(places)};
}

}  // namespace

std::vector<std::uint32_t> SurfaceBricks::by_place() const {
  std::vector<std::uint32_t> bricks(places.empty() ? 0 : 1 + std::ranges::max(places), kNone);
  for (std::uint32_t brick = 0; brick < count(); ++brick) bricks[places[brick]] = brick;
  return bricks;
}

SurfaceBricks bricks_of(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles,
                        const Lattice& lattice, double shift) {
  const BrickGrid grid(lattice, shift);
  auto brick_of = sized_on_all_threads<std::uint32_t>(triangles.size());
  parallel_for_each(brick_of.size(), kTrianglesPerTask,
                    [&](std::size_t face) { brick_of[face] = grid.place_of(vertices[triangles[face][0]]); });
  std::vector<std::uint32_t> numbers(grid.size(), SurfaceBricks::kNone), places;
  for (std::uint32_t& brick : brick_of) {
    std::uint32_t& number = numbers[brick];
    if (number == SurfaceBricks::kNone) {
      number = static_cast<std::uint32_t>(places.size());
      places.push_back(brick);
    }
    brick = number;
  }
  const std::size_t count = places.size();
  return sorted(vertices.size(), triangles, brick_of, std::move(places), count);
}

SurfaceBricks one_brick_of(std::size_t vertices, const std::vector<Triangle>& triangles) {
  return sorted(vertices, triangles, std::vector<std::uint32_t>(triangles.size(), 0), {}, 1);
}

}  // namespace raycone
