#include "app/fields/verify.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/exact/direct_distance.h"
#include "core/exact/direct_gradient.h"
#include "core/exact/direct_sum.h"
#include "core/machine/threads.h"
#include "io/files/ascii.h"

namespace raycone {
namespace {

constexpr std::array kGradientNames{"gradient_x", "gradient_y", "gradient_z"};

// Under the name that users know.
struct NamedNumber {
  std::string name;
  double number;
};

std::vector<NamedNumber> distances_of(const DrawnSample& sample) {
  std::vector<NamedNumber> distances;
  if (sample.distance) distances.push_back({"sdf", *sample.distance});
  if (sample.solid) distances.push_back({"solid", *sample.solid});
  return distances;
}

// All of a sample, in one order.
std::vector<NamedNumber> numbers_of(const DrawnSample& sample) {
  std::vector<NamedNumber> numbers;
  if (sample.winding) numbers.push_back({"winding", *sample.winding});
  if (sample.inside) numbers.push_back({"inside", *sample.inside ? 1.0 : 0.0});
  if (sample.density) numbers.push_back({"density", *sample.density});
  for (const NamedNumber& distance : distances_of(sample)) numbers.push_back(distance);
  for (int axis = 0; sample.gradient && axis < 3; ++axis) {
    numbers.push_back({kGradientNames[static_cast<std::size_t>(axis)], (*sample.gradient)[axis]});
  }
  return numbers;
}

[[noreturn]] void fail(const std::string& name, const DrawnSample& sample, const NamedNumber& number,
                       const std::string& expected) {
  throw VerificationError(name + ": " + position_text(sample) + " has the " + number.name + " " +
                          shortest_text(number.number) + ", " + expected);
}

// --- By definition ---

Quad absolute(Quad x) { return x < 0 ? -x : x; }

// What a sample's numbers are, in 113 bits.
struct Truth {
  QuadWithin winding{};
  Quad distance = 0, solid = 0;
  DirectGradient gradient{};
};

// floor(w + 1/2)
Quad nearest_integer(Quad w) {
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
      return nearest_integer(w) != 0;
    case RuleKind::kPositive:
      return nearest_integer(w) > 0;
    case RuleKind::kOdd:
      return static_cast<std::int64_t>(nearest_integer(w)) % 2 != 0;
  }
  return false;
}

// The number where the rule changes its mind that is nearest to w.
Quad nearest_threshold(const Rule& rule, Quad w) {
  if (rule.kind == RuleKind::kThreshold) return rule.threshold;
  if (rule.kind == RuleKind::kAbs) return w < 0 ? -Quad(rule.threshold) : Quad(rule.threshold);
  return nearest_integer(w - Quad(0.5)) + Quad(0.5);
}

// Nothing where w is just so far from the threshold that its error decides whether it counts as reaching it.
std::optional<bool> rule_by_definition(const Rule& rule, const QuadWithin& w) {
  const Quad threshold = nearest_threshold(rule, w.value), distance = absolute(w.value - threshold);
  if (distance > kIndistinguishable + w.error) return rule_holds(rule, w.value);
  if (distance < kIndistinguishable - w.error) return rule_holds(rule, threshold);
  return std::nullopt;
}

void check_number(const std::string& name, const DrawnSample& sample, const NamedNumber& number, Quad expected,
                  double tolerance, double& largest) {
  const Quad difference = absolute(number.number - expected);
  if (!(difference <= tolerance)) {  // nor NaN
    fail(name, sample, number,
         "but by definition it is " + shortest_text(static_cast<double>(expected)) + ", " +
             shortest_text(static_cast<double>(difference)) + " away, expected at most " + shortest_text(tolerance));
  }
  largest = std::max(largest, static_cast<double>(difference));
}

void check_side(const std::string& name, const DrawnSample& sample, const Expectations& expectations,
                const Truth& truth) {
  const std::optional<bool> inside = rule_by_definition(expectations.rule, truth.winding);
  if (!inside) return;
  const std::string rule = "expected " + std::string(*inside ? "inside" : "outside") + " by " +
                           name_of(expectations.rule) + ": by definition the winding number is " +
                           shortest_text(static_cast<double>(truth.winding.value));
  const NamedNumber winding{"winding", *sample.winding};
  if (holds(expectations.rule, winding.number) != *inside) fail(name, sample, winding, rule);
  if (sample.inside && *sample.inside != *inside) fail(name, sample, {"inside", *sample.inside ? 1.0 : 0.0}, rule);
  for (const NamedNumber& distance : distances_of(sample)) {
    if (distance.number != 0.0 && std::signbit(distance.number) != *inside) fail(name, sample, distance, rule);
  }
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

// `truth`: the unsigned distance to `mesh`.
void check_distance(const std::string& name, const DrawnSample& sample, const NamedNumber& distance,
                    const TriangleMesh& mesh, double band_width, Quad truth, double& largest) {
  const Quad expected = std::min(truth, Quad(band_width));
  const double tolerance = distance_tolerance(mesh, sample.point, truth);
  check_number(name, sample, distance, std::signbit(distance.number) ? -expected : expected, tolerance, largest);
}

void check_distances(const std::string& name, const DrawnSample& sample, const VerifiedMeshes& meshes,
                     const Expectations& expectations, const Truth& truth, std::optional<double>& largest) {
  if ((sample.distance || sample.solid) && !largest) largest = 0.0;
  const double band = expectations.band_width;
  if (sample.distance) {
    check_distance(name, sample, {"sdf", *sample.distance}, meshes.mesh, band, truth.distance, *largest);
  }
  if (sample.solid) check_distance(name, sample, {"solid", *sample.solid}, *meshes.solid, band, truth.solid, *largest);
}

void check_gradient(const std::string& name, const DrawnSample& sample, const Truth& truth, double& largest) {
  constexpr double kRelative = 1e-11, kMost = std::numeric_limits<double>::max();
  const QuadVec3& g = truth.gradient.value;
  const std::array expected{g.x, g.y, g.z};
  const double tolerance = static_cast<double>(std::min(kRelative * truth.gradient.magnitude, Quad(kMost))) +
                           std::numeric_limits<double>::denorm_min();
  for (std::size_t axis = 0; axis < expected.size(); ++axis) {
    check_number(name, sample, {kGradientNames[axis], (*sample.gradient)[static_cast<int>(axis)]},
                 std::clamp(expected[axis], Quad(-kMost), Quad(kMost)), tolerance, largest);
  }
}

void check(const std::string& name, const DrawnSample& sample, const VerifiedMeshes& meshes,
           const Expectations& expectations, const Truth& truth, Verification& verification) {
  double& largest = verification.largest_difference;
  const Quad w = truth.winding.value;
  check_number(name, sample, {"winding", *sample.winding}, w, expectations.accuracy, largest);
  if (sample.density) {
    const Quad expected = std::clamp(w, Quad(0), Quad(1));
    check_number(name, sample, {"density", *sample.density}, expected, expectations.accuracy, largest);
  }
  if (sample.inside || sample.distance || sample.solid) check_side(name, sample, expectations, truth);
  if (sample.gradient) {
    if (!verification.largest_gradient_difference) verification.largest_gradient_difference = 0.0;
    check_gradient(name, sample, truth, *verification.largest_gradient_difference);
  }
  check_distances(name, sample, meshes, expectations, truth, verification.largest_distance_difference);
}

void check_bound(const std::string& name, const DrawnSample& sample, double bound, const Truth& truth) {
  double largest = 0.0;
  check_number(name, sample, {"winding", *sample.winding}, truth.winding.value,
               bound + static_cast<double>(2 * truth.winding.error), largest);
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

// Errors of direct sums are far smaller than this part of the accuracy, whatever the mesh.
constexpr double kResolved = 1e-3;

// --- Evaluated again ---

double cut_off(double distance, double band_width) {
  return std::abs(distance) < band_width ? distance : std::copysign(band_width, distance);
}

void check_repeated(const std::string& name, const DrawnSample& sample, const DrawnSample& repeated, double within) {
  const std::vector<NamedNumber> numbers = numbers_of(sample), again = numbers_of(repeated);
  const std::string_view winding = "winding", density = "density";
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (std::bit_cast<std::uint64_t>(numbers[i].number) == std::bit_cast<std::uint64_t>(again[i].number)) continue;
    const bool may_differ = within > 0.0 && (numbers[i].name == winding || numbers[i].name == density);
    if (may_differ && std::abs(numbers[i].number - again[i].number) <= within) continue;
    fail(name, sample, numbers[i],
         "but evaluated again " + shortest_text(again[i].number) + ", expected the same bits");
  }
}

double accuracy_of(const WindingNumberEvaluator& evaluator, const TriangleMesh& mesh, double tolerance) {
  // No mesh has more exterior edges than sides of faces, whatever the evaluator says.
  constexpr double u = 0x1p-53;
  const double most = 3 * u * static_cast<double>(mesh.triangles.size());
  const double asked = tolerance >= kLeastTolerance ? tolerance : 1e-10;
  return std::clamp(evaluator.expected_error(), asked, std::max(asked, most));
}

}  // namespace

std::optional<bool> inside_by_definition(const TriangleMesh& mesh, const Vec3& point, const Rule& rule) {
  constexpr double kAccuracy = 1e-10;
  const QuadWithin w = perturbed_direct_sum(mesh, point);
  return w.error < kResolved * kAccuracy ? rule_by_definition(rule, w) : std::nullopt;
}

Verification verify_by_definition(const std::string& name, const VerifiedMeshes& meshes,
                                  std::span<const DrawnSample> samples, const Expectations& expectations) {
  const std::vector<Truth> truths = truths_of(meshes, samples);
  Verification verification;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    if (!(truths[n].winding.error < kResolved * expectations.accuracy)) {
      ++verification.unresolved;
      continue;
    }
    if (!expectations.error_bounds.empty()) check_bound(name, samples[n], expectations.error_bounds[n], truths[n]);
    check(name, samples[n], meshes, expectations, truths[n], verification);
    ++verification.samples;
  }
  return verification;
}

