#include "app/run/labels.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <utility>

#include "app/fields/label_check.h"
#include "app/input/mesh_warnings.h"
#include "app/process/memory_limit.h"
#include "app/process/stopwatch.h"
#include "app/samples/slabs.h"
#include "core/data/interval.h"
#include "core/data/lattice_slabs.h"

namespace raycone {
namespace {

bool any_inside(std::span<const std::uint8_t> inside) {
  return std::ranges::any_of(inside, [](std::uint8_t flag) { return flag != 0; });
}

std::span<const std::uint8_t> flags_of(const FieldSamples& samples) { return samples.numbers().inside; }

// The labels of a lattice in the making.
class LatticeLabels {
 public:
  LatticeLabels(LabelledParts& parts, const PlacedLattice& lattice, const FieldOptions& field, MeshRun& run)
      : parts_(parts),
        lattice_(lattice),
        field_(field),
        run_(run),
        volume_(lattice.grid, parts.size()),
        done_(run.start_progress(run.report.samples * parts.size())) {}

  // Gives the samples inside of `part` their label. Returns whether there are any.
  bool add(MeshToEvaluate part, std::int32_t label) {
    const LatticeBlock reach = PartEvaluator::reach(lattice_, part, field_.rule);
    *done_ += static_cast<std::uint64_t>(whole(lattice_.grid).size() - reach.size());
    if (reach.size() == 0) return false;
    const SlabKind kind{.open = !part.edges.empty(), .turned = !lattice_.along_axes()};
    const PartEvaluator evaluator = timed(run_.report.seconds.prepare, [&] {
      return PartEvaluator(std::move(part), field_, static_cast<double>(reach.size()));
    });
    const bool as_points = !world_order(lattice_).has_value();
    if (as_points) timed(run_.report.seconds.prepare, [&] { evaluator.evaluator().prepare_points(); });
    const bool found =
        timed(run_.report.seconds.evaluate, [&] { return label_inside(evaluator.evaluator(), reach, kind, label); });
    parts_.spent(evaluator.evaluator());
    return found;
  }

  // When all parts have been added.
  [[nodiscard]] LabelVolume take() { return std::move(volume_); }

 private:
  bool label_inside(const FieldEvaluator& evaluator, const LatticeBlock& reach, SlabKind kind, std::int32_t label) {
    const FieldOptions options = PartEvaluator::options_of(field_);
    const double left = static_cast<double>(run_.limits().memory()) - memory_in_use();
    FieldSamples samples(options);
    bool found = false;
    for_each_slab(reach, slab_samples(options, kind, left), [&](const LatticeBlock& slab) {
      parts_.count(evaluator.evaluate(lattice_, slab, samples, done_));
      if (!any_inside(flags_of(samples))) return;
      found = true;
      volume_.add(slab, flags_of(samples), label, parts_.priority());
    });
    return found;
  }

  LabelledParts& parts_;
  const PlacedLattice& lattice_;
  const FieldOptions& field_;
  MeshRun& run_;
  LabelVolume volume_;
  std::atomic<std::uint64_t>* done_;  // samples of parts
};

// Of many small parts, each reaches few of the points.
class PointsByX {
 public:
  // To be asked about as many intervals as there are parts.
  PointsByX(std::span<const Vec3> points, std::size_t parts)
      : points_(points), sorted_(parts > kWorthSorting), order_(points.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    if (sorted_) std::ranges::stable_sort(order_, {}, [this](std::uint32_t n) { return points_[n].x; });
  }

  // At least the points whose x lies in `interval`.
  [[nodiscard]] std::span<const std::uint32_t> between(const Interval& interval) const {
    if (!sorted_) return order_;
    const auto x = [this](std::uint32_t n) { return points_[n].x; };
    const auto begin = std::ranges::lower_bound(order_, interval.lower, {}, x);
    const auto end = std::ranges::upper_bound(order_, interval.upper, {}, x);
    return {begin, end};
  }

 private:
  static constexpr std::size_t kWorthSorting = 16;  // parts

