#include "app/batch/shard.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "app/command_line/parse_shard.h"
#include "app/process/usage_error.h"
#include "tests/support/environment.h"

namespace raycone::test {
namespace {

Environment array_task(const std::string& id, const std::string& least, const std::string& most,
                       const std::string& step, const std::optional<std::string>& count = std::nullopt) {
  return Environment({{"SLURM_ARRAY_TASK_ID", id},
                      {"SLURM_ARRAY_TASK_MIN", least},
                      {"SLURM_ARRAY_TASK_MAX", most},
                      {"SLURM_ARRAY_TASK_STEP", step},
                      {"SLURM_ARRAY_TASK_COUNT", count}});
}

TEST(Shard, IsReadFromText) {
  EXPECT_EQ(parse_shard("1/1").count, 1U);
  EXPECT_EQ(parse_shard("3/8").index, 3U);
  EXPECT_EQ(parse_shard("3/8").count, 8U);
  for (const char* const wrong : {"", "3", "0/8", "9/8", "-1/8", "1/0", "1/8x", "1/8/2", "a/b", "1.0/2", "/"}) {
    EXPECT_THROW((void)parse_shard(wrong), UsageError) << wrong;
  }
}

TEST(Shard, OfSlurmCountsTheTasksOfTheArray) {
  {
    const Environment environment = array_task("12", "10", "16", "2", "4");
    EXPECT_EQ(parse_shard("slurm").index, 2U);
    EXPECT_EQ(parse_shard("slurm").count, 4U);
  }
  {
    const Environment environment = array_task("0", "0", "0", "1");
    EXPECT_EQ(parse_shard("slurm").index, 1U);
    EXPECT_EQ(parse_shard("slurm").count, 1U);
  }
  {
    const Environment environment = array_task("9223372036854775807", "0", "9223372036854775807", "1");
    EXPECT_EQ(parse_shard("slurm").count, std::uint64_t{1} << 63);
    EXPECT_EQ(parse_shard("slurm").index, std::uint64_t{1} << 63);
  }
}

TEST(Shard, OfSlurmRefusesArraysWithGaps) {
  {
    const Environment environment = outside_array_jobs();
    EXPECT_THROW((void)parse_shard("slurm"), UsageError);
  }
  {
    const Environment environment = array_task("3", "1", "7", "1", "3");  // --array=1,3,7
    EXPECT_THROW((void)parse_shard("slurm"), UsageError);
  }
  {
    const Environment environment = array_task("4", "1", "7", "2");
    EXPECT_THROW((void)parse_shard("slurm"), UsageError);
  }
  {
    const Environment environment = array_task("1", "1", "8", "0");
    EXPECT_THROW((void)parse_shard("slurm"), UsageError);
  }
}

TEST(Shard, PartsAreDisjointAndCompleteAndOfSimilarWork) {
  std::vector<SizedName> all;
  for (std::uint64_t i = 0; i < 100; ++i) all.push_back({"mesh" + std::to_string(i * 37 % 100), i / 2});
  std::vector<std::size_t> together;
  std::uint64_t least = UINT64_MAX;
  std::uint64_t most = 0;
  for (std::uint64_t i = 1; i <= 7; ++i) {
    const std::vector<std::size_t> part = part_of(all, {i, 7});
    EXPECT_TRUE(std::ranges::is_sorted(part));
    std::uint64_t bytes = 0;
    for (const std::size_t mesh : part) bytes += all[mesh].size;
    least = std::min(least, bytes);
    most = std::max(most, bytes);
    together.insert(together.end(), part.begin(), part.end());
  }
  std::ranges::sort(together);
  EXPECT_EQ(together.size(), 100U);
  EXPECT_EQ(std::ranges::adjacent_find(together), together.end());
  EXPECT_LE(most - least, 49U) << "dealt out in turn by size: parts differ by no more than the largest";
}

TEST(Shard, DealsOutBySizeThenName) {
  const std::vector<SizedName> all{{"a", 1}, {"b", 5}, {"c", 5}, {"d", 9}};
  EXPECT_EQ(part_of(all, {1, 2}), (std::vector<std::size_t>{2, 3}));  // d, c
  EXPECT_EQ(part_of(all, {2, 2}), (std::vector<std::size_t>{0, 1}));  // b, a
  EXPECT_EQ(part_of(all, {5, 5}), (std::vector<std::size_t>{}));
}

}  // namespace
}  // namespace raycone::test
