#include "core/evaluation/rule_blocks.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "core/boundary/change_bound.h"
#include "core/evaluation/cut_blocks.h"
#include "core/evaluation/lattice_polynomial.h"
#include "core/evaluation/lattice_tile.h"
#include "core/evaluation/node_choice.h"
#include "core/evaluation/rough_sides.h"
#include "core/evaluation/side_samples.h"
#include "core/evaluation/sums_round.h"
#include "core/far/matrix_kernel.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// Blocks of so few samples that have no certificate are not divided: rough sums do then or, where there are none, the
// samples' own values.
constexpr std::size_t kFewForRoughSums = 512;
constexpr std::size_t kFew = 32;
constexpr double kMostChange = 0.5;  // turns, from a sample: more is hardly ever below the distance from a threshold

// All points from which a ray meets an exterior edge.
std::vector<FlatPiece> cones_of(const Boundary& boundary) {
  std::vector<FlatPiece> cones;
  for (const DirectedEdge& edge : boundary.directed_edges()) cones.push_back(FlatPiece::cone_of(edge.from, edge.to));
  return cones;
}

bool is_boundary_all_over(const ScaledMesh& mesh) {
  constexpr double kAllOver = 0.1;  // exterior edges for each face
  return static_cast<double>(mesh.boundary().exterior_edges()) >
         kAllOver * static_cast<double>(mesh.mesh().triangles.size());
}

bool takes_rough_sums(const ScaledMesh& mesh) { return mesh.choice().has_rough_sums() && mesh.blocks().are_sound; }

// Whether looking for certificates takes longer than what they save: measured; with fewer edges they save up to a
// third. Soups have hardly a block that one decides.
bool takes_rough_sums_alone(const ScaledMesh& mesh) {
  constexpr std::uint64_t kManyEdges = 1000;
  if (!mesh.counts_crossings()) return true;
  return is_boundary_all_over(mesh) && mesh.boundary().exterior_edges() >= kManyEdges && takes_rough_sums(mesh);
}

void set_sides_by_rough_sums(const SideSamples& samples, std::atomic<std::uint64_t>* done) {
  (void)samples.mesh().far_field();  // made on all threads outside loops
  const SampleBoxes boxes(samples.rows().counts(), kLargestBlockSide);
  parallel_for_each(boxes.size(), [&](std::size_t n) {
    const SampleBox box = boxes[n];
    std::vector<SampleBox> undecided;
    set_sides_roughly(samples, {&box, 1}, undecided);
    samples.evaluate_each(undecided);
    if (done) done->fetch_add(box.size(), std::memory_order_relaxed);
  });
}

struct Middle {
  SideSamples::Index sample;
  double radius;  // others are at most so far from it
};

Middle middle_of(const LatticeRows& rows, const SampleBox& samples, const Box& box) {
  Middle middle{};
  double square = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    middle.sample[axis] = samples.begin[axis] + samples.side(axis) / 2;
    const double x = rows.along(axis)[middle.sample[axis]];
    const double extent = std::max(x - box.lower[static_cast<int>(axis)], box.upper[static_cast<int>(axis)] - x);
    square += extent * extent;
  }
  middle.radius = std::sqrt(square);
  return middle;
}

// A block in which the rest is smooth. It is known well enough once it is known at one sample, or at some nodes.
struct SmoothBlock {
  CutBlock block;
  Crossings which;
  double gradient;                          // its length is at most this, turns per unit
  double change;                            // from the sample in the middle to others at most, turns
  std::vector<SideSamples::Index> samples;  // the one in the middle, or the nodes
  std::vector<double> rest{};               // at each of them
  double largest = 0.0;                     // magnitude of a winding number there, which was rounded
  std::optional<NodeGrid> nodes{};
};

// Of a block, what certificates do not decide.
struct Undecided {
  std::vector<SampleBox> boxes;  // without certificate
  std::vector<SampleBox> runs;   // interpolation does not tell
  bool is_all = false;           // nobody looked for certificates: the whole block is the only box
  std::size_t samples = 0;       // of the whole block
};

