#include "core/evaluation/rough_sides.h"

#include <algorithm>
#include <cstddef>

#include "core/evaluation/rough_sums.h"

namespace raycone {
namespace {

// What each part of a sum may be off by, turns. Some dozens of parts are off by little as a rule, so that most samples
// are decided at once; where many are not, they are looked at again.
constexpr double kRoughly = 4e-3, kCloser = 1e-4;
constexpr std::size_t kMany = 32;  // samples

// In units of a triangle's solid angle at a sample: of looking at a box. Boxes are divided where that takes less.
constexpr double kLook = 1.2e4;
constexpr std::size_t kLeastSide = 8;  // samples: of the parts of boxes

struct Task {
  SampleBox box;
  double each;
};

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

class RoughSides {
 public:
  explicit RoughSides(const SideSamples& samples)
      : samples_(samples), sums_(samples.mesh().blocks().sums, samples.rows()) {}

  // Sets what can be set, or adds what is to be done in its place, to `tasks` or to `undecided`.
  void set(const Task& task, std::vector<Task>& tasks, std::vector<SampleBox>& undecided) {
    sums_.look_at(task.box, task.each);
    const auto range = sums_.range();
    if (range && samples_.decide(task.box, Crossings::kClosed, range->middle, range->off)) return;
    const std::vector<SampleBox> parts = parts_of(task.box);
    if (parts.size() > 1 && sums_.cost() > kLook * static_cast<double>(parts.size())) {
      for (const SampleBox& part : parts) tasks.push_back({part, task.each});
      return;
    }
    std::vector<SampleBox> left = undecided_of(task.box);
    std::size_t count = 0;
    for (const SampleBox& run : left) count += run.size();
    if (count >= kMany && task.each > kCloser) {
      tasks.push_back({hull_of(left), kCloser});
    } else {
      undecided.insert(undecided.end(), left.begin(), left.end());
    }
  }

 private:
  // Sets the other samples of the box.
  [[nodiscard]] std::vector<SampleBox> undecided_of(const SampleBox& box) {
    const double off = sums_.evaluate(numbers_);
    const BoxSums sums{numbers_, box};
    std::vector<SampleBox> left;
    for (std::size_t k = box.begin[2]; k < box.end[2]; ++k) {
      for (std::size_t j = box.begin[1]; j < box.end[1]; ++j) {
        samples_.decide_row({box.begin[0], j, k}, Crossings::kClosed, sums.row(j, k), off, left);
      }
    }
    return left;
  }

  const SideSamples& samples_;
  RoughSums sums_;
  std::vector<double> numbers_;
};

}  // namespace

void set_sides_roughly(const SideSamples& samples, std::span<const SampleBox> boxes,
                       std::vector<SampleBox>& undecided) {
  if (boxes.empty()) return;
  RoughSides sides(samples);
  std::vector<Task> tasks;
  for (const SampleBox& box : boxes) tasks.push_back({box, kRoughly});
  while (!tasks.empty()) {
    const Task task = tasks.back();
    tasks.pop_back();
    sides.set(task, tasks, undecided);
  }
}

}  // namespace raycone
