#include "core/far/lattice_blocks_walk.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "core/boundary/sample_tile.h"
#include "core/far/harmonic_error.h"
#include "core/far/harmonic_fit.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// The tolerance is spent on far triangles, level by level of blocks; on coefficients left out; and on multipoles, at
// nodes, where fits multiply their errors, and at samples.
constexpr double kFarShare = 0.6;
constexpr double kTruncationShare = 0.05;
constexpr double kNodeShare = 0.15;

// Times, in units of that of a triangle at a sample.
constexpr double kFitting = 8000.0;          // of making a block's polynomial, beside the triangles at its nodes
constexpr double kPolynomial = 3.0;          // of the polynomial at a sample, all along rows, ...
constexpr double kPolynomialAtPoint = 16.0;  // ... and at a scattered point
constexpr double kInPatch = 0.75;            // of a near triangle, where boundaries may be summed in their place

// In samples. Blocks smaller than this are not divided, larger ones if that pays, ...
constexpr double kSmallBlock = 0x1p12;
constexpr double kLargeBlock = 0x1p15;    // ... those beyond this always, or beyond ...
constexpr double kLargestBlock = 0x1p18;  // ... this where nothing is near.

// Cubes are larger than their blocks by this factor: on their faces nodes would lie in the planes of samples, where
// many meshes have flat boundaries, and the sides of triangles would be ties.
constexpr double kMargin = 1.0 + 0x1.3p-9;

double field_cost(double far) { return far * static_cast<double>(HarmonicFit::kNodes) + kFitting; }

// Of a block that has no field unless something is far: its parent has none.
double cost_of_own_field(double far) { return far > 0.0 ? field_cost(far) : 0.0; }

// Cut so that sub-blocks are whole, but for those at the end of the lattice.
std::size_t middle_of(const SampleBlock& block, std::size_t axis) {
  const std::size_t half = block.samples.side(axis) / 2, step = kSubBlock[axis];
  return block.samples.begin[axis] + (half < step ? half : (half + step / 2) / step * step);
}

// By how much the nodes of a fit are moved along an axis at most, half sides: they are coordinates, which are rounded.
double most_moved(const Cube& cube) {
  return 0x1.00001p-53 * (largest_coordinate(cube.centre) + 2 * cube.half) / cube.half;
}

// What that changes of the fit of a dipole of unit strength, in the units of dipole_error(): the dipole's field changes
// by at most 1 / (2 pi r^3) times the way, and the fit by its weights times that (docs/method.md, "Moved nodes").
double moved_nodes_error(double distance, double moved) {
  constexpr double kPerWay = HarmonicFit::kLargestWeights * 0.27567;  // sqrt(3) / (2 pi)
  const double gap = distance - 1.0 - moved;
  return kPerWay * moved / (gap * gap * gap);
}

Box box_around(const Cube& cube) {
  const Vec3 half{cube.half, cube.half, cube.half};
  return {cube.centre - half, cube.centre + half};
}

}  // namespace

// --- Dividing -------------------------------------------------------------------------------------------------------

LatticeBlocksWalk::LatticeBlocksWalk(const LatticeBlocks& blocks, const LatticeAxes& axes, AxesOf axes_of)
    : blocks_(blocks),
      axes_(axes),
      axes_of_(axes_of),
      kernels_{shared_corners_kernel(blocks.level_, Care::kFull), cone_kernel(blocks.level_),
               far_kernel(blocks.level_)},
      matrices_(matrix_kernel(blocks.level_)),
      near_triangle_(blocks.edges_ && axes_of == AxesOf::kSamples ? kInPatch : 1.0) {
  for (SampleBlock block = lattice(); block.size() >= kSmallBlock; ++last_level_) {
    std::vector<SampleBlock> parts = halves(block);
    block = *std::ranges::max_element(parts, {}, &SampleBlock::size);
    if (parts.size() < 2 || block.size() <= static_cast<double>(HarmonicFit::kNodes)) break;  // no fit would pay
  }
}

SampleBlock LatticeBlocksWalk::lattice() const {
  const std::size_t ends = axes_of_ == AxesOf::kCells ? 1 : 0;
  return {.samples = {{0, 0, 0}, {axes_[0].size() - ends, axes_[1].size() - ends, axes_[2].size() - ends}}};
}

double LatticeBlocksWalk::length(const SampleBlock& block, std::size_t axis) const {
  return last_of(axis, block.samples.end[axis]) - first_of(axis, block.samples.begin[axis]);
}

