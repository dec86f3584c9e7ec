// Control groups of made-up system directories.
#include "app/process/cgroups.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string>

#include "tests/app/meshes.h"
#include "tests/support/temporary_directory.h"

namespace raycone::test {
namespace {

// A stand-in for "/".
class Cgroups : public testing::Test {
 protected:
  void put(const std::string& path, const std::string& text) const {
    const std::filesystem::path file = dir_ / path;
    std::filesystem::create_directories(file.parent_path());
    write_text(file, text);
  }

  TemporaryDirectory dir_;
};

TEST_F(Cgroups, AbsentOnesLimitNothing) {
  EXPECT_EQ(cgroup_cpus(dir_.path()), std::nullopt);
  EXPECT_EQ(cgroup_memory(dir_.path()), std::nullopt);
}

TEST_F(Cgroups, Version2QuotaIsTheTightestOfTheAncestors) {
  put("proc/self/cgroup", "0::/user/job\n");
  put("sys/fs/cgroup/user/job/cpu.max", "max 100000\n");
  put("sys/fs/cgroup/user/cpu.max", "150000 100000\n");
  put("sys/fs/cgroup/cpu.max", "400000 100000\n");
  EXPECT_EQ(cgroup_cpus(dir_.path()), 1.5);
}

TEST_F(Cgroups, Version1QuotaMinusOneMeansNone) {
  put("proc/self/cgroup", "4:memory:/a\n2:cpu,cpuacct:/a/b\n");
  put("sys/fs/cgroup/cpu/a/b/cpu.cfs_quota_us", "-1\n");
  put("sys/fs/cgroup/cpu/a/b/cpu.cfs_period_us", "100000\n");
  EXPECT_EQ(cgroup_cpus(dir_.path()), std::nullopt);
  put("sys/fs/cgroup/cpu/a/cpu.cfs_quota_us", "200000\n");
  put("sys/fs/cgroup/cpu/a/cpu.cfs_period_us", "100000\n");
  EXPECT_EQ(cgroup_cpus(dir_.path()), 2.0);
}

TEST_F(Cgroups, PathsOfTheHostFallBackToTheMount) {
  put("proc/self/cgroup", "0::/kubepods/pod1\n");
  put("sys/fs/cgroup/cpu.max", "300000 100000\n");
  EXPECT_EQ(cgroup_cpus(dir_.path()), 3.0);
}

TEST_F(Cgroups, Version2MemoryIsTheLimitLessWhatCannotBeReclaimed) {
  put("proc/self/cgroup", "0::/job\n");
  put("sys/fs/cgroup/job/memory.max", "1000000\n");
  put("sys/fs/cgroup/job/memory.current", "700000\n");
  put("sys/fs/cgroup/job/memory.stat", "anon 100000\ninactive_file 400000\nactive_file 100000\n");
  EXPECT_EQ(cgroup_memory(dir_.path()), 800'000U);
  put("sys/fs/cgroup/job/memory.max", "max\n");
  EXPECT_EQ(cgroup_memory(dir_.path()), std::nullopt);
}

TEST_F(Cgroups, Version1MemoryWritesNoLimitAsAHugeNumber) {
  put("proc/self/cgroup", "4:memory:/job\n");
  put("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
  EXPECT_EQ(cgroup_memory(dir_.path()), std::nullopt);
  put("sys/fs/cgroup/memory/job/memory.limit_in_bytes", "5000\n");
  put("sys/fs/cgroup/memory/job/memory.usage_in_bytes", "6000\n");
  EXPECT_EQ(cgroup_memory(dir_.path()), 0U);
}

}  // namespace
}  // namespace raycone::test
