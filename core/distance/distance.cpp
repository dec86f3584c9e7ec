#include "core/distance/distance.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "core/crossings/check_counts.h"
#include "core/crossings/lattice_rows.h"
#include "core/data/distance_blocks.h"
#include "core/data/space_curve.h"
#include "core/distance/distance_band.h"
#include "core/distance/distance_tree.h"
#include "core/exact/scale.h"
#include "core/machine/buckets.h"
#include "core/machine/built_once.h"
#include "core/machine/floating_point.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// visit(n) for each of the points, on all threads. Many points go along a curve, where each finds much of the tree of
// triangles in its cache; the nearer neighbours are, the more, so they are put in order together.
template <class Visit>
void for_each_point(std::span<const Vec3> points, const Visit& visit) {
  constexpr std::size_t kFew = 4096, kMost = std::size_t{1} << 20, kPointsPerTask = 256;
  constexpr unsigned kBits = 10, kBucketBits = 12, kNumberBits = 32;
  static_assert(kMost <= std::size_t{1} << kNumberBits && 3 * kBits + kNumberBits <= 64);
  if (points.size() < kFew) {
    return parallel_for_each(points.size(), kPointsPerTask, visit);
  }
  for (std::size_t first = 0; first < points.size(); first += kMost) {
    const std::span<const Vec3> here = points.subspan(first, std::min(kMost, points.size() - first));
    Box box = empty_box();
    for (const Vec3& p : here) extend(box, p);
    const SpaceCurve curve(box, kBits);
    const auto add = [&](std::size_t begin, std::size_t end, auto emit) {
      for (std::size_t n = begin; n < end; ++n) {
        const std::uint64_t place = curve.place(here[n]);
        emit(place >> (3 * kBits - kBucketBits), place << kNumberBits | n);
      }
    };
    const Buckets<std::uint64_t> buckets(here.size(), std::size_t{1} << kBucketBits, add);
    parallel_for_each(buckets.count(), [&](std::size_t n) { std::ranges::sort(buckets[n]); });
    const std::span<const std::uint64_t> order = buckets.all();
    parallel_for_each(order.size(), kPointsPerTask,
                      [&](std::size_t n) { visit(first + static_cast<std::uint32_t>(order[n])); });
  }
}

// From here on a mesh of coordinates up to 1 is a point at the origin, to the last bit.
constexpr double kFar = 0x1p55;
constexpr double kLargest = std::numeric_limits<double>::max();  // of distances, too

// From the origin. Its squares neither overflow nor vanish.
double length_without_overflow(const Vec3& p) {
  int exponent = 0;
  std::frexp(largest_coordinate(p), &exponent);
  const Vec3 q = PowerOfTwo(-exponent)(p);
  return std::min(PowerOfTwo(exponent)(std::sqrt(dot(q, q))), kLargest);
}

constexpr std::int64_t kSide = DistanceBlocks::kSide;
static_assert(kSide == static_cast<std::int64_t>(kBlockSide));

// `box`: of distances.samples(); `numbers` by place_in_block() from its first sample on.
void take_block(const SampleBox& box, std::span<const double> numbers, DistanceBlocks& distances) {
  LatticeIndex first;
  for (std::size_t a = 0; a < 3; ++a) {
    first[a] = distances.samples().first[a] + static_cast<std::int64_t>(box.begin[a]);
  }
  const std::span<double> taken = distances.add(
      {DistanceBlocks::block_of(first[0]), DistanceBlocks::block_of(first[1]), DistanceBlocks::block_of(first[2])});
  for (std::size_t k = 0; k < box.side(2); ++k) {
    for (std::size_t j = 0; j < box.side(1); ++j) {
      const std::size_t to = DistanceBlocks::index_in_block(
          {first[0], first[1] + static_cast<std::int64_t>(j), first[2] + static_cast<std::int64_t>(k)});
      std::ranges::copy(numbers.subspan(place_in_block({0, j, k}), box.side(0)), taken.subspan(to).begin());
    }
  }
}

}  // namespace

