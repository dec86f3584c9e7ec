// `--half`, `--grid-name`, `--format vti` and `--depfile`. Black box: the real executable.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

#include "app/report/depfile.h"
#include "io/files/file_error.h"
#include "tests/app/meshes.h"
#include "tests/support/output_checks.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/vdb_files.h"

namespace raycone::test {
namespace {

// All voxels of the lattice that a grid was written on.
std::vector<VoxelIndex> voxels_of(const VdbGrid& grid) {
  const std::array<int, 3> first = grid.index("raycone_index_min"), last = grid.index("raycone_index_max");
  std::vector<VoxelIndex> voxels;
  for (int x = first[0]; x <= last[0]; ++x) {
    for (int y = first[1]; y <= last[1]; ++y) {
      for (int z = first[2]; z <= last[2]; ++z) voxels.push_back({x, y, z});
    }
  }
  return voxels;
}

class GridOptions : public testing::Test {
 protected:
  GridOptions() { write_text(mesh_, triangle_soup(20)); }

  CommandResult lattice(const std::string& output, const std::vector<std::string>& more) const {
    return run_raycone(with_more({"lattice", mesh_, "-o", output, "--quiet", "--resolution", "16"}, more));
  }
  VdbGridPtr written(const std::string& name, const std::vector<std::string>& options) const {
    const CommandResult result = lattice(dir_ / "out.vdb", options);
    EXPECT_EQ(result.status, 0) << result.err;
    return read_vdb_grid(dir_ / "out.vdb", name);
  }

