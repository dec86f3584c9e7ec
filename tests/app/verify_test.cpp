#include "app/verify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "app/report.h"
#include "core/weld.h"
#include "tests/support/shapes.h"

namespace raycone::test {
namespace {

// The points of a run over `mesh` with their values, all drawn.
std::vector<DrawnSample> drawn(const TriangleMesh& mesh, const std::vector<Vec3>& points) {
  std::vector<double> values(points.size());
  WindingNumberEvaluator(mesh).evaluate(points, values);
  SampleDraw draw(points.size());
  draw.offer(points, values);
  return draw.samples();
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

std::string error_of(const TriangleMesh& mesh, const WindingNumberEvaluator& evaluator,
                     const std::vector<DrawnSample>& samples) {
  try {
    (void)verify("mesh.obj", mesh, evaluator, samples);
  } catch (const VerificationError& error) {
    return error.what();
  }
  return {};
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
  whole_run.offer(points, values);
  for (std::size_t n = 0; n < points.size(); n += 8) {
    batches.offer(std::span(points).subspan(n, 8), std::span(values).subspan(n, 8));
  }
  EXPECT_EQ(numbers_of(batches.samples()), numbers_of(whole_run.samples()));
  for (const DrawnSample& sample : batches.samples()) {
    EXPECT_EQ(sample.point, points[sample.number]);
    EXPECT_EQ(sample.value, values[sample.number]);
  }
}

TEST(SampleDraw, DependsNotOnTheSlabsOfALattice) {
  const Lattice lattice{{0.5, 1, 2}, {0.1, 0.2, 0.3}, {-3, 7, 0}, {9, 10, 11}};
  std::vector<DrawnSample> expected;
  for (const std::size_t axis : {0U, 2U}) {
    for (const std::int64_t thickness : {1, 4, 11}) {
      SampleDraw draw(50);
      for (std::int64_t done = 0; done < lattice.counts[axis]; done += thickness) {
        LatticeBlock slab = whole(lattice);
        slab.first[axis] += done;
        slab.counts[axis] = std::min(thickness, lattice.counts[axis] - done);
        std::vector<double> values;  // each is its sample's position in the file of a CSV
        for (std::int64_t k = 0; k < slab.counts[2]; ++k) {
          for (std::int64_t j = 0; j < slab.counts[1]; ++j) {
            for (std::int64_t i = 0; i < slab.counts[0]; ++i) {
              values.push_back(
                  static_cast<double>(((slab.first[2] + k) * 10 + slab.first[1] - 7 + j) * 9 + slab.first[0] + 3 + i));
            }
          }
        }
        draw.offer(lattice, slab, values);
      }
      const std::vector<DrawnSample> samples = draw.samples();
      if (expected.empty()) expected = samples;
      ASSERT_EQ(samples.size(), 50U);
      EXPECT_EQ(numbers_of(samples), numbers_of(expected)) << axis << ' ' << thickness;
      for (const DrawnSample& sample : samples) {
        EXPECT_EQ(sample.value, static_cast<double>(sample.number));
        EXPECT_EQ(sample.point.x, lattice.coordinate(0, static_cast<std::int64_t>(sample.number % 9) - 3));
      }
    }
  }
}

TEST(SampleDraw, SpreadsOverTheRun) {
  const std::vector<Vec3> points(10'000);
  const std::vector<double> values(10'000);
  SampleDraw draw(1000);
  draw.offer(points, values);
  const std::vector<std::uint64_t> numbers = numbers_of(draw.samples());
  EXPECT_EQ(std::set(numbers.begin(), numbers.end()).size(), 1000U);
  const auto first_half = std::ranges::count_if(numbers, [](std::uint64_t number) { return number < 5000; });
  EXPECT_NEAR(static_cast<double>(first_half), 500, 60);  // four standard deviations
}

TEST(SampleDraw, DrawsAllOfAShortRunAndNoneWhereNoneAreWanted) {
  const std::vector<Vec3> points(5);
  const std::vector<double> values(5);
  SampleDraw many(100), none(0);
  many.offer(points, values);
  none.offer(points, values);
  none.offer({{}, {1, 1, 1}, {}, {5, 1, 1}}, {{0, 0, 0}, {5, 1, 1}}, values);
  EXPECT_EQ(numbers_of(many.samples()), (std::vector<std::uint64_t>{0, 1, 2, 3, 4}));
  EXPECT_TRUE(none.samples().empty());
}

TEST(Verify, FindsDifferencesWithinTheBounds) {
  const TriangleMesh mesh = random_mesh(30);
  const Verification verification =
      verify("mesh.obj", mesh, WindingNumberEvaluator(mesh), drawn(mesh, random_points(200)));
  EXPECT_EQ(verification.samples, 200U);
  EXPECT_EQ(verification.on_surface + verification.unresolved, 0U);
  EXPECT_GT(verification.largest_difference, 0.0);
  EXPECT_LT(verification.largest_difference, 1e-14);  // a hundred units in the last place of 1
  EXPECT_GE(verification.largest_bound, verification.largest_difference);
}

TEST(Verify, ClosedMeshesAreOffByTheDirectSumsOwnErrorOnly) {
  const TriangleMesh mesh = sphere(6);
  const Verification verification =
      verify("mesh.obj", mesh, WindingNumberEvaluator(mesh), drawn(mesh, random_points(100)));
  EXPECT_EQ(verification.samples, 100U);
  EXPECT_LT(verification.largest_difference, 1e-29);
  EXPECT_LT(verification.largest_bound, 1e-25);
}

TEST(Verify, CountsSamplesOnTheSurfaceWithoutComparingThem) {
  const TriangleMesh mesh = open_box();
  const std::vector<Vec3> points{{0, 0.5, 0.5}, {0.5, 0.5, 0.5}, {1, 1, 1}, {0.25, 0.5, 0}};
  const Verification verification = verify("mesh.obj", mesh, WindingNumberEvaluator(mesh), drawn(mesh, points));
  EXPECT_EQ(verification.samples, 1U);
  EXPECT_EQ(verification.on_surface, 3U);
}

TEST(Verify, CountsSamplesThat113BitsCannotTellFromAnEdge) {
  const TriangleMesh mesh = open_box();
  const Verification verification =
      verify("mesh.obj", mesh, WindingNumberEvaluator(mesh), drawn(mesh, {{-1e-40, -1e-40, 0.25}, {0.5, 0.5, 0.5}}));
  EXPECT_EQ(verification.samples, 1U);
  EXPECT_EQ(verification.unresolved, 1U);
  EXPECT_LT(verification.largest_difference, 1e-15);
}

TEST(Verify, NoticesAValueThatTheEvaluatorDidNotGive) {
  const TriangleMesh mesh = random_mesh(10);
  const WindingNumberEvaluator evaluator(mesh);
  std::vector<DrawnSample> samples = drawn(mesh, random_points(50));
  ASSERT_EQ(error_of(mesh, evaluator, samples), "");
  samples[17].value = std::nextafter(samples[17].value, 2.0);  // by the last bit
  const std::string error = error_of(mesh, evaluator, samples);
  EXPECT_EQ(error.rfind("mesh.obj: sample 17 at (", 0), 0U) << error;
  EXPECT_TRUE(error.ends_with(", expected the same bits")) << error;
  samples[17].value = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(error_of(mesh, evaluator, samples), "");
}

TEST(Verify, NoticesAnEvaluatorThatIsWrong) {
  const TriangleMesh mesh = random_mesh(20);
  TriangleMesh other = mesh;
  other.vertices[4].x = std::nextafter(other.vertices[4].x, 2.0);
  EXPECT_EQ(error_of(mesh, WindingNumberEvaluator(mesh), drawn(mesh, random_points(500))), "");
  EXPECT_NE(error_of(mesh, WindingNumberEvaluator(other), drawn(other, random_points(500))), "")
      << "one vertex moved by one unit in the last place";
  other.triangles.pop_back();
  const std::vector<Vec3> centre{{0.5, 0.5, 0.5}};
  const std::string error = error_of(mesh, WindingNumberEvaluator(other), drawn(other, centre));
  EXPECT_EQ(error.rfind("mesh.obj: sample 0 at (0.5, 0.5, 0.5) has the value ", 0), 0U) << error;
  EXPECT_NE(error.find(", but the direct sum is "), std::string::npos) << error;
  EXPECT_NE(error.find(" away, beyond the error bound "), std::string::npos) << error;
}

TEST(Verify, NamesTheFirstWrongSampleWhateverTheThreads) {
  const TriangleMesh mesh = random_mesh(20);
  const TriangleMesh other = reversed(mesh);
  const std::string expected = error_of(mesh, WindingNumberEvaluator(other), drawn(other, random_points(100)));
  EXPECT_EQ(expected.rfind("mesh.obj: sample 0 at ", 0), 0U) << expected;
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