// The block cut in two along its longer axes. Sub-blocks of cells are the same whatever the blocks, so they stay whole.
std::vector<SampleBlock> LatticeBlocksWalk::halves(const SampleBlock& block) const {
  const double longest = std::max({length(block, 0), length(block, 1), length(block, 2)});
  std::vector<SampleBlock> pieces{
      {.level = block.level + 1, .samples = block.samples, .field = block.field, .spent = block.spent}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t least = axes_of_ == AxesOf::kCells ? 2 * kSubBlock[axis] : 2;
    if (block.samples.side(axis) < least || length(block, axis) <= 0.6 * longest) continue;
    const std::size_t middle = middle_of(block, axis), count = pieces.size();
    for (std::size_t n = 0; n < count; ++n) {
      SampleBlock upper = pieces[n];
      pieces[n].samples.end[axis] = upper.samples.begin[axis] = middle;
      pieces.push_back(std::move(upper));
    }
  }
  return pieces;
}

Cube LatticeBlocksWalk::cube_around(const SampleBlock& block) const {
  Cube cube{{}, 0.0};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double first = first_of(axis, block.samples.begin[axis]), last = last_of(axis, block.samples.end[axis]);
    cube.centre[static_cast<int>(axis)] = first / 2 + last / 2;
    cube.half = std::max(cube.half, (last / 2 - first / 2) * kMargin);
  }
  return cube;
}

Box LatticeBlocksWalk::box_of(const SampleBox& samples) const {
  Box box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.lower[static_cast<int>(axis)] = first_of(axis, samples.begin[axis]);
    box.upper[static_cast<int>(axis)] = last_of(axis, samples.end[axis]);
  }
  return box;
}

LatticeBlocksWalk::Division LatticeBlocksWalk::whole() const {
  std::vector<std::uint32_t> triangles(blocks_.sources_.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) triangles[i] = static_cast<std::uint32_t>(i);
  return divided_into({lattice()}, triangles);
}

LatticeBlocksWalk::Division LatticeBlocksWalk::divide(const SampleBlock& block) const {
  if (block.near.empty() ? block.size() <= kLargestBlock : block.size() < kSmallBlock) return {};
  return divided_into(halves(block), block.near);
}

LatticeBlocksWalk::Division LatticeBlocksWalk::divided_into(std::vector<SampleBlock> children,
                                                            std::span<const std::uint32_t> triangles) const {
  constexpr std::size_t kMany = 1 << 12;
  Division division{std::move(children), {}};
  division.far.resize(division.children.size());
  const auto share_out = [&](std::size_t n) { division.far[n] = far_of(division.children[n], triangles); };
  if (triangles.size() >= kMany) {
    parallel_for_each(division.children.size(), share_out);
  } else {
    for (std::size_t n = 0; n < division.children.size(); ++n) share_out(n);
  }
  return division;
}

Cover LatticeBlocksWalk::far_of(SampleBlock& block, std::span<const std::uint32_t> triangles) const {
  block.cube = cube_around(block);
  Far far = far_triangles(block, triangles);
  Cover cover = cover_at_nodes(far.triangles, block.cube);
  if (cost_of_own_field(cover.cost) > static_cast<double>(far.triangles.size()) * block.size()) {
    far = {};
    cover = {};
    block.near.assign(triangles.begin(), triangles.end());
  } else {
    block.near = std::move(far.others);
  }
  block.spent += far.error;
  block.near_cost = cover_at(block, block.samples).cost;
  return cover;
}

// Whether the nodes of a fit are where they should be, nearly. What that changes is in error_of().
bool LatticeBlocksWalk::can_fit_in(const Cube& cube) const {
  return most_moved(cube) <= std::max(0x1p-36, blocks_.tolerance_ / 128);
}

double LatticeBlocksWalk::far_budget() const { return kFarShare * blocks_.tolerance_; }

// What the blocks around it have left is for this level and for those below, in equal parts.
double LatticeBlocksWalk::far_budget_of(const SampleBlock& block) const {
  return (far_budget() - block.spent) / static_cast<double>(last_level_ - block.level + 1);
}