  TemporaryDirectory dir_;
  std::string mesh_ = dir_ / "mesh.obj";
};

using Depfile = GridOptions;
using SideFiles = GridOptions;

TEST_F(GridOptions, HalfStoresValuesIn16Bits) {
  const auto half = written("winding", {"--half", "--diagnostics"});
  EXPECT_TRUE(half->saves_as_half());
  const auto full = written("winding", {});
  const auto bound = written("error_bound", {"--half", "--diagnostics"});
  EXPECT_FALSE(bound->saves_as_half()) << "rounded to 16 bits it would be no bound, but 0";
  int differ = 0;
  std::uint64_t active = 0;
  for (const VoxelIndex& at : voxels_of(*full)) {
    if (!full->is_active(at)) continue;
    const double value = full->value(at), stored = half->value(at);
    // Half a unit in the last of 11 places; below 2^-14, of the smallest number.
    EXPECT_NEAR(stored, value, std::max(std::abs(value) * 0x1p-11, 0x1p-25));
    differ += stored != value;
    EXPECT_EQ(half->is_active(at), stored != 0);
    ++active;
  }
  EXPECT_EQ(active, full->active_voxel_count());
  EXPECT_GT(differ, 100);
}

TEST_F(GridOptions, LevelSetsInHalfArePerfectToo) {
  for (const char* const scale : {"1", "0.77", "3.3", "1000"}) {  // the band rounds up or down to 11 bits
    const auto grid = written("surface", {"--half", "--field", "sdf", "--scale", scale});
    EXPECT_EQ(grid->level_set_faults(8), "") << scale;
  }
  const CommandResult small = lattice(dir_ / "out.vdb", {"--half", "--field", "sdf", "--scale", "5e-4"});
  EXPECT_EQ(small.status, 3);
  EXPECT_NE(small.err.find("are not in the range 6.2e-5 to 65504 of --half; scale the mesh"), std::string::npos)
      << small.err;
}

TEST_F(GridOptions, GridNameRenamesTheOnlyField) {
  const auto grid = written("density of pig", {"--grid-name", "density of pig", "--diagnostics"});
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->text("raycone_field"), "winding");
  EXPECT_TRUE(written("crossings", {"--grid-name", "x", "--diagnostics"}));
}

TEST_F(GridOptions, RefuseWhatHasNoGridsOrSeveral) {
  EXPECT_EQ(lattice("-", {"--half"}).err, "raycone: --half: is for grids, expected the format vdb\n");
  EXPECT_EQ(lattice("x.npy", {"--grid-name", "a"}).err,
            "raycone: --grid-name: is for grids, expected the format vdb\n");
  EXPECT_EQ(lattice("x.vdb", {"--half", "--double"}).err, "raycone: --half: cannot be combined with --double\n");
  EXPECT_EQ(lattice("x.vdb", {"--grid-name", "a", "--field", "winding,inside"}).err,
            "raycone: --grid-name a: names a single grid, expected one field\n");
  EXPECT_EQ(lattice("x.vdb", {"--grid-name", "crossings", "--diagnostics"}).err,
            "raycone: --grid-name crossings: expected another name than the diagnostics'\n");
}

TEST_F(GridOptions, VtiIsTheSameWhereverItGoes) {
  const std::vector<std::string> options{"--field", "winding,inside,sdf", "--diagnostics"};
  ASSERT_EQ(lattice(dir_ / "out.VTI", options).status, 0);
  std::vector<std::string> to_pipe = options;
  to_pipe.insert(to_pipe.end(), {"--format", "vti", "--threads", "3"});
  EXPECT_EQ(lattice("-", to_pipe).out, read_text(dir_ / "out.VTI"));
}

TEST_F(Depfile, ListsEveryFileThatWasRead) {
  const std::string depfile = dir_ / "out.d";
  EXPECT_EQ(lattice(dir_ / "out.vdb", {"--depfile", depfile}).status, 0);
  EXPECT_EQ(read_text(depfile), dir_ / "out.vdb" + ": \\\n  " + mesh_ + "\n");
  ASSERT_EQ(
      run_raycone({"lattice", mesh_, "-o", dir_ / "b.csv", "--like", dir_ / "out.vdb", "--depfile", depfile}).status,
      0);
  EXPECT_EQ(read_text(depfile), dir_ / "b.csv" + ": \\\n  " + mesh_ + " \\\n  " + (dir_ / "out.vdb") + "\n");
  write_text(dir_ / "points.txt", "0 0 0\n");
  ASSERT_EQ(run_raycone({"points", mesh_, dir_ / "points.txt", "-o", dir_ / "c.csv", "--depfile", depfile}).status, 0);
  EXPECT_EQ(read_text(depfile), dir_ / "c.csv" + ": \\\n  " + mesh_ + " \\\n  " + (dir_ / "points.txt") + "\n");
}

TEST_F(Depfile, FailsWithoutATrace) {
  EXPECT_EQ(lattice(dir_ / "out.vdb", {"--depfile", dir_ / "out.vdb"}).status, 1);
  EXPECT_EQ(lattice(dir_ / "out.csv", {"--depfile", mesh_}).status, 1) << "an input";
  EXPECT_EQ(run_raycone({"lattice", dir_ / "absent.obj", "-o", dir_ / "x.csv", "--depfile", dir_ / "x.d"}).status, 2);
  EXPECT_FALSE(std::filesystem::exists(dir_ / "x.d"));
}

// A file that is not there is told of when it is read.
TEST_F(Depfile, RefusesNamesBeforeAnyFileIsRead) {
  const std::string bad = dir_ / "lr=0.1";
  const std::string absent = dir_ / "absent";
  const std::string list = dir_ / "list";
  write_text(list, bad + "\n");
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"points", absent, bad},
                                             {"lattice", absent, "--like", bad},
                                             {"lattice", absent, bad, "--field", "label"},
                                             {"lattice", absent, "@" + list, "--field", "label"},
                                             {"surface", absent, "--like", bad, "--format", "ply"}}) {
    std::vector<std::string> more = words;
    more.insert(more.end(), {"-o", dir_ / "out.csv", "--depfile", dir_ / "out.d"});
    const CommandResult result = run_raycone(more);
    EXPECT_EQ(result.status, 3) << result.err;
    EXPECT_NE(result.err.find("lr=0.1: Make cannot read names with '='"), std::string::npos) << result.err;
  }
  EXPECT_EQ(lattice(dir_ / "50%.csv", {"--depfile", dir_ / "out.d"}).status, 3);
}

// Whatever a run writes beside its output appears with it, or neither does.
TEST_F(SideFiles, NothingAppearsWhereOneCannotBeWritten) {
  const std::vector<std::vector<std::string>> runs{
      {"lattice", mesh_, "-o", dir_ / "out.npy", "--resolution", "8", "--report"},
      {"lattice", mesh_, "-o", dir_ / "out.vdb", "--resolution", "8", "--report", dir_ / "out.json", "--depfile"},
      {"points", mesh_, "--sample", "uniform=10", "-o", dir_ / "out.npz", "--report"},
      {"slice", mesh_, "-o", dir_ / "out.png", "--size", "16", "--values"},
      {"slice", mesh_, "-o", dir_ / "out.png", "--size", "16", "--values", dir_ / "out.npy", "--report"},
      {"surface", mesh_, "-o", dir_ / "out.stl", "--thicken", "0.1", "--resolution", "16", "--depfile"},
  };
  for (std::vector<std::string> words : runs) {
    words.emplace_back("/dev/full");
    const CommandResult result = run_raycone(words);
    EXPECT_EQ(result.status, 3) << words.front() << result.err;
    EXPECT_EQ(result.err, "raycone: /dev/full: cannot write: No space left on device\n") << words.front();
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(dir_.path()), {}), 1) << words.front();
    words.back() = dir_ / "last";
    EXPECT_EQ(run_raycone(words).status, 0) << words.front();
    EXPECT_GE(std::distance(std::filesystem::directory_iterator(dir_.path()), {}), 3) << words.front();
    for (const std::string name : {"out.npy", "out.vdb", "out.npz", "out.png", "out.stl", "out.json", "last"}) {
      std::filesystem::remove(dir_ / name);
    }
  }
}

