// What is built when it is first needed, needed by many threads at once, and built by threads: a thread that waits for
// its part of the building must not take a part that waits for the whole.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <new>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "core/distance/distance.h"
#include "core/evaluation/winding_number.h"
#include "core/machine/threads.h"
#include "core/mesh/weld.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

// Ends the process where a test hangs: nothing else would get its threads back.
class Watchdog {
 public:
  explicit Watchdog(std::string what)
      : thread_([this, what = std::move(what)] {
          constexpr std::chrono::minutes kPatience{4};
          std::unique_lock<std::mutex> lock(mutex_);
          if (done_.wait_for(lock, kPatience, [this] { return stopped_; })) return;
          std::fprintf(stderr, "%s hangs\n", what.c_str());
          std::_Exit(EXIT_FAILURE);
        }) {}
  ~Watchdog() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      stopped_ = true;
    }
    done_.notify_one();
    thread_.join();
  }
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable done_;
  bool stopped_ = false;
  std::thread thread_;
};

constexpr int kRepetitions = 10;  // on eight threads one of 20 to 35 hung; what made it hang is seen at once, below

// Triangles enough for many tasks of each builder.
const TriangleMesh& large_sphere() {
  static const TriangleMesh mesh = test::sphere(150);
  return mesh;
}

std::vector<Vec3> points_about(std::size_t count) {
  test::Random random(1);
  std::vector<Vec3> points(count);
  for (Vec3& p : points) p = test::uniform_point(random, {{-1.2, -1.2, -1.2}, {1.2, 1.2, 1.2}});
  return points;
}

// Waiting for a loop, its caller does nothing of another: what its own body must not enter again it would enter here.
// Bodies sleep, so that their callers do wait.
TEST(ParallelFor, WaitsWithoutTakingPartInOuterLoops) {
  const Watchdog watchdog("a loop within loops");
  std::atomic<int> entered_again{0}, helped{0};
  // Threads that end their outer loops together need not wait for each other: then once more.
  for (int repetition = 0; repetition < 50 && helped == 0; ++repetition) {
    parallel_for(64, 1, [&](std::size_t, std::size_t) {
      thread_local int depth = 0;
      if (++depth > 1) ++entered_again;
      const std::thread::id caller = std::this_thread::get_id();
      parallel_for(8, 1, [&](std::size_t, std::size_t) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        helped += std::this_thread::get_id() != caller;
      });
      --depth;
    });
  }
  EXPECT_EQ(entered_again, 0);
  EXPECT_GT(helped, 0) << "no caller had to wait: this test saw nothing";
}

TEST(ParallelFor, PassesExceptionsOnFromLoopsWithinLoops) {
  const auto fail = [] {
    parallel_for(64, 1, [](std::size_t, std::size_t) {
      parallel_for(64, 1, [](std::size_t begin, std::size_t) {
        if (begin == 40) throw std::bad_alloc();
      });
    });
  };
  for (int repetition = 0; repetition < 20; ++repetition) EXPECT_THROW(fail(), std::bad_alloc);
  EXPECT_THROW(isolated([] { throw std::range_error("of the work"); }), std::range_error);
}

TEST(NestedThreads, PointsOfANewEvaluatorFindItsGridBuilt) {
  const Watchdog watchdog("evaluating points");
  const std::vector<Vec3> points = points_about(150'000);  // of fewer, passes over the triangles would find all
  std::vector<double> values(points.size());
  for (const RayEngine engine : {RayEngine::kScan, RayEngine::kEmbree}) {
    for (int repetition = 0; repetition < kRepetitions / 2; ++repetition) {
      WindingNumberEvaluator(large_sphere(), {.ray_engine = engine}).evaluate(points, values);
    }
  }
}

// Points with coordinates that scaling would flush take another engine, which is built when the first of them comes.
TEST(NestedThreads, PointsThatCannotBeScaledFindTheirEngineBuilt) {
  const Watchdog watchdog("evaluating points with tiny coordinates");
  const TriangleMesh mesh = test::moved(large_sphere(), {1e6, 1e6, 1e6}, {0, 0, 0});
  std::vector<Vec3> points = points_about(20'000);
  for (std::size_t i = 0; i < points.size(); i += 100) points[i].x = 5e-324;
  std::vector<double> values(points.size());
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    WindingNumberEvaluator(mesh).evaluate(points, values);
  }
}

TEST(NestedThreads, DistancesOfANewEvaluatorFindItsTreeBuilt) {
  const Watchdog watchdog("evaluating distances");
  const std::vector<Vec3> points = points_about(4'000);
  std::vector<double> distances(points.size());
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    DistanceEvaluator(large_sphere()).evaluate(points, distances);
  }
}

TEST(NestedThreads, EvaluatorsServeLoopsOfTheirCaller) {
  const Watchdog watchdog("evaluators within loops");
  const std::vector<Vec3> points = points_about(100);
  std::vector<double> expected(points.size()), expected_distances(points.size());
  WindingNumberEvaluator(large_sphere()).evaluate(points, expected);
  DistanceEvaluator(large_sphere()).evaluate(points, expected_distances);
  for (const RayEngine engine : {RayEngine::kScan, RayEngine::kEmbree}) {
    for (int repetition = 0; repetition < 2; ++repetition) {
      const WindingNumberEvaluator evaluator(large_sphere(), {.ray_engine = engine});
      const DistanceEvaluator distance(large_sphere());
      std::atomic<int> wrong{0};
      parallel_for(32, 1, [&](std::size_t, std::size_t) {
        std::vector<double> values(points.size()), distances(points.size());
        evaluator.evaluate(points, values);
        distance.evaluate(points, distances);
        wrong += values != expected || distances != expected_distances;
      });
      EXPECT_EQ(wrong, 0);
    }
  }
}

TEST(NestedThreads, AnyNumberOfThreadsGivesTheSameBits) {
  const std::vector<Vec3> points = points_about(3'000);
  const TriangleMesh open = test::moved(test::open_box(), {0.7, 0.8, 0.9}, {0, 0, 0});
  std::vector<double> expected(points.size());
  WindingNumberEvaluator(open).evaluate(points, expected);
  for (const int threads : {1, 2, 3, 8, 64}) {
    const ThreadLimit limit(threads);
    std::vector<double> values(points.size());
    WindingNumberEvaluator(weld(open, {})).evaluate(points, values);
    EXPECT_EQ(values, expected) << threads;
  }
}

}  // namespace
}  // namespace raycone
