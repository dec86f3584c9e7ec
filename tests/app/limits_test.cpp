// Threads and memory by default: control groups of made-up system directories, this machine, and what is refused.
#include <gtest/gtest.h>

#include <filesystem>

#include "app/process/cgroups.h"
#include "app/process/default_threads.h"
#include "app/process/memory_limit.h"
#include "io/files/file_error.h"
#include "io/files/readable_bytes.h"
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

TEST(Limits, OfThisMachineAreSensible) {
  EXPECT_GE(default_threads(), 1);
  EXPECT_LE(default_threads(), kMaxThreads);
  EXPECT_GT(available_memory(), 1'000'000U);
  EXPECT_GT(peak_memory(), 100'000U);
}

TEST(CheckMemory, NamesBothNumbers) {
  check_memory("a.obj", 0.0, std::uint64_t{1} << 40);
  try {
    check_memory("a.obj", 34.0 * (1 << 30), std::uint64_t{8} << 30);
    FAIL() << "no exception";
  } catch (const LimitError& error) {
    EXPECT_EQ(std::string(error.what()).rfind("a.obj: needs about 34 GB of memory, but the limit is 8 GB", 0), 0U)
        << error.what();
  }
}

TEST(ReadableBytes, UsesTheUnitsOfTheOptions) {
  EXPECT_EQ(readable_bytes(0), "0 bytes");
  EXPECT_EQ(readable_bytes(1024), "1 kB");
  EXPECT_EQ(readable_bytes(1.5 * 1024 * 1024), "1.5 MB");
  EXPECT_EQ(readable_bytes(34.0 * (1 << 30)), "34 GB");
}

}  // namespace
}  // namespace raycone::test