struct DistanceEvaluator::Implementation {
  Implementation(const TriangleMesh& original, SimdLevel level)
      : exponent(largest_exponent(original)), to_unit(-exponent), to_world(exponent), mesh(original), simd(level) {
    for (Vec3& p : mesh.vertices) p = to_unit(p);
    const auto at_origin = [&](std::uint32_t v) { return mesh.vertices[v] == Vec3{}; };
    const bool is_origin = std::ranges::all_of(
        mesh.triangles, [&](const Triangle& t) { return at_origin(t[0]) && at_origin(t[1]) && at_origin(t[2]); });
    if (is_origin) far_beyond = -1.0;
  }

  [[nodiscard]] const DistanceTree& nearest() const {
    return tree.get([this] { return DistanceTree(mesh, simd); });
  }

  // `limit`: a square, in units, beyond which the distance may be another one beyond it.
  [[nodiscard]] double distance_at(const Vec3& point, double limit) const {
    const Vec3 p = to_unit(point);
    if (!(largest_coordinate(p) <= far_beyond)) return length_without_overflow(point);
    return std::min(to_world(std::sqrt(nearest().squared_distance(p, limit))), kLargest);
  }

  // Above all squares of distances that are not above `limit`, by more than roots round.
  [[nodiscard]] double square_beyond(double limit) const {
    constexpr double kRounding = 1.0 + 1e-12, kUnderflow = 1e-300;
    const double in_units = to_unit(limit);
    return in_units * in_units * kRounding + kUnderflow;
  }

  [[nodiscard]] std::uint32_t triangle_at(const Vec3& point) const {
    const Vec3 p = to_unit(point);
    return largest_coordinate(p) <= far_beyond ? nearest().nearest_triangle(p) : 0;
  }

  [[nodiscard]] bool is_near(double coordinate) const { return std::abs(to_unit(coordinate)) <= far_beyond; }

  // The samples of a block that are not far: along each axis those of a range.
  [[nodiscard]] LatticeBlock near_part(const Lattice& lattice, const LatticeBlock& block) const {
    LatticeBlock near = block;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const auto sample_is_near = [&](std::int64_t i) { return is_near(lattice.coordinate(axis, i)); };
      while (near.counts[a] > 0 && !sample_is_near(near.first[a])) {
        ++near.first[a];
        --near.counts[a];
      }
      while (near.counts[a] > 0 && !sample_is_near(near.first[a] + near.counts[a] - 1)) --near.counts[a];
    }
    return near;
  }

  // As DistanceEvaluator::evaluate(), of samples that are not far.
  void evaluate_near(const Lattice& lattice, const LatticeBlock& block, double band,
                     std::span<double> distances) const {
    const LatticeRows rows = rows_in_scale(lattice, block, to_unit);
    // No sample that is not far is farther from the mesh than four times kFar.
    const double unit_band = std::min(to_unit(band), 4 * kFar);
    const RootKernel take_roots = root_kernel(simd);
    const auto finish = [&](std::span<double, kSamplesOfBlock> squares) { take_roots(squares, to_world, band); };
    fill_band(nearest(), rows, unit_band, {finish, band}, distances);
  }

  // The same in blocks that are reset.
  void evaluate_near(const Lattice& lattice, DistanceBlocks& distances) const {
    const LatticeBlock& samples = distances.samples();
    const LatticeRows rows = rows_in_scale(lattice, samples, to_unit);
    const double band = distances.beyond();
    BandVisitor visitor;
    visitor.beyond = [](const SampleBox&) {};
    const RootKernel take_roots = root_kernel(simd);
    visitor.block = [&](const SampleBox& box, std::span<double, kSamplesOfBlock> squares) {
      if (take_roots(squares, to_world, band)) take_block(box, squares, distances);
    };
    BlockPhase phase;
    for (std::size_t a = 0; a < 3; ++a) phase[a] = static_cast<std::size_t>(samples.first[a] & (kSide - 1));
    constexpr std::size_t kY = 1;  // as blocks are added: see DistanceBlocks
    visit_band(nearest(), rows, std::min(to_unit(band), 4 * kFar), phase, kY, visitor);
  }

  double far_beyond = kFar;  // in units; none is near a mesh that is the origin

  // The largest coordinate is brought into [1/2, 1): nothing overflows, and what gets lost at the other end is less
  // than 1e-300 of it.
  int exponent;
  PowerOfTwo to_unit, to_world;
  TriangleMesh mesh;
  SimdLevel simd;

 private:
  BuiltOnce<DistanceTree> tree;
};

