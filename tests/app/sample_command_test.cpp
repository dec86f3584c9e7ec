// `raycone points --sample`. Black box: the real executable.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "tests/app/csv_numbers.h"
#include "tests/app/meshes.h"
#include "tests/support/output_checks.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_directory.h"

namespace raycone::test {
namespace {

class SampleOption : public testing::Test {
 protected:
  SampleOption() { write_text(mesh_, kCube); }

  CommandResult sample(const std::vector<std::string>& more) const {
    return run_raycone(with_more({"points", mesh_, "--quiet", "--sample"}, more));
  }
  std::string npz(const std::vector<std::string>& more) const {
    EXPECT_EQ(sample(with_more({"uniform=500,near=500:0.01", "-o", dir_ / "out.npz"}, more)).status, 0);
    return read_text(dir_ / "out.npz");
  }

  TemporaryDirectory dir_;
  std::string mesh_ = dir_ / "mesh.obj";
};

TEST_F(SampleOption, WritesWhatNetworksAreTrainedOn) {
  if (!python_has("numpy")) GTEST_SKIP() << "no numpy in /usr/bin/python3";
  npz({});
  EXPECT_EQ(
      run_python("import numpy, sys\n"
                 "z = numpy.load(sys.argv[1])\n"
                 "assert z.files == ['points', 'w', 'inside', 'sdf', 'transform', 'raycone'], z.files\n"
                 "p, w, inside, sdf = (z[name] for name in ('points', 'w', 'inside', 'sdf'))\n"
                 "assert p.shape == (1000, 3) and p.dtype == w.dtype == sdf.dtype == float and inside.dtype == bool\n"
                 "assert (inside == (w >= 0.5)).all() and ((sdf < 0) == inside).all()\n"
                 "q = abs(p - 0.5) - 0.5\n"
                 "box = numpy.linalg.norm(q.clip(0), axis=1) + q.max(axis=1).clip(max=0)\n"
                 "assert abs(sdf - box).max() < 1e-15\n"
                 "assert (p[:500] >= 0).all() and (p[:500] < 1).all() and inside[:500].all()\n"
                 "assert 0.005 < abs(sdf[500:]).mean() < 0.03 and 150 < inside[500:].sum() < 350\n",
                 {dir_ / "out.npz"}),
      "");
}

// A square, a face that --orient auto removes since the square has it turned over, and another square beside it.
TEST_F(SampleOption, FacesAreThoseOfTheFile) {
  if (!python_has("numpy")) GTEST_SKIP() << "no numpy in /usr/bin/python3";
  std::ofstream(mesh_) << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n"
                          "f 1 2 3\nf 3 2 1\nf 1 3 4\nf 2 5 3\nf 5 6 3\n";
  const auto run = run_raycone({"points", mesh_, "--sample", "surface=200", "--orient", "auto", "--quiet", "-o",
                                dir_ / "out.npz", "--field", "winding"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run_python("import numpy, sys\n"
                       "z = numpy.load(sys.argv[1])\n"
                       "x, y, face = z['points'][:, 0], z['points'][:, 1], z['faces']\n"
                       "expected = numpy.where(x > 1, numpy.where(y < 2 - x, 3, 4), numpy.where(y > x, 2, 0))\n"
                       "face = numpy.where(face == 1, 0, face)  # of two that cancel, either may be kept\n"
                       "assert set(face) == {0, 2, 3, 4}, set(face)\n"
                       "assert (face == expected).all(), (z['points'], face)\n",
                       {dir_ / "out.npz"}),
            "");
}

TEST_F(SampleOption, SameSeedSameBytes) {
  const std::string bytes = npz({});
  EXPECT_EQ(npz({"--threads", "1"}), bytes);
  EXPECT_EQ(npz({"--threads", "5", "--seed", "1"}), bytes);
  EXPECT_NE(npz({"--seed", "2"}), bytes);
}

TEST_F(SampleOption, FieldsAndDiagnosticsAreForTheAsking) {
  const CommandResult result = sample({"uniform=2", "--field", "density", "--diagnostics"});
  EXPECT_EQ(result.out.substr(0, result.out.find('\n')), "x,y,z,density,crossings,degenerate,on_surface,error_bound");
  EXPECT_EQ(std::ranges::count(result.out, '\n'), 3);
}

// The points of a CSV are those that the same command reads.
TEST_F(SampleOption, ValuesAreThoseOfThePoints) {
  const CommandResult drawn = sample({"near=300:0.05,uniform=300", "--padding", "0.5"});
  write_text(dir_ / "points.csv", drawn.out);
  EXPECT_EQ(run_raycone({"points", mesh_, dir_ / "points.csv", "--field", "winding,inside,sdf", "--quiet"}).out,
            drawn.out);
}

TEST_F(SampleOption, TheBoxIsPaddedOrAnother) {
  const auto lies_in = [&](const std::vector<std::string>& more, double lower, double upper) {
    const CommandResult drawn = sample(with_more({"uniform=3000", "--field", "winding"}, more));
    const auto [least, most] = std::ranges::minmax(csv_numbers(drawn.out).column("x"));
    const double side = upper - lower;  // within a hundredth of the ends, but for one case in 1e13
    return lower <= least && least < lower + side / 100 && upper - side / 100 < most && most <= upper;
  };
  EXPECT_TRUE(lies_in({}, 0, 1));
  EXPECT_TRUE(lies_in({"--padding", "2"}, -2, 3));
  EXPECT_TRUE(lies_in({"--bounds", "5,0,0,6,1,1"}, 5, 6));
}

TEST_F(SampleOption, VerifiesAndReports) {
  const CommandResult result = run_raycone({"points", mesh_, "--sample", "uniform=50", "--verify", "10"});
  EXPECT_EQ(result.status, 0);
  EXPECT_NE(result.err.find(" 50 samples in "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("verified 10 samples"), std::string::npos) << result.err;
}

// No points that are infinite or no number, with values of which the same holds.
TEST_F(SampleOption, RefusesWhatDoublesCannotHold) {
  const std::string huge = dir_ / "huge.obj";
  write_text(huge, "v -1.7e308 -1.7e308 -1.7e308\nv 1.7e308 0 0\nv 0 1.7e308 1.7e308\nf 1 2 3\n");
  const std::vector<std::vector<std::string>> commands{{mesh_, "near=3:1e308"},
                                                       {mesh_, "uniform=3", "--padding", "1.7e308"},
                                                       {mesh_, "uniform=3", "--bounds", "-1.7e308,0,0,1.7e308,1,1"},
                                                       {huge, "uniform=3"},
                                                       {huge, "near=3:0.001"}};
  for (const std::vector<std::string>& command : commands) {
    std::vector<std::string> arguments{"points", command[0], "--sample"};
    arguments.insert(arguments.end(), command.begin() + 1, command.end());
    const CommandResult result = run_raycone(arguments);
    EXPECT_EQ(result.status, 4) << command[1];
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find("too large, expected points within double precision"), std::string::npos) << result.err;
  }
  const CommandResult still = run_raycone({"points", huge, "--sample", "near=3:0", "--field", "winding", "--quiet"});
  EXPECT_EQ(still.status, 0) << still.err;
  EXPECT_EQ(std::ranges::count(still.out, '\n'), 4);
  EXPECT_EQ(still.out.find_first_of("ni"), std::string::npos) << still.out;  // nan, inf
}

// The head of a longer drawing is a shorter one; a group that comes twice is drawn twice, with other numbers.
TEST_F(SampleOption, GroupsFollowEachOther) {
  const std::string twice = sample({"uniform=40,uniform=40"}).out, once = sample({"uniform=80"}).out;
  EXPECT_EQ(std::ranges::count(once, '\n'), 81);
  EXPECT_EQ(twice, once);
  const std::string head = sample({"uniform=40"}).out;
  EXPECT_EQ(once.substr(0, head.size()), head);
  EXPECT_EQ(sample({"uniform=40,near=9:0"}).out.substr(0, head.size()), head);
  EXPECT_NE(sample({"near=9:0,uniform=40"}).out.substr(0, head.size()), head);
}

TEST_F(SampleOption, SeedsAreWholeNumbersFromZero) {
  std::set<std::string> drawn;
  for (const char* const seed : {"0", "1", "2", "9223372036854775807"}) {
    const CommandResult result = sample({"uniform=3", "--seed", seed});
    EXPECT_EQ(result.status, 0) << result.err;
    drawn.insert(result.out);
  }
  EXPECT_EQ(drawn.size(), 4U);
  for (const char* const seed : {"-1", "9223372036854775808", "18446744073709551616", "1.5", "x", ""}) {
    EXPECT_EQ(sample({"uniform=3", "--seed", seed}).status, 1) << seed;
  }
}

TEST_F(SampleOption, RefusesWhatMakesNoSense) {
  for (const char* const spec : {"uniform", "uniform=0", "uniform=1.5", "near=5", "near=5:", "near=5:-1", "far=3",
                                 "uniform=1,,near=1:1", "near=1:nan"}) {
    const CommandResult result = sample({spec});
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(result.err.rfind(std::string("raycone: --sample ") + spec + ": expected uniform=N, near=N:SIGMA", 0), 0U)
        << result.err;
  }
  const CommandResult npy = sample({"uniform=5", "-o", dir_ / "out.npy"});
  EXPECT_EQ(npy.status, 1);
  EXPECT_NE(npy.err.find("npy does not hold drawn points, expected npz or csv"), std::string::npos);
  EXPECT_EQ(sample({"uniform=5", "--padding", "3v"}).status, 1);
  EXPECT_EQ(sample({"uniform=5", dir_ / "points.csv"}).status, 1);
  EXPECT_EQ(sample({"uniform=5", "--raw", "f64"}).status, 1);
  EXPECT_EQ(run_raycone({"points", mesh_, dir_ / "points.csv", "--seed", "2"}).status, 1);
  write_text(dir_ / "flat.obj", "v 0 0 0\nv 1 0 0\nf 1 2 1\n");
  const CommandResult flat = run_raycone({"points", dir_ / "flat.obj", "--sample", "near=5:0.1"});
  EXPECT_EQ(flat.status, 2);
  EXPECT_NE(flat.err.find("flat.obj: no triangle has an area"), std::string::npos) << flat.err;
}

}  // namespace
}  // namespace raycone::test