Verification verify(const std::string& name, const VerifiedMeshes& meshes, const FieldEvaluator& evaluator,
                    const FieldOptions& options, double band_width, std::span<const DrawnSample> samples,
                    double within) {
  std::vector<Vec3> points;
  for (const DrawnSample& sample : samples) points.push_back(sample.point);
  FieldOptions with_diagnostics = options;
  with_diagnostics.diagnostics = true;
  FieldSamples repeated(with_diagnostics);
  evaluator.evaluate(points, repeated, nullptr);
  const Diagnostics& diagnostics = *repeated.diagnostics();
  std::vector<DrawnSample> complete(samples.begin(), samples.end());
  for (std::size_t n = 0; n < samples.size(); ++n) {
    DrawnSample again = drawn_sample(samples[n].number, samples[n].rank, points[n], repeated.numbers(), n);
    for (std::optional<double>* const distance : {&again.distance, &again.solid}) {
      if (*distance) *distance = cut_off(**distance, band_width);
    }
    if (!complete[n].winding) complete[n].winding = again.winding;
    check_repeated(name, complete[n], again, within);
    // The bound is of the value at the point; with the difference it holds for that of the run.
    const double difference = std::abs(*complete[n].winding - *again.winding);
    double& bound = diagnostics.error_bound[n];
    if (difference > 0.0) bound = std::nextafter(bound + difference, std::numeric_limits<double>::infinity());
  }

  const double accuracy = accuracy_of(evaluator.winding_number(), meshes.mesh, tolerance_of_evaluation(options));
  Verification verification =
      verify_by_definition(name, meshes, complete, {accuracy, options.rule, band_width, diagnostics.error_bound});
  for (std::size_t n = 0; n < samples.size(); ++n) {
    verification.on_surface += diagnostics.on_surface[n];
    verification.largest_bound = std::max(verification.largest_bound, diagnostics.error_bound[n]);
  }
  return verification;
}

}  // namespace raycone
