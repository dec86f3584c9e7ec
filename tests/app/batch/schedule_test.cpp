#include "app/batch/schedule.h"

#include <gtest/gtest.h>

#include <numeric>

namespace raycone::test {
namespace {

constexpr std::uint64_t kMega = 1'000'000;

// All that starts until nothing more may.
std::vector<Schedule::Start> starts(Schedule& schedule) {
  std::vector<Schedule::Start> all;
  while (const std::optional<Schedule::Start> start = schedule.next()) all.push_back(*start);
  return all;
}

std::vector<std::size_t> meshes_of(const std::vector<Schedule::Start>& starts) {
  std::vector<std::size_t> meshes;
  for (const Schedule::Start& start : starts) meshes.push_back(start.mesh);
  return meshes;
}

int threads_of(const std::vector<Schedule::Start>& starts) {
  return std::accumulate(starts.begin(), starts.end(), 0,
                         [](int sum, const auto& start) { return sum + start.threads; });
}

TEST(Schedule, RunsSmallMeshesSideBySide) {
  Schedule schedule(std::vector<std::uint64_t>(100, 1000), 8, 8);
  const std::vector<Schedule::Start> first = starts(schedule);
  EXPECT_EQ(meshes_of(first), (std::vector<std::size_t>{0, 1, 2, 3, 4, 5, 6, 7})) << "in their order";
  for (const Schedule::Start& start : first) EXPECT_EQ(start.threads, 1);
  schedule.finished(first[3]);
  EXPECT_EQ(meshes_of(starts(schedule)), (std::vector<std::size_t>{8}));
}

TEST(Schedule, PutsOffWhatCannotStartAndThenRunsNoMoreThanDo) {
  Schedule schedule(std::vector<std::uint64_t>(10, 1000), 8, 8);
  std::vector<Schedule::Start> running;
  for (int i = 0; i < 3; ++i) running.push_back(*schedule.next());
  schedule.put_off(*schedule.next());
  EXPECT_FALSE(schedule.next());
  schedule.finished(running[0]);
  EXPECT_EQ(meshes_of(starts(schedule)), (std::vector<std::size_t>{3})) << "the one that was put off";
  schedule.finished(running[1]);
  EXPECT_EQ(meshes_of(starts(schedule)), (std::vector<std::size_t>{4}));
}

TEST(Schedule, GivesAMeshThatOutweighsTheOthersMostThreads) {
  std::vector<std::uint64_t> sizes(20, 1000);
  sizes[13] = 300 * kMega;
  Schedule schedule(sizes, 8, 8);
  const std::vector<Schedule::Start> first = starts(schedule);
  EXPECT_EQ(first[0].mesh, 13U) << "the largest first";
  EXPECT_EQ(first[0].threads, 7);
  EXPECT_EQ(threads_of(first), 8);
}

TEST(Schedule, LeavesNoThreadIdleWhereMeshesAreFew) {
  Schedule one({kMega}, 8, 8);
  EXPECT_EQ(starts(one)[0].threads, 8);
  Schedule two({kMega, kMega}, 8, 8);
  for (const Schedule::Start& start : starts(two)) EXPECT_EQ(start.threads, 4);
  Schedule three({kMega, kMega, kMega}, 8, 8);
  EXPECT_EQ(threads_of(starts(three)), 8);
  Schedule jobs(std::vector<std::uint64_t>(100, 1000), 8, 3);
  const std::vector<Schedule::Start> first = starts(jobs);
  EXPECT_EQ(first.size(), 3U);
  EXPECT_EQ(threads_of(first), 8);
}

TEST(Schedule, NeverExceedsThreadsAndJobs) {
  std::vector<std::uint64_t> sizes;
  for (std::uint64_t i = 0; i < 200; ++i) sizes.push_back(i * i * i * 997 % (40 * kMega));
  Schedule schedule(sizes, 5, 3);
  std::vector<bool> seen(sizes.size());
  std::vector<Schedule::Start> running;
  double progress = 0.0;
  do {
    const std::vector<Schedule::Start> more = starts(schedule);
    running.insert(running.end(), more.begin(), more.end());
    ASSERT_FALSE(running.empty());
    EXPECT_LE(running.size(), 3U);
    EXPECT_LE(threads_of(running), 5);
    EXPECT_FALSE(seen[running.front().mesh]);
    seen[running.front().mesh] = true;
    schedule.finished(running.front());
    running.erase(running.begin());
    EXPECT_GT(schedule.progress(), progress);
    progress = schedule.progress();
  } while (progress < 1.0 - 1e-9);
  EXPECT_EQ(std::accumulate(seen.begin(), seen.end(), std::size_t{0}), sizes.size());
  EXPECT_FALSE(schedule.next());
}

}  // namespace
}  // namespace raycone::test