// Thread-safe.
class RuleBlocks {
 public:
  explicit RuleBlocks(const SideSamples& samples)
      : samples_(samples),
        rows_(samples.rows()),
        mesh_(samples.mesh()),
        changes_(mesh_.change_bound()),
        matrices_(matrix_kernel(mesh_.options().level)),
        has_rough_sums_(mesh_.choice().has_rough_sums()),
        blocks_(rows_, changes_.wide_caps(), cones_of(mesh_.boundary())) {}

  [[nodiscard]] std::size_t size() const { return blocks_.size(); }

  // Whether certificates were found often enough so far. The work depends on it, the sides do not.
  [[nodiscard]] bool are_worth_it() const { return in_vain_ <= tried_ - tried_ / 8; }

  // Sets what certificates decide of block number n; but for a few, they are asked only where they are wanted.
  [[nodiscard]] Undecided certify(std::size_t n, bool by_certificates);
  // Sets the rest.
  void finish(Undecided left) const;

  // Whether finish() needs a tree where certificates leave boxes; it is made on all threads outside loops.
  [[nodiscard]] bool may_need_tree() const { return has_rough_sums_; }
  void make_tree() const {
    if (takes_rough_sums(mesh_)) (void)mesh_.far_field();
  }
  // Whether certificates will leave most to rough sums.
  [[nodiscard]] bool expects_rough_sums() const { return has_rough_sums_ && is_boundary_all_over(mesh_); }

 private:
  [[nodiscard]] std::size_t few() const { return has_rough_sums_ ? kFewForRoughSums : kFew; }
  void look_at(CutBlock block, std::vector<SmoothBlock>& smooth_blocks, std::vector<CutBlock>& parts,
               std::vector<SampleBox>& left) const;
  void find_certificates(CutBlock whole, Undecided& left) const;
  void divide(CutBlock block, std::vector<CutBlock>& parts, std::vector<SampleBox>& left) const;
  [[nodiscard]] SmoothBlock smooth_block_of(CutBlock block, const Box& box) const;
  void evaluate(std::span<SmoothBlock> smooth_blocks) const;
  [[nodiscard]] bool decide(const SmoothBlock& smooth) const;
  [[nodiscard]] bool choose_nodes(SmoothBlock& smooth) const;
  void interpolate(const SmoothBlock& smooth, std::vector<SampleBox>& undecided) const;
  void interpolate(const SmoothBlock& smooth, const SampleBox& part, double needed, LayerValues& layer,
                   std::vector<SampleBox>& undecided) const;

  const SideSamples& samples_;
  const LatticeRows& rows_;
  const ScaledMesh& mesh_;
  const ChangeBound& changes_;
  const MatrixKernel matrices_;
  const bool has_rough_sums_;
  const CutBlocks blocks_;
  std::atomic<std::size_t> tried_ = 0, in_vain_ = 0;  // samples
};

Undecided RuleBlocks::certify(std::size_t n, bool by_certificates) {
  constexpr std::size_t kFewBlocks = 64;
  CutBlock block = blocks_[n];
  Undecided left;
  left.samples = block.samples.size();
  if (!by_certificates && n % kFewBlocks != 0) {
    left.boxes.push_back(block.samples);
    left.is_all = true;
    return left;
  }
  find_certificates(std::move(block), left);
  tried_ += left.samples;
  for (const std::vector<SampleBox>* boxes : {&left.boxes, &left.runs}) {
    for (const SampleBox& box : *boxes) in_vain_ += box.size();
  }
  return left;
}

void RuleBlocks::finish(Undecided left) const {
  if (!left.boxes.empty() && takes_rough_sums(mesh_)) {
    set_sides_roughly(samples_, left.boxes, left.runs);
  } else if (left.is_all) {
    samples_.evaluate_rows(left.boxes.front());
  } else {
    left.runs.insert(left.runs.end(), left.boxes.begin(), left.boxes.end());
  }
  samples_.evaluate_each(left.runs);
}

