// `raycone lattice` from mesh to file. Black box: the real executable.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "tests/app/meshes.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_directory.h"

namespace raycone::test {
namespace {

class LatticeCommand : public testing::Test {
 protected:
  LatticeCommand() {
    write_text(mesh_, kCube);
    write_text(flat_, kTriangle);
  }

  TemporaryDirectory dir_;
  std::string mesh_ = dir_ / "mesh.obj";
  std::string flat_ = dir_ / "flat.obj";
};

TEST_F(LatticeCommand, WritesTheWindingNumbersOfACube) {
  const CommandResult result = run_raycone({"lattice", mesh_, "-o", "-", "--resolution", "3,1,1"});
  EXPECT_EQ(result.status, 0) << result.err;
  // x = 0 is the lower face, inside; x = 1 the upper one, outside.
  EXPECT_EQ(result.out, "i,j,k,x,y,z,w\n0,0,0,0,0.5,0.5,1\n1,0,0,0.5,0.5,0.5,1\n2,0,0,1,0.5,0.5,0\n");
}

TEST_F(LatticeCommand, PrintsOneSummaryLineUnlessQuiet) {
  const std::string out = dir_ / "out.vdb";
  const CommandResult result = run_raycone({"lattice", mesh_, "-o", out, "--resolution", "5"});
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err.rfind("raycone: " + mesh_ + ": 12 faces, 0 exterior edges, 125 samples in ", 0), 0U)
      << result.err;
  EXPECT_TRUE(result.err.ends_with(" -> " + out + "\n")) << result.err;
  EXPECT_EQ(std::ranges::count(result.err, '\n'), 1);
  EXPECT_EQ(run_raycone({"lattice", mesh_, "-o", out, "--quiet"}).err, "");
}

TEST_F(LatticeCommand, ShowsProgressOnlyWhenAskedToOffATerminal) {
  const std::string out = dir_ / "out.vdb";
  EXPECT_EQ(run_raycone({"lattice", mesh_, "-o", out}).err.find('\r'), std::string::npos);
  const CommandResult shown = run_raycone({"lattice", mesh_, "-o", out, "--progress", "always"});
  EXPECT_NE(shown.err.find("samples/s"), std::string::npos) << shown.err;
  EXPECT_NE(shown.err.find("\r\033[Kraycone: "), std::string::npos) << "the line is erased before the summary";
  EXPECT_EQ(run_raycone({"lattice", mesh_, "-o", out, "--progress", "always", "--quiet"}).err, "");
}

TEST_F(LatticeCommand, ReadsTheMeshFromStandardInput) {
  const std::vector<std::string> arguments{"lattice", "-", "--mesh-format", "obj", "-o", "-", "--resolution", "2"};
  const CommandResult piped = run_raycone(arguments, {.input = kCube});
  EXPECT_EQ(piped.status, 0) << piped.err;
  EXPECT_EQ(piped.out, run_raycone({"lattice", mesh_, "-o", "-", "--resolution", "2"}).out);
}

TEST_F(LatticeCommand, SendsAnyFormatToStandardOutput) {
  for (const std::string format : {"csv", "npy", "vdb"}) {
    const std::string file = dir_ / ("out." + format);
    ASSERT_EQ(run_raycone({"lattice", mesh_, "-o", file, "--resolution", "4"}).status, 0);
    const CommandResult piped = run_raycone({"lattice", mesh_, "-o", "-", "--format", format, "--resolution", "4"});
    EXPECT_EQ(piped.status, 0) << piped.err;
    EXPECT_EQ(piped.out, read_text(file)) << format;
  }
}

TEST_F(LatticeCommand, BytesDependNeitherOnThreadsNorOnDirectories) {
  write_text(mesh_, triangle_soup(20));
  std::filesystem::create_directory(dir_ / "other");
  const std::string copy = dir_ / "other/mesh.obj";
  std::filesystem::copy_file(mesh_, copy);
  for (const std::string format : {"csv", "npy", "vdb"}) {
    std::set<std::string> contents;
    for (const std::string threads : {"1", "2", "7"}) {
      for (const std::string& mesh : {mesh_, copy}) {
        const CommandResult result =
            run_raycone({"lattice", mesh, "-o", "-", "--format", format, "--resolution", "30", "--threads", threads});
        EXPECT_EQ(result.status, 0) << result.err;
        contents.insert(result.out);
      }
    }
    EXPECT_EQ(contents.size(), 1U) << format;
    EXPECT_GT(contents.begin()->size(), 30U * 30U * 30U * 2U) << format;
  }
}

TEST_F(LatticeCommand, WritesAReportForMachines) {
  const std::string report = dir_ / "report.json";
  const std::string out = dir_ / "out.npy";
  const CommandResult result = run_raycone({"lattice", mesh_, "-o", out, "--report", report, "--voxel-size", "0.5",
                                            "--padding", "1v", "--threads", "2", "--quiet"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::ordered_json::parse(read_text(report));
  std::vector<std::string> keys;
  for (const auto& item : json.items()) keys.push_back(item.key());
  EXPECT_EQ(keys, (std::vector<std::string>{"version",
                                            "command",
                                            "options",
                                            "mesh",
                                            "sha256",
                                            "output",
                                            "vertices",
                                            "faces",
                                            "flipped_faces",
                                            "dropped_duplicates",
                                            "patches",
                                            "exterior_edges",
                                            "transform",
                                            "samples",
                                            "lattice",
                                            "threads",
                                            "degenerate",
                                            "on_surface",
                                            "near_terms",
                                            "far_terms",
                                            "largest_error_bound",
                                            "peak_memory_bytes",
                                            "warnings",
                                            "warning_lines",
                                            "seconds"}));
  EXPECT_EQ(json["mesh"], mesh_);
  EXPECT_EQ(json["output"], out);
  EXPECT_EQ(json["sha256"].get<std::string>().size(), 64U);
  EXPECT_EQ(json["vertices"], 8);
  EXPECT_EQ(json["faces"], 12);
  EXPECT_EQ(json["exterior_edges"], 0);
  EXPECT_EQ(json["samples"], 125);
  EXPECT_EQ(json["threads"], 2);
  EXPECT_EQ(json["on_surface"], 26) << "27 of the samples are in the closed cube, one of them inside";
  EXPECT_GT(json["peak_memory_bytes"], 1'000'000);
  EXPECT_EQ(json["warnings"].size(), 0U);
  EXPECT_EQ(json["lattice"], nlohmann::ordered_json::parse(
                                 R"({"origin": [0.0, 0.0, 0.0], "spacing": [0.5, 0.5, 0.5],
                                     "index_min": [-1, -1, -1], "index_max": [3, 3, 3]})"));
  double parts = 0.0;
  for (const char* const key : {"read", "prepare", "evaluate", "write"}) parts += json["seconds"][key].get<double>();
  EXPECT_GT(parts, 0.0);
  EXPECT_LE(parts, json["seconds"]["total"].get<double>());
}

TEST_F(LatticeCommand, WarnsOnceAboutAFlatSide) {
  const std::string report = dir_ / "report.json";
  const CommandResult result =
      run_raycone({"lattice", flat_, "-o", dir_ / "out.csv", "--resolution", "4,4,4", "--report", report});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err.rfind("raycone: warning: " + flat_ +
                                 ": flat-box: the box is flat along z, and sampled once there, not 4 times\n",
                             0),
            0U)
      << result.err;
  const auto json = nlohmann::json::parse(read_text(report));
  EXPECT_EQ(json["warnings"], nlohmann::json({"flat-box"}));
  EXPECT_EQ(json["warning_lines"],
            nlohmann::json({"flat-box: the box is flat along z, and sampled once there, not 4 times"}));
}

TEST_F(LatticeCommand, StrictTurnsWarningsIntoErrorsWithoutOutput) {
  const std::string out = dir_ / "out.csv";
  write_text(mesh_, "v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2\nf 1 2 3\n");
  const CommandResult lenient = run_raycone({"lattice", mesh_, "-o", "-", "--resolution", "2"});
  EXPECT_EQ(lenient.status, 0);
  EXPECT_EQ(lenient.err.rfind("raycone: warning: " + mesh_ + ": skipped-faces: 1 ", 0), 0U) << lenient.err;
  const CommandResult strict = run_raycone({"lattice", mesh_, "-o", out, "--strict"});
  EXPECT_EQ(strict.status, 2);
  EXPECT_EQ(std::ranges::count(strict.err, '\n'), 1) << strict.err;
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(LatticeCommand, SamplesTheLatticeOfAnotherGrid) {
  const std::string vdb = dir_ / "first.vdb";
  ASSERT_EQ(run_raycone({"lattice", mesh_, "-o", vdb, "--voxel-size", "0.5,0.25,0.5", "--padding", "2v"}).status, 0);
  const std::vector<std::string> like{"lattice", flat_, "-o", "-", "--like"};
  for (const std::string& grid : {vdb, vdb + ":winding"}) {
    const CommandResult result = run_raycone({"lattice", flat_, "-o", "-", "--like", grid});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.out.rfind("i,j,k,x,y,z,w\n-2,-2,-2,-1,-0.5,-1,", 0), 0U);
    EXPECT_EQ(std::ranges::count(result.out, '\n'), 1 + 7 * 9 * 7);
  }
  EXPECT_EQ(run_raycone({"lattice", flat_, "-o", "-", "--like", vdb + ":absent"}).status, 2);
  EXPECT_EQ(run_raycone({"lattice", flat_, "-o", "-", "--like", dir_ / "absent.vdb"}).status, 2);
}

TEST_F(LatticeCommand, DoubleWidensTheValues) {
  const auto size = [&](const std::vector<std::string>& more) {
    return run_raycone(with_more({"lattice", mesh_, "-o", "-", "--format", "npy", "--resolution", "10"}, more))
        .out.size();
  };
  EXPECT_EQ(size({"--double"}) - size({}), 4U * 1000U);
}

TEST_F(LatticeCommand, TransformsCoordinatesOnReading) {
  write_text(mesh_, "v 0 0 0\nv 1 0 0\nv 0 2 3\nf 1 2 3\n");
  const CommandResult result =
      run_raycone({"lattice", mesh_, "-o", "-", "--up", "y-to-z", "--scale", "10", "--resolution", "2,2,2"});
  EXPECT_EQ(result.out.rfind("i,j,k,x,y,z,w\n0,0,0,0,-30,0,", 0), 0U) << result.out;
  EXPECT_NE(result.out.find("\n1,1,1,10,0,20,"), std::string::npos) << result.out;
}

TEST_F(LatticeCommand, InputErrorsNameTheFile) {
  const std::string absent = dir_ / "absent.obj";
  const CommandResult result = run_raycone({"lattice", absent, "-o", dir_ / "out.csv"});
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.err.rfind("raycone: " + absent + ": ", 0), 0U) << result.err;
  write_text(mesh_, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  const CommandResult broken = run_raycone({"lattice", mesh_, "-o", dir_ / "out.csv"});
  EXPECT_EQ(broken.status, 2);
  EXPECT_EQ(broken.err.rfind("raycone: " + mesh_ + ":4: ", 0), 0U) << broken.err;
  EXPECT_FALSE(std::filesystem::exists(dir_ / "out.csv"));
}

TEST_F(LatticeCommand, UnwritableOutputFailsBeforeTheMeshIsRead) {
  // A path below a regular file fails for root too.
  const CommandResult result = run_raycone({"lattice", dir_ / "absent.obj", "-o", mesh_ + "/out.csv"});
  EXPECT_EQ(result.status, 3) << result.err;
  EXPECT_EQ(result.err.rfind("raycone: " + mesh_ + "/out.csv: ", 0), 0U) << result.err;
  const CommandResult report =
      run_raycone({"lattice", dir_ / "absent.obj", "-o", dir_ / "out.csv", "--report", mesh_ + "/report.json"});
  EXPECT_EQ(report.status, 3) << report.err;
  EXPECT_FALSE(std::filesystem::exists(dir_ / "out.csv"));
}

TEST_F(LatticeCommand, FullDeviceIsAnOutputError) {
  const CommandResult result = run_raycone({"lattice", mesh_, "-o", "/dev/full", "--format", "csv"});
  EXPECT_EQ(result.status, 3);
  EXPECT_EQ(result.err.rfind("raycone: /dev/full: ", 0), 0U) << result.err;
  EXPECT_EQ(run_raycone({"lattice", mesh_, "-o", "-"}, {.output_file = "/dev/full"}).status, 3);
  EXPECT_EQ(run_raycone({"lattice", mesh_, "-o", "-"}, {.close_output = true}).status, 3);
}

TEST_F(LatticeCommand, FileSizeLimitIsAnOutputErrorWithoutDebris) {
  for (const std::string format : {"csv", "npy", "vdb"}) {
    write_text(mesh_, triangle_soup(3));
    const CommandResult result =
        run_raycone({"lattice", mesh_, "-o", dir_ / ("out." + format)}, {.file_size_limit = 10'000});
    EXPECT_EQ(result.status, 3) << result.err << result.signal;
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(dir_.path()), {}), 2) << "only the two meshes";
}

TEST_F(LatticeCommand, ClosedPipeKillsWithoutAWord) {
  for (const std::vector<int>& ignored : {std::vector<int>{}, {SIGPIPE}}) {
    const CommandResult result = run_raycone({"lattice", mesh_, "-o", "-", "--report", dir_ / "report.json"},
                                             {.break_output_pipe = true, .ignored_signals = ignored});
    EXPECT_EQ(result.signal, SIGPIPE) << result.status;
    EXPECT_EQ(result.err, "");
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(dir_.path()), {}), 2) << "only the two meshes";
}

TEST_F(LatticeCommand, NoClobberKeepsAnExistingFile) {
  const std::string out = dir_ / "out.csv";
  write_text(out, "precious");
  EXPECT_EQ(run_raycone({"lattice", mesh_, "-o", out, "--no-clobber"}).status, 3);
  EXPECT_EQ(read_text(out), "precious");
  EXPECT_EQ(run_raycone({"lattice", mesh_, "-o", out}).status, 0);
  EXPECT_NE(read_text(out), "precious");
}

TEST_F(LatticeCommand, NeverReplacesItsInput) {
  EXPECT_EQ(run_raycone({"lattice", mesh_, "-o", mesh_, "--format", "csv"}).status, 1);
  EXPECT_EQ(run_raycone({"lattice", mesh_, "-o", dir_ / "out.csv", "--report", mesh_}).status, 1);
  EXPECT_EQ(read_text(mesh_), kCube);
}

TEST_F(LatticeCommand, RefusesWhatCannotFitBeforeWorkWithTheNumbers) {
  const std::string out = dir_ / "out.vdb";
  const CommandResult memory =
      run_raycone({"lattice", flat_, "-o", out, "--resolution", "20000", "--padding", ".1", "--memory-limit", "2G"});
  EXPECT_EQ(memory.status, 4) << memory.err;
  EXPECT_NE(memory.err.find("needs about "), std::string::npos) << memory.err;
  EXPECT_NE(memory.err.find("the limit is 2 GB"), std::string::npos) << memory.err;
  const CommandResult texts =
      run_raycone({"lattice", mesh_, "-o", dir_ / "out.csv", "--resolution", "2000000000,1,1", "--memory-limit", "1G"});
  EXPECT_EQ(texts.status, 4) << texts.err;
  EXPECT_NE(texts.err.find("needs about 119 GB"), std::string::npos) << texts.err;
  const CommandResult count = run_raycone({"lattice", mesh_, "-o", out, "--resolution", "10000000000"});
  EXPECT_EQ(count.status, 4) << count.err;
  EXPECT_NE(count.err.find("1e+30 samples"), std::string::npos) << count.err;
  EXPECT_EQ(run_raycone({"lattice", mesh_, "-o", out, "--memory-limit", "1K"}).status, 4);
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(LatticeCommand, NamesTheMeshWhoseLatticeIsBeyondNumbers) {
  for (const char* const command : {"lattice", "surface"}) {
    const std::string out = dir_ / (std::string(command) == "lattice" ? "out.npy" : "out.ply");
    for (const std::vector<std::string>& sampling :
         {std::vector<std::string>{"--resolution", "4000000"}, {"--voxel-size", "1e-300"}}) {
      const CommandResult result = run_raycone(with_more({command, mesh_, "-o", out}, sampling));
      EXPECT_EQ(result.status, 4) << result.err;
      EXPECT_EQ(result.err.rfind("raycone: " + mesh_ + ": the lattice would ", 0), 0U) << result.err;
      EXPECT_NE(result.err.find(", expected "), std::string::npos) << result.err;
    }
  }
}

TEST_F(LatticeCommand, GenerousMemoryLimitChangesNothing) {
  EXPECT_EQ(run_raycone({"lattice", mesh_, "-o", dir_ / "out.vdb", "--memory-limit", "1G"}).status, 0);
}

}  // namespace
}  // namespace raycone::test