TEST_F(SideFiles, MarkedMeshAppearsOnlyIfTheRestIsTold) {
  const std::vector<std::string> words{"info", mesh_, "--mark", dir_ / "marked.ply"};
  EXPECT_EQ(run_raycone(words, {.output_file = "/dev/full"}).status, 3);
  EXPECT_FALSE(std::filesystem::exists(dir_ / "marked.ply"));
  EXPECT_EQ(run_raycone(words).status, 0);
  EXPECT_TRUE(std::filesystem::exists(dir_ / "marked.ply"));
}

TEST(DepfileText, EscapesWhatMakeWouldMisread) {
  EXPECT_EQ(depfile_text("a b.vdb", {"$x.obj", "c#d.bin", "e\\ f", "g\\h"}),
            "a\\ b.vdb: \\\n  $$x.obj \\\n  c\\#d.bin \\\n  e\\\\\\ f \\\n  g\\h\n");
}

// Make's opinion of a rule: 0, up to date, or 1.
int asked_of_make(const TemporaryDirectory& directory, const std::string& rule) {
  write_text(directory / "rule.mk", rule + "\t@true\n");
  return Command({"/usr/bin/make", "--question", "--directory", directory.path().string(), "--file=rule.mk"})
      .wait()
      .status;
}

TEST(DepfileText, ReadsBackInMake) {
  if (!std::filesystem::exists("/usr/bin/make")) GTEST_SKIP() << "no GNU Make";
  const TemporaryDirectory directory;
  const auto touch = [&](const std::string& name, int seconds) {
    write_text(directory / name, "");
    std::filesystem::last_write_time(directory / name, std::filesystem::file_time_type(std::chrono::seconds(seconds)));
  };
  for (const std::string name :
       {"a b", "a:b", "a#b", "$a", "a\\ b", "a\\b", "50%", "(a)", "{a,b}", "a'b", "a\"b", "a&b", "é"}) {
    if (name != "50%") {  // which no output may have
      touch(name, 1000);
      touch("input", 999);
      EXPECT_EQ(asked_of_make(directory, depfile_text(name, {"input"})), 0) << name;
      touch("input", 1001);
      EXPECT_EQ(asked_of_make(directory, depfile_text(name, {"input"})), 1) << name;
    }
    touch("out", 1000);
    touch(name, 999);
    EXPECT_EQ(asked_of_make(directory, depfile_text("out", {name})), 0) << name;
    touch(name, 1001);
    EXPECT_EQ(asked_of_make(directory, depfile_text("out", {name})), 1) << name;
  }
}

TEST(DepfileText, RefusesWhatMakeCannotRead) {
  for (const std::string name :
       {"a;b", "a|b", "a=b", "a\nb", "a*", "a?", "c[1]", "~root", ".//~root", "a\\", "a(b)", "a\tb", "\ra", "a "}) {
    EXPECT_THROW((void)depfile_text(name, {"mesh"}), OutputError) << name;
    EXPECT_THROW((void)depfile_text("out", {name}), OutputError) << name;
  }
  EXPECT_THROW((void)depfile_text("50%.csv", {"mesh"}), OutputError) << "a rule for patterns";
  EXPECT_THROW((void)depfile_text("a&", {"mesh"}), OutputError) << "a rule for several targets";
  EXPECT_EQ(depfile_text("out", {"50%.obj"}), "out: \\\n  50%.obj\n");
}

TEST(DepfileText, LeavesOutStandardInputAndRepetitions) {
  EXPECT_EQ(depfile_text("out", {"-", "mesh", "mesh"}), "out: \\\n  mesh\n");
  EXPECT_EQ(depfile_text("-", {"mesh"}), "");
}

}  // namespace
}  // namespace raycone::test
