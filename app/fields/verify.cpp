#include "app/fields/verify.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

#include "app/fields/fields.h"
#include "app/fields/named_numbers.h"
#include "io/files/ascii.h"

namespace raycone {
namespace {

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
    throw_wrong(name, sample, numbers[i],
                "but evaluated again " + shortest_text(again[i].number) + ", expected the same bits");
  }
}

// What sums round is no fault of theirs. Who asks is warned where it is more than expected.
double accuracy_of(const WindingNumberEvaluator& evaluator, const TriangleMesh& mesh, double tolerance) {
  const double asked = tolerance >= kLeastTolerance ? tolerance : 1e-10;
  // No mesh has more exterior edges than sides of faces, whatever the evaluator says.
  const double most = asked + 3 * kAgreeingRounding * static_cast<double>(mesh.triangles.size());
  return std::clamp(evaluator.error_of_agreeing_roundings(), asked, most);
}

FieldOptions with_diagnostics(FieldOptions options) {
  options.diagnostics = true;
  return options;
}

std::vector<Vec3> points_of(std::span<const DrawnSample> samples) {
  std::vector<Vec3> points;
  for (const DrawnSample& sample : samples) points.push_back(sample.point);
  return points;
}

// The one at place `n` of `again`, as the run would have it.
DrawnSample sample_again(const DrawnSample& sample, const FieldSamples& again, std::size_t n, double band_width) {
  DrawnSample result = drawn_sample(sample.number, sample.rank, sample.point, again.numbers(), n);
  for (std::optional<double>* const distance : {&result.distance, &result.solid}) {
    if (*distance) *distance = cut_off(**distance, band_width);
  }
  return result;
}

// A bound of a value at a point, made to hold for that of the run, too.
double bound_of_both(double bound, double difference) {
  return difference > 0.0 ? std::nextafter(bound + difference, std::numeric_limits<double>::infinity()) : bound;
}

}  // namespace

Verification verify(const std::string& name, const VerifiedMeshes& meshes, const VerifiedRun& run,
                    std::span<const DrawnSample> samples) {
  FieldSamples answers(with_diagnostics(run.options));
  run.evaluator.evaluate(points_of(samples), answers, nullptr);
  const Diagnostics& diagnostics = *answers.diagnostics();
  std::vector<DrawnSample> complete(samples.begin(), samples.end());
  std::vector<double> bounds(samples.size());
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const DrawnSample again = sample_again(samples[n], answers, n, run.band_width);
    if (!complete[n].winding) complete[n].winding = again.winding;
    check_repeated(name, complete[n], again, run.within);
    bounds[n] = bound_of_both(diagnostics.error_bound[n], std::abs(*complete[n].winding - *again.winding));
  }

  const double tolerance = tolerance_of_evaluation(run.options);
  const double accuracy = accuracy_of(run.evaluator.winding_number(), meshes.mesh, tolerance);
  Verification verification =
      verify_by_definition(name, meshes, complete, {accuracy, run.options.rule, run.band_width, bounds});
  for (std::size_t n = 0; n < samples.size(); ++n) {
    verification.on_surface += diagnostics.on_surface[n];
    verification.largest_bound = std::max(verification.largest_bound, bounds[n]);
  }
  // Nobody asked for these winding numbers, which are as rough as rules allow.
  if (run.options.rule_only()) verification.largest_difference = verification.largest_bound = 0.0;
  return verification;
}

}  // namespace raycone