DistanceEvaluator::DistanceEvaluator(const TriangleMesh& mesh, SimdLevel level) {
  check_counts(mesh);
  const DefaultFloatingPoint guard;
  implementation_ = std::make_unique<Implementation>(mesh, level);
}
DistanceEvaluator::~DistanceEvaluator() = default;
DistanceEvaluator::DistanceEvaluator(DistanceEvaluator&&) noexcept = default;
DistanceEvaluator& DistanceEvaluator::operator=(DistanceEvaluator&&) noexcept = default;

void DistanceEvaluator::evaluate(const Lattice& lattice, const LatticeBlock& block, double band,
                                 std::span<double> distances) const {
  assert(distances.size() == static_cast<std::size_t>(block.size()));
  check_counts(block);
  if (distances.empty()) return;
  if (implementation_->mesh.triangles.empty()) {
    std::ranges::fill(distances, band);
    return;
  }
  const DefaultFloatingPoint guard;
  band = std::min(band, kLargest);
  const LatticeBlock near = implementation_->near_part(lattice, block);
  if (near.counts == block.counts) return implementation_->evaluate_near(lattice, block, band, distances);
  // Rare: a lattice that is much larger than the mesh.
  std::vector<double> near_distances(static_cast<std::size_t>(near.size()));
  if (!near_distances.empty()) implementation_->evaluate_near(lattice, near, band, near_distances);
  const double* near_distance = near_distances.data();
  double* distance = distances.data();
  for_each_sample(block, [&](const LatticeIndex& sample) {
    *distance++ =
        near.holds(sample) ? *near_distance++ : std::min(length_without_overflow(lattice.position(sample)), band);
  });
}

void DistanceEvaluator::evaluate(const Lattice& lattice, const LatticeBlock& block, double band,
                                 DistanceBlocks& distances) const {
  check_counts(block);
  const DefaultFloatingPoint guard;
  distances.reset(block, std::min(band, kLargest));
  if (implementation_->mesh.triangles.empty() || block.size() == 0) return;
  if (implementation_->near_part(lattice, block).counts == block.counts) {
    return implementation_->evaluate_near(lattice, distances);
  }
  // Rare, as above.
  std::vector<double> numbers(static_cast<std::size_t>(block.size()));
  evaluate(lattice, block, band, numbers);
  for_each_sample(distances.blocks(), [&](const LatticeIndex& place) {
    const LatticeBlock samples = distances.samples_of(place);
    std::array<double, DistanceBlocks::kSamples> of_block;
    of_block.fill(distances.beyond());
    for_each_sample(samples, [&](const LatticeIndex& sample) {
      of_block[DistanceBlocks::index_in_block(sample)] = numbers[block.number_of(sample)];
    });
    if (std::ranges::min(of_block) < distances.beyond()) std::ranges::copy(of_block, distances.add(place).begin());
  });
}

void DistanceEvaluator::prepare_points() const {
  const DefaultFloatingPoint guard;
  if (!implementation_->mesh.triangles.empty()) (void)implementation_->nearest();
}

void DistanceEvaluator::evaluate(std::span<const Vec3> points, std::span<double> distances, double limit) const {
  assert(distances.size() == points.size());
  if (implementation_->mesh.triangles.empty()) {
    std::ranges::fill(distances, std::numeric_limits<double>::infinity());
    return;
  }
  prepare_points();  // not within the loop, whose threads would wait for one another
  const double square = implementation_->square_beyond(limit);
  for_each_point(points, [&](std::size_t n) { distances[n] = implementation_->distance_at(points[n], square); });
}

void DistanceEvaluator::find_nearest(std::span<const Vec3> points, std::span<std::uint32_t> triangles) const {
  assert(triangles.size() == points.size());
  prepare_points();
  for_each_point(points, [&](std::size_t n) { triangles[n] = implementation_->triangle_at(points[n]); });
}

}  // namespace raycone