// As many as the budget allows, the most harmless first. A block that is deeper than the largest ones ever are has
// none.
LatticeBlocksWalk::Far LatticeBlocksWalk::far_triangles(const SampleBlock& block,
                                                        std::span<const std::uint32_t> triangles) const {
  Far far;
  std::vector<char> is_far(triangles.size(), 0);
  if (block.level <= last_level_ && can_fit_in(block.cube)) far.error = mark_far(block, triangles, is_far);
  for (std::size_t n = 0; n < triangles.size(); ++n) (is_far[n] ? far.triangles : far.others).push_back(triangles[n]);
  return far;
}

// Returns by how much the fit of what it marks is off at most.
double LatticeBlocksWalk::mark_far(const SampleBlock& block, std::span<const std::uint32_t> triangles,
                                   std::span<char> is_far) const {
  double error = 0.0;
  const double budget = far_budget_of(block);
  std::vector<Together> candidates = harmless_of(block.cube, triangles, budget);
  // By halves: sorting all takes longer.
  for (auto begin = candidates.begin(), end = candidates.end(); begin != end;) {
    const auto middle = begin + (end - begin) / 2;
    std::nth_element(begin, middle, end);
    const double with =
        std::accumulate(begin, middle + 1, error, [](double s, const Together& t) { return s + t.error; });
    if (with > budget) {
      end = middle;
      continue;
    }
    error = with;
    for (; begin <= middle; ++begin) std::ranges::fill(is_far.subspan(begin->first, begin->count), 1);
  }
  return error;
}

// Of many triangles, those of a leaf are far together or not at all: parts of leaves are no expansions, neither at
// nodes nor, of what is left, at samples.
std::vector<LatticeBlocksWalk::Together> LatticeBlocksWalk::harmless_of(const Cube& cube,
                                                                        std::span<const std::uint32_t> triangles,
                                                                        double budget) const {
  constexpr std::size_t kMany = 1 << 11;  // measured: of fewer, the finer choice leaves less near
  const double moved = most_moved(cube);
  std::vector<Together> harmless;
  for (std::size_t begin = 0, end = 0; begin < triangles.size(); begin = end) {
    const std::uint32_t leaf_end = triangles.size() >= kMany ? blocks_.leaf_ends_[triangles[begin]] : 0;
    double error = 0.0;
    do {
      error += error_of(blocks_.sources_[triangles[end++]], cube, moved);
    } while (end < triangles.size() && triangles[end] < leaf_end);
    const std::size_t count = end - begin;
    if (error <= budget) harmless.push_back({error / static_cast<double>(count), begin, count, error});
  }
  return harmless;
}

// By how much the block's polynomial is off at most because of a triangle; infinite or NaN if that is not known.
double LatticeBlocksWalk::error_of(const TriangleExtent& source, const Cube& cube, double moved) {
  constexpr double kLeastHalf = 0x1p-400;  // squares of less lose bits, as areas of sources of that size do
  if (cube.half < kLeastHalf) return std::numeric_limits<double>::infinity();
  double distance = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    distance =
        std::max({distance, source.box.lower[axis] - cube.centre[axis], cube.centre[axis] - source.box.upper[axis]});
  }
  distance = distance / cube.half * (1 - 0x1p-40);  // rounding of the quotients must make it no larger
  return source.area / (cube.half * cube.half) * (dipole_error(distance) + moved_nodes_error(distance, moved));
}

Cover LatticeBlocksWalk::cover_at_nodes(std::span<const std::uint32_t> far, const Cube& cube) const {
  return cover_in(blocks_.tree_, far, box_around(cube), kNodeShare * blocks_.tolerance_ / HarmonicFit::kLargestWeights);
}

Cover LatticeBlocksWalk::cover_at(const SampleBlock& block, const SampleBox& sub_block) const {
  return cover_in(blocks_.tree_, block.near, box_of(sub_block), kSampleShare * blocks_.tolerance_, near_triangle_);
}

// --- Choosing -------------------------------------------------------------------------------------------------------

double LatticeBlocksWalk::near_cost(const SampleBlock& block) const {
  return (block.near_cost + (axes_of_ == AxesOf::kCells ? kPolynomialAtPoint : kPolynomial)) * block.size();
}

bool LatticeBlocksWalk::pays(const SampleBlock& block, const Division& division) const {
  if (division.children.size() < 2) return false;
  if (block.near.empty() || block.size() > kLargeBlock) return true;
  double cost = 0.0;
  for (std::size_t n = 0; n < division.children.size(); ++n) {
    const double far = division.far[n].cost;
    cost += (block.field != nullptr ? field_cost(far) : cost_of_own_field(far)) + near_cost(division.children[n]);
  }
  return cost < near_cost(block);
}

