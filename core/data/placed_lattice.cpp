#include "core/data/placed_lattice.h"

#include <algorithm>
#include <cmath>

namespace raycone {
namespace {

// Without overflow, whatever the step.
Vec3 unit(const Vec3& step, double length) { return {step.x / length, step.y / length, step.z / length}; }

// The only axis that the step has a part of.
std::optional<std::size_t> only_axis(const Vec3& step) {
  std::optional<std::size_t> found;
  for (std::size_t a = 0; a < 3; ++a) {
    if (step[static_cast<int>(a)] == 0.0) continue;
    if (found) return std::nullopt;
    found = a;
  }
  return found;
}

}  // namespace

PlacedLattice::PlacedLattice(const Lattice& lattice)
    : grid(lattice),
      origin(lattice.origin),
      steps{Vec3{lattice.spacing.x, 0, 0}, Vec3{0, lattice.spacing.y, 0}, Vec3{0, 0, lattice.spacing.z}} {}

PlacedLattice::PlacedLattice(const Vec3& at, const std::array<Vec3, 3>& index_steps,
                             const std::array<std::int64_t, 3>& first, const std::array<std::int64_t, 3>& count)
    : grid{at, {safe_norm(index_steps[0]), safe_norm(index_steps[1]), safe_norm(index_steps[2])}, first, count},
      origin(at),
      steps(index_steps) {}

Vec3 PlacedLattice::position(std::int64_t i, std::int64_t j, std::int64_t k) const {
  return ((origin + static_cast<double>(i) * steps[0]) + static_cast<double>(j) * steps[1]) +
         static_cast<double>(k) * steps[2];
}

Vec3 PlacedLattice::position(const LatticeBlock& block, std::size_t number) const {
  const auto [i, j, k] = block.index_of(number);
  return position(i, j, k);
}

bool PlacedLattice::along_axes() const {
  for (std::size_t a = 0; a < 3; ++a) {
    if (only_axis(steps[a]) != a || !(steps[a][static_cast<int>(a)] > 0.0)) return false;
  }
  return true;
}

std::array<Vec3, 3> PlacedLattice::units() const {
  return {unit(steps[0], grid.spacing.x), unit(steps[1], grid.spacing.y), unit(steps[2], grid.spacing.z)};
}

std::array<double, 9> PlacedLattice::direction() const {
  const std::array<Vec3, 3> columns = units();
  std::array<double, 9> rows{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t a = 0; a < 3; ++a) rows[3 * row + a] = columns[a][static_cast<int>(row)] + 0.0;  // -0 as 0
  }
  return rows;
}

bool PlacedLattice::spans_space() const {
  constexpr double kFlat = 1e-12;  // rounding makes some 1e-16 of axes in one plane
  const auto [x, y, z] = grid.spacing;
  if (!(std::min({x, y, z}) > 0.0) || !std::isfinite(std::max({x, y, z}))) return false;
  const std::array<Vec3, 3> axes = units();
  return std::abs(dot(axes[0], cross(axes[1], axes[2]))) > kFlat;
}

bool PlacedLattice::is_finite() const {
  for (int axis = 0; axis < 3; ++axis) {
    double largest = std::abs(origin[axis]);
    for (std::size_t a = 0; a < 3; ++a) {
      const auto first = static_cast<double>(grid.index_min[a]);
      const auto last = static_cast<double>(grid.index_max(static_cast<int>(a)));
      largest += std::max(std::abs(first), std::abs(last)) * std::abs(steps[a][axis]);
    }
    if (!std::isfinite(largest)) return false;
  }
  return true;
}

bool PlacedLattice::is_orthogonal(double tolerance) const {
  const std::array<Vec3, 3> axes = units();
  return std::max({std::abs(dot(axes[0], axes[1])), std::abs(dot(axes[1], axes[2])),
                   std::abs(dot(axes[2], axes[0]))}) <= tolerance;
}

bool PlacedLattice::is_cubic(double tolerance) const {
  const auto [least, most] = std::minmax({grid.spacing.x, grid.spacing.y, grid.spacing.z});
  return most - least <= tolerance * most && is_orthogonal(tolerance);
}

Box box_of(const PlacedLattice& lattice) {
  Box box = empty_box();
  for (int corner = 0; corner < 8; ++corner) {
    std::array<std::int64_t, 3> index{};
    for (int a = 0; a < 3; ++a) {
      const auto n = static_cast<std::size_t>(a);
      index[n] = (corner >> a & 1) != 0 ? lattice.grid.index_max(a) : lattice.grid.index_min[n];
    }
    extend(box, lattice.position(index[0], index[1], index[2]));
  }
  return box;
}

Vec3 indices_of(const PlacedLattice& lattice, const Vec3& place) {
  const std::array<Vec3, 3> axes = lattice.units();
  const Vec3 away = place - lattice.origin;
  const double volume = dot(axes[0], cross(axes[1], axes[2]));
  Vec3 indices;
  for (std::size_t a = 0; a < 3; ++a) {
    const double part = dot(away, cross(axes[(a + 1) % 3], axes[(a + 2) % 3])) / volume;
    indices[static_cast<int>(a)] = part / lattice.grid.spacing[static_cast<int>(a)];
  }
  return indices;
}

LatticeBlock WorldOrder::block_of(const LatticeBlock& indices) const {
  LatticeBlock block;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t last = indices.first[a] + indices.counts[a] - 1;
    block.first[axis_of[a]] = mirrored[a] ? -last : indices.first[a];
    block.counts[axis_of[a]] = indices.counts[a];
  }
  return block;
}

WorldOrder::Walk WorldOrder::walk(const LatticeBlock& indices) const {
  const LatticeBlock world = block_of(indices);
  const std::array<std::int64_t, 3> pitches{1, world.counts[0], world.counts[0] * world.counts[1]};
  Walk walk;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t pitch = pitches[axis_of[a]];
    walk.strides[a] = mirrored[a] ? -pitch : pitch;
    if (mirrored[a]) walk.start += (indices.counts[a] - 1) * pitch;
  }
  return walk;
}

std::optional<WorldOrder> world_order(const PlacedLattice& placed) {
  WorldOrder order;
  order.lattice.origin = placed.origin;
  std::array<bool, 3> taken{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::optional<std::size_t> axis = only_axis(placed.steps[a]);
    if (!axis || taken[*axis]) return std::nullopt;
    taken[*axis] = true;
    const double step = placed.steps[a][static_cast<int>(*axis)];
    order.axis_of[a] = *axis;
    order.mirrored[a] = step < 0.0;
    order.lattice.spacing[static_cast<int>(*axis)] = std::abs(step);
  }
  const LatticeBlock block = order.block_of(whole(placed.grid));
  order.lattice.index_min = block.first;
  order.lattice.counts = block.counts;
  return order;
}

}  // namespace raycone