  std::span<const Vec3> points_;
  bool sorted_;
  std::vector<std::uint32_t> order_;
};

}  // namespace

// --- Lattices -------------------------------------------------------------------------------------------------------

LabelVolume label_lattice(LabelledParts& parts, const PlacedLattice& lattice, const FieldOptions& field, MeshRun& run) {
  RunReport& report = run.report;
  LatticeLabels labels(parts, lattice, field, run);
  SampleDraw draw(field.verify);
  draw.offer(lattice, whole(lattice.grid), {});
  LabelCheck check(draw.samples(), field.rule, parts.priority());
  for (std::size_t n = 0; n < parts.size(); ++n) {
    MeshToEvaluate part = parts.next();
    if (field.verify > 0) timed(report.seconds.verify, [&] { check.add(part.mesh); });
    const bool expected = should_have_inside(bounding_box(part.mesh), lattice);
    const bool found = labels.add(std::move(part), static_cast<std::int32_t>(n + 1));
    if (expected && !found) parts.note_empty();
  }
  LabelVolume volume = labels.take();
  parts.finish(volume.counts());
  if (field.verify == 0) return volume;
  std::vector<std::int32_t> drawn;
  for (const DrawnSample& sample : check.samples()) drawn.push_back(volume.at(sample.number));
  report.add_verification(check.compare(report.mesh, drawn));
  return volume;
}

// --- Points ---------------------------------------------------------------------------------------------------------

PointLabels::PointLabels(LabelledParts& parts, const FieldOptions& field, double samples, MeshRun& run)
    : parts_(parts),
      field_(field),
      run_(run),
      inside_(PartEvaluator::options_of(field)),
      counts_(parts.size() + 1),
      draw_(field.verify) {
  for (std::size_t n = 0; n < parts.size(); ++n) {
    MeshToEvaluate part = parts.next();
    if (field.verify > 0) meshes_.push_back(part.mesh);
    timed(run.report.seconds.prepare, [&] {
      evaluators_.push_back(std::make_unique<PartEvaluator>(std::move(part), field, samples));
      evaluators_.back()->evaluator().prepare_points();
    });
  }
}

void PointLabels::evaluate(std::span<const Vec3> points, std::span<std::int32_t> labels) {
  std::ranges::fill(labels, 0);
  const bool keeps_labels = parts_.priority() == PartPriority::kFirst;
  const PointsByX by_x(points, evaluators_.size());
  std::vector<Vec3> reached;
  std::vector<std::size_t> numbers;  // of these among the points
  for (std::size_t part = 0; part < evaluators_.size(); ++part) {
    const PartEvaluator& evaluator = *evaluators_[part];
    reached.clear();
    numbers.clear();
    for (const std::uint32_t n : by_x.between(evaluator.reach_along_x())) {
      if (!evaluator.reaches(points[n]) || (keeps_labels && labels[n] != 0)) continue;
      reached.push_back(points[n]);
      numbers.push_back(n);
    }
    if (reached.empty()) continue;
    parts_.count(evaluator.evaluator().evaluate(reached, inside_, nullptr));
    const std::span<const std::uint8_t> inside = flags_of(inside_);
    for (std::size_t n = 0; n < reached.size(); ++n) {
      if (inside[n] != 0) labels[numbers[n]] = static_cast<std::int32_t>(part + 1);
    }
  }
  for (const std::int32_t label : labels) ++counts_[static_cast<std::size_t>(label)];
  SampleNumbers numbers_of_points;
  numbers_of_points.label = labels;
  draw_.offer(points, numbers_of_points);
}

void PointLabels::finish() {
  for (const std::unique_ptr<PartEvaluator>& evaluator : evaluators_) parts_.spent(evaluator->evaluator());
  parts_.finish(counts_);
  if (field_.verify == 0) return;
  timed(run_.report.seconds.verify, [&] {
    LabelCheck check(draw_.samples(), field_.rule, parts_.priority());
    for (const TriangleMesh& mesh : meshes_) check.add(mesh);
    std::vector<std::int32_t> labels;
    for (const DrawnSample& sample : check.samples()) labels.push_back(*sample.label);
    run_.report.add_verification(check.compare(run_.report.mesh, labels));
  });
}

}  // namespace raycone