double LatticeBlocksWalk::cost() const {
  const Division all = whole();
  const SampleBlock& block = all.children.front();
  return (cost_of_own_field(all.far.front().cost) + estimate(block)) / block.size();
}

// The time for a block, from some of its parts: opposite ones, and further in other ones.
double LatticeBlocksWalk::estimate(const SampleBlock& block) const {
  constexpr std::array<std::uint32_t, 2> kSome{0b01101001, 0b10010110};
  constexpr std::uint32_t kFew = 0b10000001;
  constexpr std::size_t kDeep = 4;
  const Division division = divide(block);
  if (!pays(block, division)) return near_cost(block);
  const std::uint32_t looked_at = block.level < kDeep ? kSome[block.level % 2] : kFew;
  std::vector<double> estimates(division.children.size(), 0.0);
  parallel_for_each(estimates.size(), [&](std::size_t n) {
    if ((looked_at >> n) % 2 != 0) estimates[n] = estimate(division.children[n]);
  });
  double making = 0.0, inside = 0.0, samples = 0.0;
  for (std::size_t n = 0; n < estimates.size(); ++n) {
    making += field_cost(division.far[n].cost);
    if ((looked_at >> n) % 2 == 0) continue;
    inside += estimates[n];
    samples += division.children[n].size();
  }
  return making + inside * (block.size() / samples);
}

// --- Fields ---------------------------------------------------------------------------------------------------------

void LatticeBlocksWalk::make_fields(Division& division) const {
  std::vector<double> values(HarmonicFit::kNodes * HarmonicFit::kTogether);
  std::vector<Coefficients> fits(division.children.size());
  bool any = false;
  for (std::size_t n = 0; n < fits.size(); ++n) {
    any = any || division.far[n].cost > 0.0;
    add_at_nodes(division.far[n], division.children[n].cube, n, values);
  }
  if (!any) return;  // the parent's field, if any, does for all
  HarmonicFit::instance().fit(values, fits, matrices_);
  for (std::size_t n = 0; n < fits.size(); ++n) {
    if (division.far[n].cost == 0.0) continue;
    SampleBlock& child = division.children[n];
    if (child.field) {
      const Coefficients other = on_cube(child.field->coefficients, child.field->cube, child.cube, matrices_);
      for (std::size_t i = 0; i < other.size(); ++i) fits[n][i] += other[i];
    }
    child.field = std::make_shared<const FieldOnCube>(FieldOnCube{child.cube, fits[n]});
  }
}

void LatticeBlocksWalk::add_at_nodes(const Cover& far, const Cube& cube, std::size_t place,
                                     std::span<double> values) const {
  if (far.cost == 0.0) return;
  const HarmonicFit& fit = HarmonicFit::instance();
  CoverSums sums(blocks_.tree_, far, box_around(cube), kernels_);
  count_terms(far, HarmonicFit::kNodes);
  SampleTile nodes;
  for (std::size_t begin = 0; begin < HarmonicFit::kNodes; begin += kTile) {
    nodes.clear();
    for (std::size_t n = begin; n < std::min(begin + kTile, HarmonicFit::kNodes); ++n) {
      nodes.add(cube.centre + cube.half * fit.node(n));
    }
    sums.evaluate(nodes, TileShape::kScattered, [&](std::size_t i, double turns, double rest) {
      values[(begin + i) * HarmonicFit::kTogether + place] = turns + rest;
    });
  }
}

void LatticeBlocksWalk::count_polynomials(std::size_t samples) const {
  blocks_.far_terms_.fetch_add(samples, std::memory_order_relaxed);
}

bool LatticeBlocksWalk::overlap(const SampleBlock& block, const SampleBox& part) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(part.begin[axis] < block.samples.end[axis] && block.samples.begin[axis] < part.end[axis])) return false;
  }
  return true;
}

std::size_t LatticeBlocksWalk::degree(const SampleBlock& block) const {
  return block.field ? truncation(block.field->coefficients, kTruncationShare * blocks_.tolerance_).degree : 0;
}

CoverSums LatticeBlocksWalk::sums_of(const Cover& cover, const SampleBox& sub_block) const {
  return {blocks_.tree_, cover, box_of(sub_block), kernels_};
}

}  // namespace raycone
