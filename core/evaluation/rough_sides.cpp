#include "core/evaluation/rough_sides.h"

#include <algorithm>
#include <cstddef>

#include "core/evaluation/rough_sums.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// What each part of a sum may be off by in the smallest boxes, turns. Some dozens of parts are off by little as a rule,
// so that most samples are decided at once; where many are not, they are looked at again.
constexpr double kRoughly = 2.5e-3, kCloser = 1e-4;
constexpr std::size_t kMany = 32;  // samples
constexpr double kFiner = 0.7;     // in boxes of twice the side: all boxes in them take over what they are off by

// In units of a triangle's solid angle at a sample: of looking at a box, and of each part of it that is not smooth in
// the box around. Boxes are divided where that takes less.
constexpr double kLook = 5e3, kListed = 10.0;
constexpr std::size_t kLeastSide = 8;  // samples: of the parts of boxes
// Samples. A lattice may have few blocks, and of these one or two may take most of the time.
constexpr std::size_t kForOneThread = std::size_t{1} << 15;

double roughness(const SampleBox& box) {
  double each = kRoughly;
  for (std::size_t size = box.size(); size > kLeastSide * kLeastSide * kLeastSide; size /= 8) each *= kFiner;
  return each;
}

// Cut near the middles of its longer sides, at multiples of the least side from its beginning. One part where it is
// small.
std::vector<SampleBox> parts_of(const SampleBox& box) {
  const std::size_t longest = std::max({box.side(0), box.side(1), box.side(2)});
  std::vector<SampleBox> parts{box};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (box.side(axis) <= kLeastSide || 2 * box.side(axis) < longest) continue;
    const std::size_t half = (box.side(axis) + 2 * kLeastSide - 1) / (2 * kLeastSide) * kLeastSide;
    const std::size_t count = parts.size();
    for (std::size_t n = 0; n < count; ++n) {
      SampleBox upper = parts[n];
      parts[n].end[axis] = upper.begin[axis] = box.begin[axis] + half;
      parts.push_back(upper);
    }
  }
  return parts;
}

SampleBox hull_of(std::span<const SampleBox> boxes) {
  SampleBox hull = boxes.front();
  for (const SampleBox& box : boxes) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      hull.begin[axis] = std::min(hull.begin[axis], box.begin[axis]);
      hull.end[axis] = std::max(hull.end[axis], box.end[axis]);
    }
  }
  return hull;
}

// The parts of boxes that are in `whole`.
std::vector<SampleBox> parts_in(const SampleBox& whole, std::span<const SampleBox> boxes) {
  std::vector<SampleBox> parts;
  for (SampleBox box : boxes) {
    bool meets = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.begin[axis] = std::max(box.begin[axis], whole.begin[axis]);
      box.end[axis] = std::min(box.end[axis], whole.end[axis]);
      meets = meets && box.begin[axis] < box.end[axis];
    }
    if (meets) parts.push_back(box);
  }
  return parts;
}

class RoughSides {
 public:
  RoughSides(const SideSamples& samples, std::vector<SampleBox>& undecided)
      : samples_(samples), sums_(samples.mesh().blocks().sums, samples.rows()), undecided_(undecided) {}

  // Of the samples of `wanted`, and maybe of others of `box`, which has them all.
  void set(const SampleBox& box, std::span<const SampleBox> wanted, const RoughBox* around) {
    const RoughBox here = sums_.look_at(box, roughness(box), around);
    if (here.is_smooth()) {
      const auto [middle, off] = RoughSums::range(here);
      if (samples_.decide(box, Crossings::kClosed, middle, off)) return;
    }
    const std::vector<SampleBox> parts = parts_of(box);
    if (box.size() <= RoughSums::kLargest && (parts.size() < 2 || !pays(here, parts.size()))) return evaluate(here);
    if (box.size() > kForOneThread) return set_by_threads(parts, wanted, here);
    for (const SampleBox& part : parts) {
      const std::vector<SampleBox> of_part = parts_in(part, wanted);
      if (!of_part.empty()) set(part, of_part, &here);
    }
  }

 private:
  // Of the parts of a box.
  void set_by_threads(std::span<const SampleBox> parts, std::span<const SampleBox> wanted, const RoughBox& box) {
    std::vector<std::vector<SampleBox>> undecided(parts.size());
    parallel_for_each(parts.size(), [&](std::size_t n) {
      const std::vector<SampleBox> of_part = parts_in(parts[n], wanted);
      if (!of_part.empty()) RoughSides(samples_, undecided[n]).set(parts[n], of_part, &box);
    });
    for (const std::vector<SampleBox>& of_part : undecided) {
      undecided_.insert(undecided_.end(), of_part.begin(), of_part.end());
    }
  }

  [[nodiscard]] static bool pays(const RoughBox& box, std::size_t parts) {
    const RoughCover& cover = box.cover;
    const auto not_smooth = static_cast<double>(cover.near.triangles.size() + cover.near.expansions.size());
    return RoughSums::cost(box) > (kLook + kListed * not_smooth) * static_cast<double>(parts);
  }

  void evaluate(const RoughBox& box) {
    const std::vector<SampleBox> left = undecided_of(box);
    std::size_t count = 0;
    for (const SampleBox& run : left) count += run.size();
    const std::vector<SampleBox> still =
        count < kMany ? left : undecided_of(sums_.look_at(hull_of(left), kCloser, nullptr));
    undecided_.insert(undecided_.end(), still.begin(), still.end());
  }

  // In runs. Sets the other samples of the box.
  [[nodiscard]] std::vector<SampleBox> undecided_of(const RoughBox& box) {
    const double off = sums_.evaluate(box, numbers_);
    const SampleBox& samples = box.samples;
    const BoxSums sums{numbers_, samples};
    std::vector<SampleBox> left;
    for (std::size_t k = samples.begin[2]; k < samples.end[2]; ++k) {
      for (std::size_t j = samples.begin[1]; j < samples.end[1]; ++j) {
        samples_.decide_row({samples.begin[0], j, k}, Crossings::kClosed, sums.row(j, k), off, left);
      }
    }
    return left;
  }

  const SideSamples& samples_;
  RoughSums sums_;
  std::vector<SampleBox>& undecided_;
  std::vector<double> numbers_;
};

}  // namespace

void set_sides_roughly(const SideSamples& samples, std::span<const SampleBox> boxes,
                       std::vector<SampleBox>& undecided) {
  if (!boxes.empty()) RoughSides(samples, undecided).set(hull_of(boxes), boxes, nullptr);
}

}  // namespace raycone
