#include "app/fields/verify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "app/process/messages.h"
#include "core/data/lattice_slabs.h"
#include "core/machine/threads.h"
#include "core/mesh/weld.h"
#include "tests/support/error_text.h"
#include "tests/support/shapes.h"

namespace raycone::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

FieldOptions all_fields(const Rule& rule = {}) {
  FieldOptions options;
  options.fields = {Field::kWinding, Field::kInside, Field::kDensity, Field::kDistance};
  options.rule = rule;
  return options;
}

// The points of a run over `mesh` with their numbers, all drawn.
std::vector<DrawnSample> drawn(const TriangleMesh& mesh, const std::vector<Vec3>& points,
                               const FieldOptions& options = all_fields()) {
  FieldSamples samples(options);
  FieldEvaluator(mesh, options).evaluate(points, samples, nullptr);
  SampleDraw draw(points.size());
  draw.offer(points, samples.numbers());
  return draw.samples();
}

Verification verified(const TriangleMesh& mesh, const std::vector<Vec3>& points,
                      const FieldOptions& options = all_fields()) {
  return verify("mesh.obj", {mesh}, {FieldEvaluator(mesh, options), options, kInfinity}, drawn(mesh, points, options));
}

std::vector<Vec3> random_points(std::size_t count) {
  Random random(1);
  std::vector<Vec3> points;
  for (std::size_t n = 0; n < count; ++n) points.push_back(uniform_point(random, {{-1, -1, -1}, {2, 2, 2}}));
  return points;
}

TriangleMesh random_mesh(int triangles) {
  Random random(2);
  return weld(soup(random, triangles), {});
}

template <class Verify>
std::string error_of(const Verify& verify_something) {
  return error_text<VerificationError>(verify_something);
}

// Of a run over `other` that is taken for one over `mesh`.
std::string error_of_run(const TriangleMesh& mesh, const TriangleMesh& other, const std::vector<Vec3>& points) {
  const FieldOptions options = all_fields();
  const FieldEvaluator evaluator(other, options);
  return error_of([&] { return verify("mesh.obj", {mesh}, {evaluator, options, kInfinity}, drawn(other, points)); });
}

std::vector<std::uint64_t> numbers_of(const std::vector<DrawnSample>& samples) {
  std::vector<std::uint64_t> numbers;
  for (const DrawnSample& sample : samples) numbers.push_back(sample.number);
  return numbers;
}

TEST(SampleDraw, DependsNotOnTheBatches) {
  const std::vector<Vec3> points = random_points(1000);
  std::vector<double> values(points.size());
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = static_cast<double>(n);
  SampleDraw whole_run(20), batches(20);
  whole_run.offer(points, {values});
  for (std::size_t n = 0; n < points.size(); n += 8) {
    batches.offer(std::span(points).subspan(n, 8), {std::span<const double>(values).subspan(n, 8)});
  }
  EXPECT_EQ(numbers_of(batches.samples()), numbers_of(whole_run.samples()));
  for (const DrawnSample& sample : batches.samples()) {
    EXPECT_EQ(sample.point, points[sample.number]);
    EXPECT_EQ(sample.winding, values[sample.number]);
  }
}

TEST(SampleDraw, DependsNotOnTheSlabsOfALattice) {
  const Lattice lattice{{0.5, 1, 2}, {0.1, 0.2, 0.3}, {-3, 7, 0}, {9, 10, 11}};
  std::vector<DrawnSample> expected;
  for (const std::size_t axis : {0U, 2U}) {
    for (const std::int64_t thickness : {1, 4, 11}) {
      SampleDraw draw(50);
      for (std::int64_t done = 0; done < lattice.counts[axis]; done += thickness) {
        const LatticeBlock slab = slab_of(whole(lattice), axis, done, thickness);
        std::vector<double> values;  // each is its sample's position in the file of a CSV
        for_each_sample(slab, [&](const LatticeIndex& index) {
          values.push_back(static_cast<double>((index[2] * 10 + index[1] - 7) * 9 + index[0] + 3));
        });
        draw.offer(lattice, slab, {values});
      }
      const std::vector<DrawnSample> samples = draw.samples();
      if (expected.empty()) expected = samples;
      ASSERT_EQ(samples.size(), 50U);
      EXPECT_EQ(numbers_of(samples), numbers_of(expected)) << axis << ' ' << thickness;
      for (const DrawnSample& sample : samples) {
        EXPECT_EQ(sample.winding, static_cast<double>(sample.number));
        EXPECT_EQ(sample.point.x, lattice.coordinate(0, static_cast<std::int64_t>(sample.number % 9) - 3));
      }
    }
  }
}

