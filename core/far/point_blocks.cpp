#include "core/far/point_blocks.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/machine/threads.h"

namespace raycone {
namespace {

// More cells would take memory: a block has 27 kB, and at most 2^12 to 2^15 cells.
constexpr double kMostCells = 0x1p21;

// Of cells that are about cubes. A box may be flat.
LatticeAxes axes_of_cells(const Box& box, double points) {
  constexpr double kMostAlong = 0x1p16, kFlat = 0x1p-10;
  Vec3 size = box.upper - box.lower;
  const double longest = longest_side(box);
  for (int axis = 0; axis < 3; ++axis) size[axis] = std::max(size[axis], kFlat * longest);
  const double cells = std::clamp(points, 1.0, kMostCells);
  const double side = std::max(std::cbrt(size.x * size.y * size.z / cells), longest / kMostAlong);
  LatticeAxes axes;
  for (int axis = 0; axis < 3; ++axis) {
    const auto count = static_cast<std::size_t>(std::ceil((box.upper[axis] - box.lower[axis]) / side));
    std::vector<double>& ends = axes[static_cast<std::size_t>(axis)];
    for (std::size_t i = 0; i < count; ++i) ends.push_back(box.lower[axis] + static_cast<double>(i) * side);
    ends.push_back(std::max(box.upper[axis], ends.empty() ? box.lower[axis] : ends.back()));
    if (ends.size() < 2) ends.push_back(ends.back());
  }
  return axes;
}

std::uint32_t groups_along(std::size_t axis, const LatticeAxes& axes) {
  return static_cast<std::uint32_t>((axes[axis].size() - 1 + kSubBlock[axis] - 1) / kSubBlock[axis]);
}

}  // namespace

struct PointBlocks::Block {
  explicit Block(SampleBlock cells) : block(std::move(cells)) {}

  [[nodiscard]] bool has(const std::array<std::size_t, 3>& cell) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!(block.samples.begin[axis] <= cell[axis] && cell[axis] < block.samples.end[axis])) return false;
    }
    return true;
  }

  SampleBlock block;
  BuiltOnce<std::vector<std::unique_ptr<Block>>> parts;
};

PointBlocks::PointBlocks(const LatticeBlocks& blocks, const Box& box, double points)
    : axes_(axes_of_cells(box, points)),
      counts_{groups_along(0, axes_), groups_along(1, axes_), groups_along(2, axes_)},
      walk_(blocks, axes_, AxesOf::kCells),
      polynomial_(polynomial_kernel(blocks.level())),
      groups_(std::make_unique<BuiltOnce<Group>[]>(groups())) {
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double>& ends = axes_[static_cast<std::size_t>(axis)];
    const double cells = static_cast<double>(ends.size() - 1);
    cells_per_unit_[axis] = ends.back() > ends.front() ? cells / (ends.back() - ends.front()) : 0.0;
  }
}

PointBlocks::~PointBlocks() = default;

std::optional<std::uint32_t> PointBlocks::group_of(const Vec3& q) const {
  std::uint32_t group = 0;
  for (std::size_t axis = 3; axis-- > 0;) {
    const std::vector<double>& ends = axes_[axis];
    const double x = q[static_cast<int>(axis)];
    if (!(ends.front() <= x && x <= ends.back())) return std::nullopt;
    const std::size_t step = kSubBlock[axis];
    const double guess = (x - ends.front()) * cells_per_unit_[static_cast<int>(axis)] / static_cast<double>(step);
    std::size_t n = std::min(static_cast<std::size_t>(guess), std::size_t{counts_[axis] - 1});
    while (n > 0 && x < ends[n * step]) --n;
    while (n + 1 < counts_[axis] && ends[(n + 1) * step] <= x) ++n;
    group = group * counts_[axis] + static_cast<std::uint32_t>(n);
  }
  return group;
}

SampleBox PointBlocks::cells_of(std::uint32_t group) const {
  const std::array<std::size_t, 3> place{group % counts_[0], group / counts_[0] % counts_[1],
                                         group / counts_[0] / counts_[1]};
  SampleBox cells;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cells.begin[axis] = place[axis] * kSubBlock[axis];
    cells.end[axis] = std::min(cells.begin[axis] + kSubBlock[axis], axes_[axis].size() - 1);
  }
  return cells;
}

PointBlocks::Block& PointBlocks::whole() const {
  return *whole_.get([this] {
    LatticeBlocksWalk::Division all = walk_.whole();
    walk_.make_fields(all);
    return std::make_unique<Block>(std::move(all.children.front()));
  });
}

const std::vector<std::unique_ptr<PointBlocks::Block>>& PointBlocks::parts_of(Block& block) const {
  return block.parts.get([&] {
    std::vector<std::unique_ptr<Block>> parts;
    LatticeBlocksWalk::Division division = walk_.divide(block.block);
    if (!walk_.pays(block.block, division)) return parts;
    walk_.make_fields(division);
    for (SampleBlock& part : division.children) parts.push_back(std::make_unique<Block>(std::move(part)));
    block.block.near = {};  // nobody asks again, and all of them would take much memory
    return parts;
  });
}

void PointBlocks::make_group(std::uint32_t group, const Block& block) const {
  groups_[group].get([&] {
    return Group{block.block.field.get(), walk_.degree(block.block), walk_.cover_at(block.block, cells_of(group))};
  });
}

// Level by level, so that no thread waits for what another one makes.
void PointBlocks::prepare(std::span<const std::uint32_t> groups) const {
  struct Work {
    Block* block;
    std::vector<std::uint32_t> groups;
  };
  std::vector<Work> level{{&whole(), {groups.begin(), groups.end()}}}, done;
  while (!level.empty()) {
    parallel_for_each(level.size(), [&](std::size_t n) { parts_of(*level[n].block); });
    std::vector<Work> next;
    for (Work& work : level) {
      const std::vector<std::unique_ptr<Block>>& parts = parts_of(*work.block);
      for (const std::unique_ptr<Block>& part : parts) {
        Work& below = next.emplace_back(Work{part.get(), {}});
        std::ranges::copy_if(work.groups, std::back_inserter(below.groups),
                             [&](std::uint32_t group) { return part->has(cells_of(group).begin); });
        if (below.groups.empty()) next.pop_back();
      }
      if (parts.empty()) done.push_back(std::move(work));
    }
    level = std::move(next);
  }
  parallel_for_each(done.size(), [&](std::size_t n) {
    for (const std::uint32_t group : done[n].groups) make_group(group, *done[n].block);
  });
}

PointBlocks::Sums::Sums(const PointBlocks& blocks, std::uint32_t group)
    : blocks_(blocks),
      group_(*blocks.groups_[group].if_built()),
      cover_sums_(blocks.walk_.sums_of(group_.cover, blocks.cells_of(group))) {}

void PointBlocks::Sums::evaluate(SampleTile& samples, std::span<double> sums) {
  samples.fill_up();
  alignas(64) Tile values{};
  if (const FieldOnCube* const field = group_.field) {
    blocks_.polynomial_(field->coefficients, group_.degree, field->cube, samples, values);
    blocks_.walk_.count_polynomials(samples.count);
  }
  cover_sums_.evaluate(samples, TileShape::kScattered,
                       [&](std::size_t i, double turns, double rest) { sums[i] = turns + (rest + values[i]); });
  blocks_.walk_.count_terms(group_.cover, samples.count);
}

}  // namespace raycone