// Sets what is certain.
void RuleBlocks::find_certificates(CutBlock whole, Undecided& left) const {
  std::vector<CutBlock> blocks{std::move(whole)};
  while (!blocks.empty()) {
    std::vector<SmoothBlock> smooth_blocks, interpolated;
    std::vector<CutBlock> parts;
    for (CutBlock& block : blocks) look_at(std::move(block), smooth_blocks, parts, left.boxes);
    evaluate(smooth_blocks);
    for (SmoothBlock& smooth : smooth_blocks) {
      if (decide(smooth)) continue;
      if (choose_nodes(smooth)) {
        interpolated.push_back(std::move(smooth));
      } else {
        divide(std::move(smooth.block), parts, left.boxes);
      }
    }
    evaluate(interpolated);
    for (const SmoothBlock& smooth : interpolated) interpolate(smooth, left.runs);
    blocks = std::move(parts);
  }
}

// Makes it a smooth block, or divides it, or gives it up.
void RuleBlocks::look_at(CutBlock block, std::vector<SmoothBlock>& smooth_blocks, std::vector<CutBlock>& parts,
                         std::vector<SampleBox>& left) const {
  const Box box = rows_.box_of(block.samples);
  blocks_.forget_others(block, box);
  if (!block.is_cut()) {
    SmoothBlock smooth = smooth_block_of(std::move(block), box);
    if (smooth.change <= kMostChange) return smooth_blocks.push_back(std::move(smooth));
    block = std::move(smooth.block);
  }
  divide(std::move(block), parts, left);
}

void RuleBlocks::divide(CutBlock block, std::vector<CutBlock>& parts, std::vector<SampleBox>& left) const {
  if (block.samples.size() <= few()) return left.push_back(block.samples);
  blocks_.divide(std::move(block), parts);
}

SmoothBlock RuleBlocks::smooth_block_of(CutBlock block, const Box& box) const {
  const auto [middle, radius] = middle_of(rows_, block.samples, box);
  const double gradient = changes_.gradient_in(box, kMostChange / radius);
  const Crossings which = block.caps.empty() ? Crossings::kClosed : Crossings::kMesh;
  return {std::move(block), which, gradient, radius * gradient * (1 + kSumsRound), {middle}};
}

// Sets their rests, those of neighbours in space together: they take much the same way through the far field.
void RuleBlocks::evaluate(std::span<SmoothBlock> smooth_blocks) const {
  struct Place {
    std::uint64_t code;
    SmoothBlock* smooth;
    std::size_t sample;
  };
  std::vector<Place> places;
  for (SmoothBlock& smooth : smooth_blocks) {
    smooth.rest.resize(smooth.samples.size());
    for (std::size_t n = 0; n < smooth.samples.size(); ++n) {
      places.push_back({SideSamples::code_of(smooth.samples[n]), &smooth, n});
    }
  }
  std::ranges::sort(places, {}, &Place::code);
  auto set = [&](std::size_t index, const Vec3&, double w) {
    const auto [code, smooth, n] = places[index];
    smooth->rest[n] = w - samples_.crossings_at(smooth->samples[n], smooth->which);
    smooth->largest = std::max(smooth->largest, std::abs(w));
  };
  using Tile = LatticeTile<decltype(set)>;
  Tile tile(mesh_, set, Tile::Sum::kUnsettled);
  for (std::size_t index = 0; index < places.size(); ++index) {
    samples_.add(tile, index, places[index].smooth->samples[places[index].sample]);
  }
  tile.evaluate();
}

bool RuleBlocks::decide(const SmoothBlock& smooth) const {
  const double rest = smooth.rest[0];
  return samples_.decide(smooth.block.samples, smooth.which, rest,
                         smooth.change + mesh_.doubt() + kSumsRound * (1 + std::abs(rest) + smooth.largest));
}

// Makes nodes the block's samples. Returns whether that is worth it.
bool RuleBlocks::choose_nodes(SmoothBlock& smooth) const {
  const SampleBox& box = smooth.block.samples;
  const ChangeSums derivatives = changes_.derivatives_in(rows_.box_of(box));
  smooth.nodes = raycone::choose_nodes(rows_, box, derivatives, smooth.change);
  if (!smooth.nodes) return false;
  smooth.samples = smooth.nodes->nodes();
  return true;
}

