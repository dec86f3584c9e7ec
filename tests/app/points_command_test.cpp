// `raycone points` from points to values. Black box: the real executable.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <thread>

#include "tests/app/meshes.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_directory.h"

namespace raycone::test {
namespace {

class PointsCommand : public testing::Test {
 protected:
  PointsCommand() {
    write_text(mesh_, kCube);
    write_text(points_, "0.5,0.5,0.5\n2,0,0\n");
  }

  TemporaryDirectory dir_;
  std::string mesh_ = dir_ / "mesh.obj";
  std::string points_ = dir_ / "points.csv";
};

TEST_F(PointsCommand, WritesCsvToStandardOutputByDefault) {
  const CommandResult result = run_raycone({"points", mesh_, points_});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, "x,y,z,w\n0.5,0.5,0.5,1\n2,0,0,0\n");
  EXPECT_EQ(result.err.rfind("raycone: " + mesh_ + ": 12 faces, 0 exterior edges, 2 samples in ", 0), 0U) << result.err;
}

TEST_F(PointsCommand, WritesNpyOfDoubles) {
  const std::string out = dir_ / "out.npy";
  EXPECT_EQ(run_raycone({"points", mesh_, points_, "-o", out}).status, 0);
  const std::string npy = read_text(out);
  EXPECT_EQ(npy.rfind("\x93NUMPY", 0), 0U);
  EXPECT_NE(npy.find("'shape': (2,)"), std::string::npos);
  EXPECT_EQ((npy.size() - 2 * 8) % 64, 0U) << "NumPy's header is padded to a multiple of 64";
}

TEST_F(PointsCommand, TakesTheColumnsNamed) {
  write_text(points_, "7,0.5,0.5,0.5\n8,2,0,0\n");
  const CommandResult result = run_raycone({"points", mesh_, points_, "--columns", "2,3,4", "--quiet"});
  EXPECT_EQ(result.out, "x,y,z,w\n0.5,0.5,0.5,1\n2,0,0,0\n");
}

TEST_F(PointsCommand, WarnsWhereAHeaderDoesNotTellTheColumns) {
  write_text(points_, "id,tx,ty,tz\n7,0.5,0.5,0.5\n");
  const CommandResult result = run_raycone({"points", mesh_, points_, "--report", dir_ / "r.json"});
  EXPECT_EQ(result.status, 0);
  EXPECT_NE(result.err.find("raycone: warning: " + points_ + ": columns: the first three of 4 columns, 'id', 'tx'"),
            std::string::npos)
      << result.err;
  EXPECT_NE(read_text(dir_ / "r.json").find("\"columns\""), std::string::npos);
  const CommandResult strict = run_raycone({"points", mesh_, points_, "--strict", "-o", dir_ / "out.csv"});
  EXPECT_EQ(strict.status, 0) << "it is about no mesh";
  EXPECT_NE(strict.err.find(": columns: "), std::string::npos);
}

TEST_F(PointsCommand, AnswersEachLineOfAReaderThatWaits) {
  Command command(raycone_command({"points", mesh_, "-", "--quiet"}));
  EXPECT_EQ(command.read_line(), "x,y,z,w") << "the header comes before the first question";
  for (int i = 0; i < 3; ++i) {
    command.write("0.5 0.5 0.5\n");
    EXPECT_EQ(command.read_line(), "0.5,0.5,0.5,1");
    command.write("2 0 0\n");
    EXPECT_EQ(command.read_line(), "2,0,0,0");
  }
  command.close_input();
  const CommandResult result = command.wait();
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err, "");
}

TEST_F(PointsCommand, ReadsTheMeshFromStandardInput) {
  const CommandResult result =
      run_raycone({"points", "-", points_, "--mesh-format", "obj", "--quiet"}, {.input = kCube});
  EXPECT_EQ(result.out, "x,y,z,w\n0.5,0.5,0.5,1\n2,0,0,0\n") << result.err;
}

TEST_F(PointsCommand, LinesThatAreNoPointsAreInputErrorsWithTheirNumber) {
  const std::string out = dir_ / "out.csv";
  for (const char* const line : {"1,2\n", "1,2,x\n", "1,2,nan\n", "1,2,1e999\n"}) {
    write_text(points_, std::string("0,0,0\n1,1,1\n") + line);
    const CommandResult result = run_raycone({"points", mesh_, points_, "-o", out});
    EXPECT_EQ(result.status, 2) << line;
    EXPECT_EQ(result.err.rfind("raycone: " + points_ + ":3: ", 0), 0U) << result.err;
    EXPECT_FALSE(std::filesystem::exists(out));
  }
}

