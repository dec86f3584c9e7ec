#include "app/fields/verify_by_definition.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/exact/direct_distance.h"
#include "core/exact/direct_gradient.h"
#include "core/exact/direct_sum.h"
#include "core/exact/quad.h"
#include "core/machine/threads.h"
#include "io/files/ascii.h"

namespace raycone {
namespace {

// Errors of direct sums are far smaller than this part of the accuracy, whatever the mesh.
constexpr double kResolved = 1e-3;

// What a sample's numbers are, in 113 bits.
struct Truth {
  QuadWithin winding{};
  Quad distance = 0, solid = 0;
  DirectGradient gradient{};
};

// floor(w + 1/2)
Quad rounded_half_up(Quad w) {
  const auto nearest = static_cast<Quad>(static_cast<std::int64_t>(w));  // towards zero
  const Quad rest = w - nearest;
  return rest >= Quad(0.5) ? nearest + 1 : rest < Quad(-0.5) ? nearest - 1 : nearest;
}

bool rule_holds(const Rule& rule, Quad w) {
  switch (rule.kind) {
    case RuleKind::kThreshold:
      return w >= rule.threshold;
    case RuleKind::kAbs:
      return absolute(w) >= rule.threshold;
    case RuleKind::kNonzero:
      return rounded_half_up(w) != 0;
    case RuleKind::kPositive:
      return rounded_half_up(w) > 0;
    case RuleKind::kOdd:
      return static_cast<std::int64_t>(rounded_half_up(w)) % 2 != 0;
  }
  return false;
}

// The number where the rule changes its mind that is nearest to w.
Quad nearest_threshold(const Rule& rule, Quad w) {
  if (rule.kind == RuleKind::kThreshold) return rule.threshold;
  if (rule.kind == RuleKind::kAbs) return w < 0 ? -Quad(rule.threshold) : Quad(rule.threshold);
  return rounded_half_up(w - Quad(0.5)) + Quad(0.5);
}

// Nothing where w is just so far from the threshold that its error decides whether it counts as reaching it, or where
// it may be an integer just below: that of a closed mesh, which is told from any threshold.
std::optional<bool> rule_by_definition(const Rule& rule, const QuadWithin& w) {
  const Quad threshold = nearest_threshold(rule, w.value), distance = absolute(w.value - threshold);
  if (distance > kIndistinguishable + w.error) return rule_holds(rule, w.value);
  const Quad integer = rounded_half_up(w.value);
  const bool may_be_integer = absolute(w.value - integer) <= w.error;
  if (may_be_integer && rule_holds(rule, integer) != rule_holds(rule, threshold)) return std::nullopt;
  if (distance < kIndistinguishable - w.error) return rule_holds(rule, threshold);
  return std::nullopt;
}

std::vector<Truth> truths_of(const VerifiedMeshes& meshes, std::span<const DrawnSample> samples) {
  std::vector<Truth> truths(samples.size());
  const TriangleMesh& mesh = meshes.mesh;
  parallel_for_each(samples.size(), [&](std::size_t n) {
    truths[n].winding = perturbed_direct_sum(mesh, samples[n].point);
    if (samples[n].distance) truths[n].distance = direct_distance(mesh, samples[n].point);
    if (samples[n].solid) truths[n].solid = direct_distance(*meshes.solid, samples[n].point);
    if (samples[n].gradient) truths[n].gradient = direct_gradient(mesh, samples[n].point);
  });
  return truths;
}

// See verify_by_definition().
double distance_tolerance(const TriangleMesh& mesh, const Vec3& q, Quad distance) {
  const Box box = bounding_box(mesh);
  double size = 0.0, largest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    size = std::max(size, box.upper[axis] / 2 - box.lower[axis] / 2);
    largest = std::max({largest, std::abs(box.upper[axis]), std::abs(box.lower[axis]), std::abs(q[axis])});
  }
  constexpr double u = 0x1p-53;
  return std::max(2e-12 * size + 1e-12 * static_cast<double>(distance), 4 * u * largest) +
         std::numeric_limits<double>::denorm_min();
}

double gradient_tolerance(const DirectGradient& gradient) {
  constexpr double kRelative = 1e-11, kMost = std::numeric_limits<double>::max();
  return static_cast<double>(std::min(kRelative * gradient.magnitude, Quad(kMost))) +
         std::numeric_limits<double>::denorm_min();
}

void note_largest(std::optional<double>& largest, double difference) {
  largest = std::max(largest.value_or(0.0), difference);
}

// The samples of one run, one after the other.
class DefinitionCheck {
 public:
  DefinitionCheck(const std::string& name, const VerifiedMeshes& meshes, const Expectations& expectations)
      : name_(name), meshes_(meshes), expectations_(expectations) {}

  // Throws VerificationError. `n`: the sample's place among all.
  void add(const DrawnSample& sample, std::size_t n, const Truth& truth) {
    if (!(truth.winding.error < kResolved * expectations_.accuracy)) {
      ++found_.unresolved;
      return;
    }
    if (!expectations_.error_bounds.empty()) check_bound(sample, expectations_.error_bounds[n], truth);
    check_winding(sample, truth);
    if (sample.inside || sample.distance || sample.solid) check_side(sample, truth);
    if (sample.gradient) check_gradient(sample, truth);
    if (sample.distance) check_distance(sample, {"sdf", *sample.distance}, meshes_.mesh, truth.distance);
    if (sample.solid) check_distance(sample, {"solid", *sample.solid}, *meshes_.solid, truth.solid);
    ++found_.samples;
  }