TEST(SampleDraw, SpreadsOverTheRun) {
  const std::vector<Vec3> points(10'000);
  const std::vector<double> values(10'000);
  SampleDraw draw(1000);
  draw.offer(points, {values});
  const std::vector<std::uint64_t> numbers = numbers_of(draw.samples());
  EXPECT_EQ(std::set(numbers.begin(), numbers.end()).size(), 1000U);
  const auto first_half = std::ranges::count_if(numbers, [](std::uint64_t number) { return number < 5000; });
  EXPECT_NEAR(static_cast<double>(first_half), 500, 60);  // four standard deviations
}

TEST(SampleDraw, DrawsAllOfAShortRunAndNoneWhereNoneAreWanted) {
  const std::vector<Vec3> points(5);
  const std::vector<double> values(5);
  SampleDraw many(100), none(0);
  many.offer(points, {values});
  none.offer(points, {values});
  none.offer({{}, {1, 1, 1}, {}, {5, 1, 1}}, {{0, 0, 0}, {5, 1, 1}}, {values});
  EXPECT_EQ(numbers_of(many.samples()), (std::vector<std::uint64_t>{0, 1, 2, 3, 4}));
  EXPECT_TRUE(none.samples().empty());
}

TEST(Verify, FindsDifferencesWithinTheBounds) {
  const Verification verification = verified(random_mesh(30), random_points(200));
  EXPECT_EQ(verification.samples, 200U);
  EXPECT_EQ(verification.on_surface + verification.unresolved, 0U);
  EXPECT_GT(verification.largest_difference, 0.0);
  EXPECT_LT(verification.largest_difference, 1e-14);  // a hundred units in the last place of 1
  EXPECT_GE(verification.largest_bound, verification.largest_difference);
  EXPECT_LT(verification.largest_distance_difference.value(), 1e-12);
}

TEST(Verify, ClosedMeshesAreOffByTheDirectSumsOwnErrorOnly) {
  const Verification verification = verified(sphere(6), random_points(100));
  EXPECT_EQ(verification.samples, 100U);
  EXPECT_LT(verification.largest_difference, 1e-29);
  EXPECT_EQ(verification.largest_bound, 0.0);
}

TEST(Verify, LooksAtSamplesOnTheSurfaceToo) {
  const std::vector<Vec3> points{{0, 0.5, 0.5}, {0.5, 0.5, 0.5}, {1, 1, 1}, {0.25, 0.5, 0}, {0, 0, 0}, {0, 0.5, 1}};
  const Verification verification = verified(open_box(), points);
  EXPECT_EQ(verification.samples, 6U);
  EXPECT_EQ(verification.on_surface, 5U);
  EXPECT_LT(verification.largest_difference, 1e-15);
}

TEST(Verify, LooksAtSamplesAsNearAsDoublesAre) {
  const std::vector<Vec3> points{{-1e-40, -1e-40, 0.25}, {1e-300, 5e-324, 0.25}, {0.5, 0.5, -1e-32}, {0.5, 0.5, 0.5}};
  const Verification verification = verified(open_box(), points);
  EXPECT_EQ(verification.samples, 4U);
  EXPECT_EQ(verification.unresolved, 0U);
  EXPECT_LT(verification.largest_difference, 1e-15);
}

TEST(Verify, LeavesOnlyDocumentedErrorsWhateverTheRule) {
  Random random(3);
  const TriangleMesh mesh = lattice_soup(random, 12, 3);
  std::vector<Vec3> points;
  for (int n = 0; n < 216; ++n) points.push_back({n % 6 * 0.5, n / 6 % 6 * 0.5, n / 36 * 0.5});
  for (const Rule& rule : {Rule{}, Rule{RuleKind::kThreshold, 0.25}, Rule{RuleKind::kAbs, 0.125},
                           Rule{RuleKind::kThreshold, 0.0}, Rule{RuleKind::kAbs, 1.0}, Rule{RuleKind::kNonzero, 0.5},
                           Rule{RuleKind::kPositive, 0.5}, Rule{RuleKind::kOdd, 0.5}}) {
    EXPECT_EQ(verified(mesh, points, all_fields(rule)).samples, 216U) << name_of(rule);
  }
}

// 0 is told from any of these, though a sum is not.
TEST(Verify, TakesIntegersOfClosedMeshesForWhatTheyAre) {
  for (const double threshold : {5e-324, 3e-38, 3e-25, -3e-25}) {
    for (const RuleKind kind : {RuleKind::kThreshold, RuleKind::kAbs}) {
      if (kind == RuleKind::kAbs && threshold < 0) continue;
      const FieldOptions options = all_fields({kind, threshold});
      EXPECT_EQ(verified(box_mesh({0, 0, 0}, {1, 1, 1}), random_points(200), options).samples, 200U) << threshold;
    }
  }
}

TEST(Verify, NoticesAValueThatTheEvaluatorDidNotGive) {
  const TriangleMesh mesh = random_mesh(10);
  const FieldOptions options = all_fields();
  const FieldEvaluator evaluator(mesh, options);
  std::vector<DrawnSample> samples = drawn(mesh, random_points(50));
  const auto error = [&] {
    return error_of([&] { return verify("mesh.obj", {mesh}, {evaluator, options, kInfinity}, samples); });
  };
  ASSERT_EQ(error(), "");
  samples[17].winding = std::nextafter(*samples[17].winding, 2.0);  // by the last bit
  EXPECT_EQ(error().rfind("mesh.obj: sample 17 at (", 0), 0U) << error();
  EXPECT_TRUE(error().ends_with(", expected the same bits")) << error();
  samples[17].winding = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(error(), "");
}

// As those of lattices that are evaluated by blocks.
TEST(Verify, TakesWindingNumbersThatDifferWithinWhatIsAllowed) {
  const TriangleMesh mesh = random_mesh(10);
  const FieldOptions options = all_fields();
  const FieldEvaluator evaluator(mesh, options);
  const std::vector<DrawnSample> right = drawn(mesh, random_points(50));
  const auto error_with = [&](double by, double within) {
    std::vector<DrawnSample> samples = right;
    *samples[17].winding += by;
    return error_of([&] { return verify("mesh.obj", {mesh}, {evaluator, options, kInfinity, within}, samples); });
  };
  EXPECT_EQ(error_with(5e-11, 2e-10), "");
  EXPECT_TRUE(error_with(3e-10, 2e-10).ends_with(", expected the same bits"));
  EXPECT_TRUE(error_with(5e-11, 0.0).ends_with(", expected the same bits"));
}

TEST(Verify, NoticesAnEvaluatorThatIsWrong) {
  const TriangleMesh mesh = random_mesh(20);
  TriangleMesh other = mesh;
  other.vertices[4].x += 1e-8;
  EXPECT_EQ(error_of_run(mesh, mesh, random_points(100)), "");
  EXPECT_NE(error_of_run(mesh, other, random_points(100)), "");
  other.triangles.pop_back();
  const std::string error = error_of_run(mesh, other, {{0.5, 0.5, 0.5}});
  EXPECT_EQ(error.rfind("mesh.obj: sample 0 at (0.5, 0.5, 0.5) has the winding ", 0), 0U) << error;
  EXPECT_NE(error.find(", but by definition it is "), std::string::npos) << error;
}

// --- Sabotage: what --verify has to find when evaluator and bounds agree with one another ---

struct Sabotage {
  const char* name;
  void (*change)(DrawnSample& sample, double by);
};

constexpr Sabotage kNumbers[] = {
    {"winding", [](DrawnSample& s, double by) { *s.winding += by; }},
    {"density", [](DrawnSample& s, double by) { *s.density += by; }},
    {"sdf", [](DrawnSample& s, double by) { *s.distance += std::copysign(by, *s.distance); }},
};

// Off and on the surface, in the plane of the opening, on its rim and beyond.
std::vector<Vec3> telling_points() {
  std::vector<Vec3> points = random_points(20);
  for (int n = 0; n < 27; ++n) points.push_back({n % 3 * 0.5, n / 3 % 3 * 0.5, n / 9 * 0.5});
  return points;
}

TEST(Verify, NoticesNumbersThatAreOffByLittle) {
  for (const TriangleMesh& mesh : {open_box(), sphere(4), random_mesh(8)}) {
    const std::vector<DrawnSample> right = drawn(mesh, telling_points());
    ASSERT_EQ(error_of([&] { return verify_by_definition("m", {mesh}, right, {}); }), "");
    for (const Sabotage& sabotage : kNumbers) {
      for (const double by : {1.1e-10, 1e-9, 1e-6, 0.1}) {
        for (std::size_t n = 0; n < right.size(); ++n) {
          std::vector<DrawnSample> wrong{right[n]};
          sabotage.change(wrong[0], by);
          EXPECT_NE(error_of([&] { return verify_by_definition("m", {mesh}, wrong, {}); }), "")
              << sabotage.name << " by " << by << " at sample " << n;
        }
      }
    }
  }
}

TEST(Verify, NoticesSamplesOnTheWrongSide) {
  for (const TriangleMesh& mesh : {open_box(), sphere(4), random_mesh(8)}) {
    for (const Rule& rule : {Rule{}, Rule{RuleKind::kAbs, 0.25}, Rule{RuleKind::kNonzero, 0.5}}) {
      const std::vector<DrawnSample> right = drawn(mesh, telling_points(), all_fields(rule));
      for (const DrawnSample& sample : right) {
        DrawnSample wrong = sample;
        wrong.inside = !*sample.inside;
        const Expectations expectations{1e-10, rule};
        EXPECT_NE(error_of([&] { return verify_by_definition("m", {mesh}, {{wrong}}, expectations); }), "");
        if (*sample.distance == 0.0) continue;
        wrong = sample;
        wrong.distance = -*sample.distance;
        EXPECT_NE(error_of([&] { return verify_by_definition("m", {mesh}, {{wrong}}, expectations); }), "");
      }
    }
  }
}

TEST(Verify, ComparesSolidDistancesWithTheSolid) {
  FieldOptions options;
  options.fields = {Field::kWinding, Field::kSolid};
  const TriangleMesh mesh = open_box(), solid = sphere(4), other = sphere(5);
  FieldEvaluator evaluator(mesh, options);
  evaluator.set_solid(solid);
  FieldSamples samples(options);
  const std::vector<Vec3> points = telling_points();
  evaluator.evaluate(points, samples, nullptr);
  SampleDraw draw(points.size());
  draw.offer(points, samples.numbers());
  const std::vector<DrawnSample> right = draw.samples();
  const auto error_with = [&](const std::vector<DrawnSample>& found, const TriangleMesh& surface) {
    return error_of([&] { return verify("m", {mesh, &surface}, {evaluator, options, kInfinity}, found); });
  };
  EXPECT_EQ(error_with(right, solid), "");
  EXPECT_NE(error_with(right, other).find(" has the solid "), std::string::npos);
  for (const DrawnSample& sample : right) {
    if (std::abs(*sample.solid) < 1e-6) continue;  // on the sphere, with no side
    for (const double is : {-*sample.solid, *sample.solid + 1e-9}) {
      DrawnSample wrong = sample;
      wrong.solid = is;
      EXPECT_NE(error_with({wrong}, solid), "") << sample.number;
      EXPECT_NE(error_of([&] { return verify_by_definition("m", {mesh, &solid}, {{wrong}}, {}); }), "");
    }
  }
}

// A value of 1/2 that fell below by its last bit is within the accuracy, but on the wrong side.
TEST(Verify, NoticesHalvesThatAreNone) {
  const TriangleMesh mesh = open_box();
  std::vector<DrawnSample> samples = drawn(mesh, {{0.25, 0.5, 1}});
  ASSERT_EQ(samples[0].winding, 0.5);
  samples[0].winding = std::nextafter(0.5, 0.0);
  EXPECT_NE(error_of([&] { return verify_by_definition("m", {mesh}, samples, {}); }), "");
}

TEST(Verify, NamesTheFirstWrongSampleWhateverTheThreads) {
  const TriangleMesh mesh = random_mesh(20);
  const std::string expected = error_of_run(mesh, reversed(mesh), random_points(100));
  EXPECT_EQ(expected.rfind("mesh.obj: sample 0 at ", 0), 0U) << expected;
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    for (int run = 0; run < 3; ++run) {
      EXPECT_EQ(error_of_run(mesh, reversed(mesh), random_points(100)), expected) << threads;
    }
  }
}

TEST(Verify, ComparesDistancesUpToTheBandOnly) {
  const TriangleMesh mesh = sphere(5);
  FieldOptions options = all_fields();
  options.band = 2;
  const FieldEvaluator evaluator(mesh, options);
  const Lattice lattice{{0, 0, 0}, {0.25, 0.25, 0.25}, {-6, -6, -6}, {13, 13, 13}};
  FieldSamples samples(options);
  evaluator.evaluate(lattice, whole(lattice), samples, nullptr);
  SampleDraw draw(300);
  draw.offer(lattice, whole(lattice), samples.numbers());
  EXPECT_EQ(verify("m", {mesh}, {evaluator, options, 0.5}, draw.samples()).samples, 300U);
  EXPECT_NE(error_of([&] { return verify("m", {mesh}, {evaluator, options, 0.75}, draw.samples()); }), "");
}

// Of a far field: winding numbers are rough where nothing but the rule is asked for.
TEST(Verify, KnowsHowRoughWindingNumbersOfRulesAre) {
  const TriangleMesh mesh = sieve(60, 3);
  FieldOptions options;
  options.fields = {Field::kInside};
  const FieldEvaluator evaluator(mesh, options);
  FieldSamples samples(options);
  evaluator.evaluate(random_points(100'001), samples, nullptr);  // so many are summed directly
  const std::vector<Vec3> points = random_points(30);
  evaluator.evaluate(points, samples, nullptr);
  EXPECT_GT(evaluator.winding_number().terms().far, 0U);
  SampleDraw draw(points.size());
  draw.offer(points, samples.numbers());
  const Verification found = verify("m", {mesh}, {evaluator, options, kInfinity}, draw.samples());
  EXPECT_EQ(found.samples, points.size());
  EXPECT_EQ(found.largest_difference, 0.0);
  EXPECT_EQ(found.largest_bound, 0.0);
}

TEST(Verify, WrongValuesAreInternalErrorsInOneLine) {
  testing::internal::CaptureStderr();
  ExitCode code{};
  try {
    throw VerificationError("mesh.obj: sample 0 is wrong");
  } catch (...) {
    code = report_current_exception();
  }
  EXPECT_EQ(code, ExitCode::kInternal);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "raycone: internal error, please report: mesh.obj: sample 0 is wrong\n");
}

}  // namespace
}  // namespace raycone::test