// Sets the sides that are certain by interpolation between the nodes. Adds the other samples, in runs.
void RuleBlocks::interpolate(const SmoothBlock& smooth, std::vector<SampleBox>& undecided) const {
  constexpr std::array<std::size_t, 3> kPart{24, 12, 12};  // samples
  const SampleBox& box = smooth.block.samples;
  double largest = smooth.largest;
  for (const double rest : smooth.rest) largest = std::max(largest, std::abs(rest));
  // Interpolation rounds some 30 times, relative to growth() times the largest value: growth() is far below 8000.
  const double doubt = mesh_.doubt() + 32 * kSumsRound * (1 + largest);
  const double needed = smooth.nodes->bend() + smooth.nodes->growth() * doubt;
  LayerValues layer;
  SampleBox part{};
  for (std::size_t k = box.begin[2]; k < box.end[2]; k = part.end[2]) {
    for (std::size_t j = box.begin[1]; j < box.end[1]; j = part.end[1]) {
      for (std::size_t i = box.begin[0]; i < box.end[0]; i = part.end[0]) {
        part.begin = {i, j, k};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          part.end[axis] = std::min(part.begin[axis] + kPart[axis], box.end[axis]);
        }
        interpolate(smooth, part, needed, layer, undecided);
      }
    }
  }
}

// Of a part of the block: from the sample in its middle alone, where the part is decided by that.
void RuleBlocks::interpolate(const SmoothBlock& smooth, const SampleBox& part, double needed, LayerValues& layer,
                             std::vector<SampleBox>& undecided) const {
  const NodeGrid& nodes = *smooth.nodes;
  const auto [middle, radius] = middle_of(rows_, part, rows_.box_of(part));
  const double rest = nodes.at(smooth.rest, middle);
  const double change = radius * smooth.gradient * (1 + kSumsRound);
  if (samples_.decide(part, smooth.which, rest, needed + change)) return;
  for (std::size_t k = part.begin[2]; k < part.end[2]; ++k) {
    nodes.interpolate(smooth.rest, part, k, matrices_, layer);
    for (std::size_t j = 0; j < part.side(1); ++j) {
      samples_.decide_row({part.begin[0], part.begin[1] + j, k}, smooth.which,
                          std::span(layer.values).subspan(j * layer.width, part.side(0)), needed, undecided);
    }
  }
}

}  // namespace

void set_sides(const SideSamples& samples, std::atomic<std::uint64_t>* done) {
  const ScaledMesh& mesh = samples.mesh();
  assert(!mesh.is_closed() && mesh.is_in_scale());
  assert(mesh.counts_crossings() || takes_rough_sums(mesh));
  if (takes_rough_sums_alone(mesh)) return set_sides_by_rough_sums(samples, done);
  RuleBlocks blocks(samples);
  const auto finish = [&](Undecided left) {
    const std::size_t count = left.samples;
    blocks.finish(std::move(left));
    if (done) done->fetch_add(count, std::memory_order_relaxed);
  };
  // Where certificates are hardly ever found, they have to show first that they are.
  const bool in_vain = blocks.expects_rough_sums();
  // In rounds, each of which knows all of those before it, so that the work is much the same for any number of threads.
  // They stay small until one leaves something to rough sums: what it leaves waits for their tree.
  constexpr std::size_t kFirstRound = 64;
  if (in_vain) blocks.make_tree();
  bool is_ready = in_vain || !blocks.may_need_tree();
  for (std::size_t first = 0, count = kFirstRound; first < blocks.size();
       first += count, count = is_ready ? first : count) {
    count = std::min(count, blocks.size() - first);
    const bool by_certificates = first == 0 ? !in_vain : blocks.are_worth_it();
    if (is_ready) {
      parallel_for_each(count, [&](std::size_t n) { finish(blocks.certify(first + n, by_certificates)); });
      continue;
    }
    std::vector<Undecided> left(count);
    parallel_for_each(count, [&](std::size_t n) { left[n] = blocks.certify(first + n, by_certificates); });
    is_ready = std::ranges::any_of(left, [](const Undecided& u) { return !u.boxes.empty(); });
    if (is_ready) blocks.make_tree();
    parallel_for_each(count, [&](std::size_t n) { finish(std::move(left[n])); });
  }
}

}  // namespace raycone
