// The command line itself: options, operands, usage errors, help. Black box: the real executable.
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <string>
#include <vector>

#include "tests/app/meshes.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_directory.h"

namespace raycone::test {
namespace {

using Arguments = std::vector<std::string>;

// A directory with the cube as mesh.obj and the triangle as flat.obj.
class CommandLine : public testing::Test {
 protected:
  CommandLine() {
    write_text(mesh_, kCube);
    write_text(flat_, kTriangle);
  }

  // Runs `raycone lattice mesh.obj -o out.csv` with `more` behind it.
  CommandResult lattice(const Arguments& more) const {
    return run_raycone(with_more({"lattice", mesh_, "-o", csv_}, more));
  }

  TemporaryDirectory dir_;
  std::string mesh_ = dir_ / "mesh.obj";
  std::string flat_ = dir_ / "flat.obj";
  std::string csv_ = dir_ / "out.csv";
};

std::string first_lines(const std::string& text, int count) {
  std::size_t end = 0;
  for (int i = 0; i < count && end != std::string::npos; ++i) end = text.find('\n', end + (i > 0 ? 1 : 0));
  return text.substr(0, end);
}

// One line on standard error that begins as every message, nothing on standard output, the given status.
void expect_error(const CommandResult& result, int status, const std::string& part) {
  EXPECT_EQ(result.status, status) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err.rfind("raycone: ", 0), 0U) << result.err;
  EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
  EXPECT_TRUE(result.err.ends_with('\n')) << result.err;
  EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
}

TEST_F(CommandLine, WithoutCommandIsUsageError) { expect_error(run_raycone({}), 1, "no command given"); }

TEST_F(CommandLine, UnknownCommandListsThoseThatExist) {
  expect_error(run_raycone({"voxelise"}), 1,
               "unknown command voxelise, expected lattice, points, slice, surface, info, batch, report or help");
}

TEST_F(CommandLine, UnknownOptionIsUsageErrorOfEachCommand) {
  expect_error(run_raycone({"--foo"}), 1, "unknown option --foo");
  expect_error(lattice({"--foo"}), 1, "unknown option --foo");
  expect_error(lattice({"-x"}), 1, "unknown option -x");
  expect_error(lattice({"--res", "5"}), 1, "unknown option --res");
  expect_error(run_raycone({"points", mesh_, "p.csv", "--resolution", "5"}), 1, "unknown option --resolution");
  expect_error(run_raycone({"info", mesh_, "--output", "x"}), 1, "unknown option --output");
}

TEST_F(CommandLine, MissingAndSurplusOperandsAreUsageErrors) {
  expect_error(run_raycone({"lattice", "-o", csv_}), 1, "MESH");
  expect_error(run_raycone({"points", mesh_}), 1, "POINTS");
  expect_error(lattice({"surplus"}), 1, "unexpected operand surplus");
  expect_error(lattice({""}), 1, "unexpected operand");
  expect_error(run_raycone({"info", ""}), 1, "MESH");
}

// CLI11 would take the brackets for those of a list.
TEST_F(CommandLine, OperandsInBracketsAreNames) {
  expect_error(run_raycone({"info", "[a,b]"}), 2, "[a,b]: ");
  expect_error(run_raycone({"info", "[]"}), 2, "[]: ");
  expect_error(run_raycone({"lattice", "[v1]", "-o", csv_}), 2, "[v1]: ");
  expect_error(run_raycone({"points", mesh_, "[p]"}), 2, "[p]: ");
  expect_error(run_raycone({"batch", "[v1]", "--out-dir", dir_ / "out"}), 2, "[v1]: ");
}

TEST_F(CommandLine, LatticeNeedsAnOutput) { expect_error(run_raycone({"lattice", mesh_}), 1, "no output given"); }

TEST_F(CommandLine, OptionsStandBeforeAndAfterOperands) {
  const Arguments orders[] = {{"lattice", mesh_, "-o", "-", "--resolution", "2"},
                              {"lattice", "-o", "-", "--resolution", "2", mesh_},
                              {"lattice", "--resolution=2", mesh_, "--output=-"},
                              {"--resolution", "2", "lattice", "-o-", mesh_}};
  const std::string expected = run_raycone(orders[0]).out;
  EXPECT_EQ(std::ranges::count(expected, '\n'), 1 + 8);
  for (const Arguments& order : orders) EXPECT_EQ(run_raycone(order).out, expected);
}

TEST_F(CommandLine, ListsNeverSwallowTheOperandBehindThem) {
  const CommandResult result =
      run_raycone({"lattice", "-o", "-", "--bounds", "0,0,0,1,1,1", "--resolution", "1,2,3", mesh_});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(std::ranges::count(result.out, '\n'), 1 + 6);
}

TEST_F(CommandLine, NegativeValuesNeedNoEqualsSign) {
  const CommandResult result =
      run_raycone({"lattice", mesh_, "-o", "-", "--resolution", "2", "--bounds", "-.5,-.5,-.5,.5,.5,.5"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(first_lines(result.out, 2), "i,j,k,x,y,z,w\n0,0,0,-0.5,-0.5,-0.5,0");
  EXPECT_EQ(lattice({"--padding", "-.25"}).status, 0);
  EXPECT_EQ(lattice({"--padding", "-1v"}).status, 0);
}

TEST_F(CommandLine, OfAnOptionGivenTwiceTheLastCounts) {
  const CommandResult result = run_raycone({"lattice", mesh_, "-o", "-", "--resolution", "7", "--bounds", "0,0,0,9,9,9",
                                            "--resolution=2", "--bounds", "0,0,0,1,1,1", "--quiet", "--quiet"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(std::ranges::count(result.out, '\n'), 1 + 8);
}

TEST_F(CommandLine, FieldsAndOutputsAreGivenOnce) {
  expect_error(lattice({"-o", "-"}), 1, "--output: given twice, expected once");
  expect_error(lattice({"--field", "inside", "--field=inside"}), 1, "--field: given twice, expected once");
  expect_error(run_raycone({"slice", mesh_, "-o", csv_, "--field", "sdf", "--field", "sdf"}), 1,
               "--field: given twice, expected once");
  EXPECT_FALSE(std::filesystem::exists(csv_));
}

TEST_F(CommandLine, TwoDashesEndTheOptions) {
  expect_error(run_raycone({"lattice", "-o", csv_, "--", "--no-such-file"}), 2, "--no-such-file: ");
  expect_error(run_raycone({"lattice", "-o", csv_, "--", mesh_, "--quiet"}), 1, "unexpected operand --quiet");
}

TEST_F(CommandLine, OperandsMayBeCalledLikeCommands) {
  expect_error(run_raycone({"lattice", "info", "-o", csv_}), 2, "info: ");
}

TEST_F(CommandLine, NumbersThatOverflowAreNotFiniteOrHaveATailAreUsageErrors) {
  for (const char* const number : {"1e400", "inf", "nan", "-inf", "1x", "1 ", " 1", "0x10", "1,5", "--"}) {
    expect_error(lattice({"--scale", number}), 1, "--scale");
  }
  for (const char* const option : {"--timeout", "--memory-limit", "--weld", "--threads"}) {
    for (const char* const number : {"1e400", "nan", "1x"}) expect_error(lattice({option, number}), 1, option);
  }
  expect_error(lattice({"--bounds", "0,0,0,1,1,1e400"}), 1, "--bounds");
  expect_error(lattice({"--padding", "inf"}), 1, "--padding");
  expect_error(lattice({"--padding", "1.5v"}), 1, "--padding");
  expect_error(lattice({"--voxel-size", "nan"}), 1, "--voxel-size");
  expect_error(lattice({"--resolution", "99999999999999999999"}), 1, "--resolution");
  expect_error(lattice({"--threads", "0"}), 1, "--threads");
}

TEST_F(CommandLine, ListsOfTheWrongLengthAreUsageErrors) {
  expect_error(lattice({"--bounds", "0,0,0,1,1"}), 1, "six numbers");
  expect_error(lattice({"--resolution", "5,5"}), 1, "--resolution 5,5: expected N or NX,NY,NZ");
  expect_error(lattice({"--resolution", "5,5,"}), 1, "--resolution");
  expect_error(lattice({"--voxel-size", "1,1"}), 1, "--voxel-size");
  expect_error(run_raycone({"points", mesh_, "p.csv", "--columns", "1,2"}), 1, "three column numbers");
}

TEST_F(CommandLine, ValuesOutOfRangeAreUsageErrors) {
  expect_error(lattice({"--resolution", "0"}), 1, "--resolution 0");
  expect_error(lattice({"--resolution", "-5"}), 1, "--resolution -5");
  expect_error(lattice({"--voxel-size", "0"}), 1, "--voxel-size");
  expect_error(lattice({"--voxel-size", "1,-1,1"}), 1, "--voxel-size");
  expect_error(lattice({"--scale", "0"}), 1, "--scale");
  expect_error(lattice({"--weld", "-1"}), 1, "exact, none or a positive distance");
  expect_error(lattice({"--bounds", "0,0,0,-1,1,1"}), 1, "X0 <= X1");
  expect_error(run_raycone({"points", mesh_, "p.csv", "--columns", "0,1,2"}), 1, "--columns 0,1,2");
  expect_error(lattice({"--padding", "-.6"}), 1, "leaves nothing");
  expect_error(lattice({"--resolution", "5", "--padding", "-3v"}), 1, "leaves no sample");
}

TEST_F(CommandLine, ContradictionsAreUsageErrors) {
  expect_error(lattice({"--resolution", "5", "--voxel-size", "1"}), 1, "cannot be combined with --voxel-size");
  expect_error(lattice({"--like", "a.vdb", "--resolution", "5"}), 1, "cannot be combined");
  expect_error(lattice({"--like", "a.vdb", "--voxel-size", "1"}), 1, "cannot be combined");
  expect_error(lattice({"--like", "a.vdb", "--bounds", "0,0,0,1,1,1"}), 1, "cannot be combined");
  expect_error(lattice({"--like", "a.vdb", "--padding", "1"}), 1, "cannot be combined");
  expect_error(lattice({"--like", "a.vdb", "--centers"}), 1, "cannot be combined");
  for (const char* const mesh : {"-", "/dev/stdin", "/dev/fd/0"}) {
    for (const char* const points : {"-", "/dev/stdin", "/proc/self/fd/0"}) {
      expect_error(run_raycone({"points", mesh, points}), 1, "cannot both be standard input");
    }
  }
  expect_error(lattice({"--report", csv_}), 1, "is output and report");
}

TEST_F(CommandLine, ValuesAreNeitherForgottenNorGivenToFlags) {
  expect_error(run_raycone({"lattice", mesh_, "-o"}), 1, "-o: needs a value");
  expect_error(lattice({"--bounds="}), 1, "--bounds: needs a value");
  expect_error(lattice({"--quiet=1"}), 1, "--quiet: takes no value");
}

TEST_F(CommandLine, UnknownWordsListWhatExists) {
  expect_error(lattice({"--field", "foo"}), 1,
               "--field foo: expected one or more of winding, inside, density, sdf, solid, gradient");
  expect_error(lattice({"--format", "xyz"}), 1, "expected vdb, csv, npy, npz, vti, nrrd, nii or nii.gz");
  expect_error(lattice({"--up", "z-to-y"}), 1, "expected y-to-z");
  expect_error(lattice({"--weld", "fuzzy"}), 1, "expected exact, none");
  expect_error(lattice({"--progress", "maybe"}), 1, "expected always, never or auto");
  expect_error(lattice({"--mesh-format", "fbx"}), 1, "expected obj, ply, stl, off, gltf, glb or 3mf");
}

TEST_F(CommandLine, UnknownOutputFormatFailsBeforeTheMeshIsRead) {
  for (const char* const output : {"out.png", "out", ".vdb", "/dev/null"}) {
    expect_error(run_raycone({"lattice", dir_ / "absent.obj", "-o", output}), 1,
                 "expected vdb, csv, npy, npz, vti, nrrd, nii or nii.gz");
  }
  expect_error(run_raycone({"points", mesh_, "p.csv", "-o", "out.vdb"}), 1, "expected csv, npy or npz");
}

TEST_F(CommandLine, ExtensionsAreRecognisedInAnyCase) {
  const std::string upper = dir_ / "OUT.CSV";
  EXPECT_EQ(run_raycone({"lattice", mesh_, "-o", upper, "--resolution", "2"}).status, 0);
  EXPECT_EQ(first_lines(read_text(upper), 1), "i,j,k,x,y,z,w");
}

TEST_F(CommandLine, HelpIsAResultWithExamples) {
  for (const Arguments& arguments :
       {Arguments{"--help"}, {"lattice", "--help"}, {"points", "-h"}, {"--help", "info"}}) {
    const CommandResult result = run_raycone(arguments);
    EXPECT_EQ(result.status, 0);
    EXPECT_EQ(result.err, "");
    EXPECT_NE(result.out.find("Usage: raycone"), std::string::npos);
    EXPECT_NE(result.out.find("Examples:\n  raycone "), std::string::npos);
  }
}

TEST_F(CommandLine, VersionIsAResultAndNamesTheLibraries) {
  const CommandResult result = run_raycone({"--version"});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(result.out.rfind("raycone " RAYCONE_VERSION " (", 0), 0U) << result.out;
  EXPECT_NE(result.out.find("commit"), std::string::npos) << result.out;
  for (const char* const library : {"CGAL", "GMP", "Embree", "Highway", "OpenVDB", "TBB", "CLI11", "nlohmann-json",
                                    "tinygltf", "Draco", "Expat", "nettle", "libpng", "zlib", "Zstandard"}) {
    const std::regex with_version(std::string(library) + " [0-9]+\\.[0-9]");
    EXPECT_TRUE(std::regex_search(result.out, with_version)) << library << " in " << result.out;
  }
}

TEST_F(CommandLine, ThreadsComeFromTheEnvironmentUnlessGiven) {
  const CommandOptions wrong{.environment = {{"RAYCONE_THREADS", "many"}}};
  expect_error(run_raycone({"info", mesh_}, wrong), 1, "RAYCONE_THREADS=many");
  EXPECT_EQ(run_raycone({"info", mesh_, "--threads", "1"}, wrong).status, 0);
  const CommandOptions three{.environment = {{"RAYCONE_THREADS", "3"}}};
  EXPECT_NE(run_raycone({"info", mesh_}, three).out.find("cost on 3 threads"), std::string::npos);
}

}  // namespace
}  // namespace raycone::test