  [[nodiscard]] const Verification& found() const { return found_; }

 private:
  // Returns by how much they differ.
  [[nodiscard]] double compare(const DrawnSample& sample, const NamedNumber& number, Quad expected,
                               double tolerance) const {
    const Quad difference = absolute(number.number - expected);
    if (!(difference <= tolerance)) {  // nor NaN
      throw_wrong(name_, sample, number,
                  "but by definition it is " + shortest_text(static_cast<double>(expected)) + ", " +
                      shortest_text(static_cast<double>(difference)) + " away, expected at most " +
                      shortest_text(tolerance));
    }
    return static_cast<double>(difference);
  }

  void check_bound(const DrawnSample& sample, double bound, const Truth& truth) const {
    const double tolerance = bound + static_cast<double>(2 * truth.winding.error);
    static_cast<void>(compare(sample, {"winding", *sample.winding}, truth.winding.value, tolerance));
  }

  void check_winding(const DrawnSample& sample, const Truth& truth) {
    const Quad w = truth.winding.value;
    double& largest = found_.largest_difference;
    largest = std::max(largest, compare(sample, {"winding", *sample.winding}, w, expectations_.accuracy));
    if (!sample.density) return;
    const Quad density = std::clamp(w, Quad(0), Quad(1));
    largest = std::max(largest, compare(sample, {"density", *sample.density}, density, expectations_.accuracy));
  }

  void check_side(const DrawnSample& sample, const Truth& truth) const {
    const std::optional<bool> inside = rule_by_definition(expectations_.rule, truth.winding);
    if (!inside) return;
    const std::string rule = "expected " + std::string(*inside ? "inside" : "outside") + " by " +
                             name_of(expectations_.rule) + ": by definition the winding number is " +
                             shortest_text(static_cast<double>(truth.winding.value));
    const NamedNumber winding{"winding", *sample.winding};
    if (holds(expectations_.rule, winding.number) != *inside) throw_wrong(name_, sample, winding, rule);
    if (sample.inside && *sample.inside != *inside) {
      throw_wrong(name_, sample, {"inside", *sample.inside ? 1.0 : 0.0}, rule);
    }
    for (const NamedNumber& distance : distances_of(sample)) {
      if (distance.number != 0.0 && std::signbit(distance.number) != *inside) {
        throw_wrong(name_, sample, distance, rule);
      }
    }
  }

  void check_gradient(const DrawnSample& sample, const Truth& truth) {
    constexpr double kMost = std::numeric_limits<double>::max();
    const QuadVec3& g = truth.gradient.value;
    const std::array expected{g.x, g.y, g.z};
    const double tolerance = gradient_tolerance(truth.gradient);
    for (std::size_t axis = 0; axis < expected.size(); ++axis) {
      const NamedNumber component{kGradientNames[axis], (*sample.gradient)[static_cast<int>(axis)]};
      const Quad finite = std::clamp(expected[axis], Quad(-kMost), Quad(kMost));
      note_largest(found_.largest_gradient_difference, compare(sample, component, finite, tolerance));
    }
  }

  // `truth`: the unsigned distance to `mesh`.
  void check_distance(const DrawnSample& sample, const NamedNumber& distance, const TriangleMesh& mesh, Quad truth) {
    const Quad cut_off = std::min(truth, Quad(expectations_.band_width));
    const Quad expected = std::signbit(distance.number) ? -cut_off : cut_off;
    const double tolerance = distance_tolerance(mesh, sample.point, truth);
    note_largest(found_.largest_distance_difference, compare(sample, distance, expected, tolerance));
  }

  const std::string& name_;
  const VerifiedMeshes& meshes_;
  const Expectations& expectations_;
  Verification found_;
};

}  // namespace

void throw_wrong(const std::string& name, const DrawnSample& sample, const NamedNumber& number,
                 const std::string& but) {
  throw VerificationError(name + ": " + position_text(sample) + " has the " + number.name + " " +
                          shortest_text(number.number) + ", " + but);
}

std::optional<bool> inside_by_definition(const TriangleMesh& mesh, const Vec3& point, const Rule& rule) {
  constexpr double kAccuracy = 1e-10;
  const QuadWithin w = perturbed_direct_sum(mesh, point);
  return w.error < kResolved * kAccuracy ? rule_by_definition(rule, w) : std::nullopt;
}

Verification verify_by_definition(const std::string& name, const VerifiedMeshes& meshes,
                                  std::span<const DrawnSample> samples, const Expectations& expectations) {
  const std::vector<Truth> truths = truths_of(meshes, samples);
  DefinitionCheck check(name, meshes, expectations);
  for (std::size_t n = 0; n < samples.size(); ++n) check.add(samples[n], n, truths[n]);
  return check.found();
}

}  // namespace raycone
