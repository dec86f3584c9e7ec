// --orient: every command sees the mesh that it makes. Black box: the real executable.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/app/meshes.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_directory.h"

namespace raycone::test {
namespace {

// kCube with its first two faces reversed, and one side of it twice.
const char* const kMixedUp = R"(v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
f 1 2 3 4
f 8 7 6 5
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
f 4 8 5 1
)";

class OrientCommand : public testing::Test {
 protected:
  OrientCommand() {
    write_text(mesh_, kMixedUp);
    write_text(points_, "0.5,0.4,0.3\n1.5,0.4,0.3\n");
  }

  [[nodiscard]] std::string values(const std::string& orient) const {
    const CommandResult result = run_raycone({"points", mesh_, points_, "--orient", orient, "--quiet"});
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out;
  }

  TemporaryDirectory dir_;
  std::string mesh_ = dir_ / "mesh.obj", points_ = dir_ / "points.csv", report_ = dir_ / "report.json";
};

TEST_F(OrientCommand, AutoMakesACubeSolid) {
  EXPECT_EQ(values("auto"), "x,y,z,w\n0.5,0.4,0.3,1\n1.5,0.4,0.3,0\n");
  EXPECT_NE(values("keep"), values("auto"));
}

TEST_F(OrientCommand, KeepIsTheDefault) {
  EXPECT_EQ(values("keep"), run_raycone({"points", mesh_, points_, "--quiet"}).out);
}

TEST_F(OrientCommand, FlipNegates) {
  write_text(mesh_, kCube);
  EXPECT_EQ(values("flip"), "x,y,z,w\n0.5,0.4,0.3,-1\n1.5,0.4,0.3,0\n");
}

TEST_F(OrientCommand, ReportCountsWhatWasDone) {
  const auto counts = [&](const std::string& orient) {
    const CommandResult result = run_raycone({"lattice", mesh_, "-o", dir_ / "out.npy", "--resolution", "5", "--orient",
                                              orient, "--verify", "20", "--report", report_, "--quiet"});
    EXPECT_EQ(result.status, 0) << result.err;
    const auto json = nlohmann::json::parse(read_text(report_));
    return std::vector<int>{json["flipped_faces"], json["dropped_duplicates"], json["patches"], json["exterior_edges"],
                            json["faces"]};
  };
  EXPECT_EQ(counts("auto"), (std::vector<int>{4, 2, 1, 0, 14}));
  EXPECT_EQ(counts("flip")[0], 14);
  EXPECT_EQ(counts("keep")[0], 0);
}

TEST_F(OrientCommand, InfoSlicesAndBatchesSeeTheOrientedMesh) {
  CommandResult result = run_raycone({"info", mesh_, "--json", "--orient", "auto", "--quiet"});
  EXPECT_EQ(nlohmann::json::parse(result.out)["signed_volume"], 1.0);
  result = run_raycone(
      {"slice", mesh_, "-o", dir_ / "out.png", "--size", "64", "--orient", "auto", "--report", report_, "--quiet"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(read_text(report_))["patches"], 1);
  result = run_raycone({"batch", mesh_, "--out-dir", dir_ / "out", "--format", "npy", "--resolution", "5", "--orient",
                        "auto", "--quiet"});
  EXPECT_EQ(result.status, 0) << result.err;
  std::istringstream table(read_text(dir_ / "out/results.csv"));
  std::string columns, row;
  std::getline(table, columns);
  std::getline(table, row);
  EXPECT_TRUE(columns.ends_with(",flipped_faces,dropped_duplicates,patches")) << columns;
  EXPECT_TRUE(row.ends_with(",4,2,1")) << row;
}

TEST_F(OrientCommand, WarnsWhereNoOrientationIsConsistent) {
  // Three triangles around a Moebius strip of five.
  write_text(mesh_, "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 1\nv 0 2 0\nf 1 2 3\nf 2 3 4\nf 3 4 5\nf 4 5 1\nf 5 1 2\n");
  const CommandResult result = run_raycone({"points", mesh_, points_, "--orient", "auto"});
  EXPECT_EQ(result.status, 0);
  EXPECT_NE(result.err.find("unorientable: 1 edge was cut"), std::string::npos) << result.err;
  EXPECT_EQ(run_raycone({"points", mesh_, points_, "--orient", "auto", "--strict"}).status, 2);
}

// The closed box [low, low + size]^3, its vertices counted from `first` + 1, its sides outward but maybe the first.
std::string box_at(double low, double size, int first, bool agrees) {
  std::ostringstream obj;
  for (const int v : {0, 1, 3, 2, 4, 5, 7, 6}) {
    obj << "v " << low + size * (v & 1) << ' ' << low + size * (v >> 1 & 1) << ' ' << low + size * (v >> 2) << '\n';
  }
  for (const char* const face :
       {agrees ? "4 3 2 1" : "1 2 3 4", "5 6 7 8", "1 2 6 5", "2 3 7 6", "3 4 8 7", "4 1 5 8"}) {
    std::istringstream corners(face);
    obj << 'f';
    for (int corner = 0; corners >> corner;) obj << ' ' << first + corner;
    obj << '\n';
  }
  return obj.str();
}

// Two cavities that overlap take more from a box than it has. What is reversed is told of the result, also where it
// follows from the rules and not from a mistake.
TEST_F(OrientCommand, OutwardIsJudgedByTheResult) {
  const auto judged = [&](bool agrees) {
    write_text(mesh_, box_at(0, 16, 0, true) + box_at(0, 15, 8, agrees) + box_at(1, 15, 16, agrees) +
                          (agrees ? box_at(100, 32, 24, true) : ""));
    return run_raycone({"info", mesh_, "--require", "closed,outward", "--orient", "auto"});
  };
  EXPECT_EQ(judged(true).status, 0) << "their relation is kept";
  const CommandResult result = judged(false);
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("outward: the signed volume is negative"), std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("--orient auto turns"), std::string::npos) << "it has been asked for: " << result.err;
}

TEST_F(OrientCommand, RefusesOtherWords) {
  const CommandResult result = run_raycone({"points", mesh_, points_, "--orient", "outward"});
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("expected keep, flip or auto"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace raycone::test