TEST_F(PointsCommand, PointsBeforeALineThatIsNoneAreAnswered) {
  for (const std::string line : {"bad\n", "1,2,\"3\n", "1,2,3,\"a\nb\"\n"}) {
    write_text(points_, "0.5,0.5,0.5\n2,0,0\n" + line);
    const CommandResult result = run_raycone({"points", mesh_, points_, "--quiet"});
    EXPECT_EQ(result.status, 2) << line;
    EXPECT_EQ(result.out, "x,y,z,w\n0.5,0.5,0.5,1\n2,0,0,0\n") << line;
    EXPECT_EQ(result.err.rfind("raycone: " + points_ + ":3: ", 0), 0U) << result.err;
  }
}

// Whether the line that is none comes with the one before, or while that is answered.
TEST_F(PointsCommand, WhatHasBeenAnsweredIsHandedOnBeforeAnError) {
  for (int i = 0; i < 15; ++i) {
    Command command(raycone_command({"points", mesh_, "-", "--quiet"}));
    command.write("0.5 0.5 0.5\n");
    std::this_thread::sleep_for(std::chrono::microseconds(400 * i));
    for (const char c : std::string("bad\n")) command.write(std::string(1, c));
    command.close_input();
    const CommandResult result = command.wait();
    EXPECT_EQ(result.status, 2);
    EXPECT_EQ(result.out, "x,y,z,w\n0.5,0.5,0.5,1\n");
  }
}

TEST_F(PointsCommand, QuotesNeedEnds) {
  write_text(points_, "1,2,\"3\",\"a \"\" b\"\n1,2,3 # a \"comment\n");
  EXPECT_EQ(run_raycone({"points", mesh_, points_, "--quiet"}).status, 0);
  for (const std::string line : {"\"1,2,3", "1,2,\"3", "1,2,3,\"a", "1,2,3,\"a\"\""}) {
    write_text(points_, line + '\n');
    const CommandResult result = run_raycone({"points", mesh_, points_, "--quiet"});
    EXPECT_EQ(result.status, 2) << line;
    EXPECT_NE(result.err.find(points_ + ":1: a quotation mark without its end"), std::string::npos) << result.err;
  }
}

TEST_F(PointsCommand, NoPointsAreNoError) {
  write_text(points_, "");
  const CommandResult result = run_raycone({"points", mesh_, points_, "--quiet"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, "x,y,z,w\n");
}

// Text of no bytes is no points; of a binary file, its writer has left nothing.
TEST_F(PointsCommand, EmptyBinaryFilesAreInputErrors) {
  for (const char* const name : {"empty.npy", "empty.NPZ", "empty.ply", "empty.npy.gz", "empty.ply.zst"}) {
    const std::string points = dir_ / name;
    write_text(points, "");
    const CommandResult result = run_raycone({"points", mesh_, points});
    EXPECT_EQ(result.status, 2) << name;
    EXPECT_NE(result.err.find("is empty, expected points"), std::string::npos) << result.err;
  }
}

TEST_F(PointsCommand, MissingPointsFailBeforeTheMeshIsRead) {
  const std::string absent = dir_ / "absent.csv";
  const CommandResult result = run_raycone({"points", dir_ / "absent.obj", absent});
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.err.rfind("raycone: " + absent + ": ", 0), 0U) << result.err;
}

TEST_F(PointsCommand, ReportHasNoLattice) {
  const std::string report = dir_ / "report.json";
  ASSERT_EQ(run_raycone({"points", mesh_, points_, "-o", dir_ / "out.csv", "--report", report}).status, 0);
  const auto json = nlohmann::json::parse(read_text(report));
  EXPECT_TRUE(json["lattice"].is_null());
  EXPECT_EQ(json["samples"], 2);
  EXPECT_EQ(run_raycone({"points", mesh_, points_, "--report", "-"}).status, 1) << "both on standard output";
}

TEST_F(PointsCommand, BytesDependNotOnThreads) {
  write_text(mesh_, triangle_soup(20));
  std::ostringstream points;
  for (int i = 0; i < 20'000; ++i)
    points << 0.001 * (i % 1000) << ',' << 0.01 * (i % 97) << ',' << 0.01 * (i % 89) << '\n';
  write_text(points_, points.str());
  for (const std::string format : {"csv", "npy"}) {
    std::set<std::string> contents;
    for (const std::string threads : {"1", "2", "7"}) {
      const CommandResult result = run_raycone({"points", mesh_, points_, "--threads", threads, "--format", format});
      EXPECT_EQ(result.status, 0) << result.err;
      contents.insert(result.out);
    }
    EXPECT_EQ(contents.size(), 1U) << format;
    EXPECT_GT(contents.begin()->size(), 20'000U * 8U);
  }
}

TEST_F(PointsCommand, NeverReplacesItsPoints) {
  EXPECT_EQ(run_raycone({"points", mesh_, points_, "-o", points_}).status, 1);
  EXPECT_EQ(read_text(points_), "0.5,0.5,0.5\n2,0,0\n");
}

}  // namespace
}  // namespace raycone::test
