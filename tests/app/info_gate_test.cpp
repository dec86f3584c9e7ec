// `raycone info` of several meshes, --require, --intersections and --mark. Black box: the real executable.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/app/meshes.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_directory.h"

namespace raycone::test {
namespace {

// Two triangles that cross and share nothing.
const char* const kCrossing = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv .25 .25 -1\nv .25 .25 1\nv 3 3 0\nf 1 2 3\nf 4 5 6\n";
// The cube's faces, reversed.
std::string reversed_cube() {
  std::string text = kCube;
  for (const char* const face : {"f 4 3 2 1", "f 5 6 7 8", "f 1 2 6 5", "f 2 3 7 6", "f 3 4 8 7", "f 4 1 5 8"}) {
    std::string turned(face);
    std::reverse(turned.begin() + 2, turned.end());
    text.replace(text.find(face), turned.size(), turned);
  }
  return text;
}

class InfoGate : public testing::Test {
 protected:
  [[nodiscard]] std::string mesh(const std::string& name, const std::string& text) const {
    write_text(dir_ / name, text);
    return dir_ / name;
  }
  void expect_unmet(const std::string& words, const std::string& path, const std::string& message) const {
    const CommandResult result = run_raycone({"info", cube_, path, "--require", words, "--quiet"});
    EXPECT_EQ(result.status, 2);
    EXPECT_EQ(result.err, "raycone: " + path + ": not as required: " + message + "\n");
  }
  static void expect_usage_error(const std::vector<std::string>& arguments, const std::string& fragment) {
    const CommandResult result = run_raycone(arguments);
    EXPECT_EQ(result.status, 1) << fragment;
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find(fragment), std::string::npos) << result.err;
  }

  TemporaryDirectory dir_;
  const std::string cube_ = mesh("cube.obj", kCube);
  const std::string open_ = mesh("open.obj", kTriangle);
  const std::string crossing_ = mesh("crossing.obj", kCrossing);
  const std::string broken_ = mesh("broken.obj", "f 1 2 3\n");
};

TEST_F(InfoGate, TextHasABlockAMesh) {
  const CommandResult both = run_raycone({"info", cube_, open_});
  EXPECT_EQ(both.status, 0) << both.err;
  EXPECT_EQ(both.out, run_raycone({"info", cube_}).out + "\n" + run_raycone({"info", open_}).out);
}

TEST_F(InfoGate, JsonOfSeveralMeshesIsAnArrayThatNamesThem) {
  const auto json = nlohmann::ordered_json::parse(run_raycone({"info", cube_, open_, "--json"}).out);
  ASSERT_EQ(json.size(), 2U);
  EXPECT_EQ(json[0].begin().key(), "mesh");
  EXPECT_EQ(json[1]["mesh"], open_);
  auto one = json[0];
  one.erase("mesh");
  EXPECT_EQ(one, nlohmann::ordered_json::parse(run_raycone({"info", cube_, "--json"}).out));
}

TEST_F(InfoGate, CsvHasTheKeysOfJsonAsColumns) {
  const CommandResult result = run_raycone({"info", cube_, open_, "--csv", "--intersections"});
  EXPECT_EQ(result.status, 0) << result.err;
  std::string header = "mesh";
  const auto one = nlohmann::ordered_json::parse(run_raycone({"info", cube_, "--json", "--intersections"}).out);
  for (const auto& [key, value] : one.items()) {
    header += "," + (key == "bounds" ? "x0,y0,z0,x1,y1,z1" : key);
  }
  EXPECT_EQ(result.out.substr(0, result.out.find('\n')), header);
  EXPECT_NE(result.out.find("\n" + cube_ + ",12,8,8,0,true,1,0,0,0,0,0.0,0.0,0.0,1.0,1.0,1.0,1.0,"), std::string::npos)
      << result.out;
  EXPECT_NE(result.out.find("\n" + open_ + ",1,3,3,3,false,1,0,0,0,0,0.0,0.0,0.0,1.0,1.0,0.0,,"), std::string::npos)
      << result.out;
}

TEST_F(InfoGate, AMeshThatCannotBeReadCostsItsOwnPlaceOnly) {
  const CommandResult text = run_raycone({"info", broken_, cube_, "nowhere.obj"});
  EXPECT_EQ(text.status, 2);
  EXPECT_EQ(text.out, run_raycone({"info", cube_}).out);
  EXPECT_EQ(std::ranges::count(text.err, '\n'), 2);
  EXPECT_NE(text.err.find("raycone: " + broken_ + ":1:"), std::string::npos) << text.err;
  const CommandResult json = run_raycone({"info", broken_, cube_, "nowhere.obj", "--json"});
  EXPECT_EQ(nlohmann::json::parse(json.out).size(), 1U);
  const CommandResult none = run_raycone({"info", broken_, "nowhere.obj", "--json"});
  EXPECT_EQ(none.status, 2);
  EXPECT_EQ(none.out, "[]\n");
  EXPECT_EQ(run_raycone({"info", broken_, "--json"}).out, "");
  const CommandResult strict =
      run_raycone({"info", mesh("skips.obj", std::string(kTriangle) + "f 1 2\n"), cube_, "--strict"});
  EXPECT_EQ(strict.status, 2);
  EXPECT_EQ(strict.out, text.out);
}

TEST_F(InfoGate, ALimitOfOneMeshLeavesTheOthers) {
  const std::string large = mesh("large.obj", "#");
  std::filesystem::resize_file(large, std::uintmax_t{1} << 30);  // takes no room
  // What a build with sanitizers needs, too.
  const CommandResult result = run_raycone({"info", large, cube_, "--memory-limit", "400M", "--threads", "1"});
  EXPECT_EQ(result.status, 4) << result.err;
  EXPECT_NE(result.out.find("faces                12"), std::string::npos) << result.out << result.err;
}

TEST_F(InfoGate, RequirementsThatHoldAreSilent) {
  const CommandResult result =
      run_raycone({"info", cube_, "--require", "closed,oriented,outward,manifold,embedded,no-duplicates"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(run_raycone({"info", open_, "--require", "oriented,manifold,embedded,no-duplicates"}).status, 0);
}

TEST_F(InfoGate, RequirementsThatDoNotHoldSayWhere) {
  const std::string open_at = "3 exterior edges, the first from (0, 0, 0) to (1, 0, 0) of face 0";
  expect_unmet("closed", open_, "closed: " + open_at);
  expect_unmet("outward", open_, "outward: " + open_at);
  expect_unmet("outward", mesh("inward.obj", reversed_cube()), "outward: the signed volume is negative, -1");
  const std::string two = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  expect_unmet("oriented,manifold", mesh("two.obj", two + "f 1 2 3\nf 1 2 4\n"),
               "oriented: 1 inconsistent edge, the first from (0, 0, 0) to (1, 0, 0) of faces 0 and 1");
  expect_unmet("manifold", mesh("three.obj", two + "v 0 -1 0\nf 1 2 3\nf 2 1 4\nf 1 2 5\n"),
               "manifold: 1 non-manifold edge, the first from (0, 0, 0) to (1, 0, 0) of faces 0, 1 and 1 more");
  expect_unmet("embedded", crossing_, "embedded: faces 0 and 1 intersect");
  expect_unmet("no-duplicates", mesh("twice.obj", std::string(kTriangle) + "f 3 2 1\nf 2 3 1\n"),
               "no-duplicates: 2 duplicate faces, the first 1 of face 0");
  expect_unmet("embedded,closed", crossing_,
               "embedded: faces 0 and 1 intersect; closed: 6 exterior edges, the first from (0, 0, 0) to (1, 0, 0) of "
               "face 0");
}

TEST_F(InfoGate, RequirementsLeaveResultsAlone) {
  const CommandResult result = run_raycone({"info", open_, "--require", "closed", "--json"});
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.out, run_raycone({"info", open_, "--json"}).out);
}

TEST_F(InfoGate, SelfIntersectionsAreCountedWhereAskedFor) {
  EXPECT_FALSE(nlohmann::json::parse(run_raycone({"info", crossing_, "--json"}).out).contains("self_intersections"));
  for (const std::vector<std::string>& option :
       {std::vector<std::string>{"--intersections"}, {"--require", "embedded"}}) {
    const CommandResult result = run_raycone(with_more({"info", crossing_, "--json"}, option));
    EXPECT_EQ(nlohmann::json::parse(result.out)["self_intersections"], 1) << result.err;
  }
  EXPECT_NE(run_raycone({"info", crossing_, "--intersections"}).out.find("  self-intersections   1 pair of faces\n"),
            std::string::npos);
  EXPECT_NE(run_raycone({"info", crossing_, "--require", "embedded"})
                .out.find("  self-intersections   some; --intersections counts them\n"),
            std::string::npos);
  EXPECT_NE(run_raycone({"info", cube_, "--require", "embedded"}).out.find("  self-intersections   0 pairs of faces\n"),
            std::string::npos);
}

TEST_F(InfoGate, UsageErrorsNameWhatIsExpected) {
  for (const std::string list : {"shut", "closed,closed", "closed,", "closed,shut"}) {
    expect_usage_error(
        {"info", cube_, "--require", list},
        "--require " + list +
            ": expected a list of closed, oriented, outward, manifold, embedded and no-duplicates, each once");
  }
  expect_usage_error({"info", "-", "-"}, "standard input can be read once");
  expect_usage_error({"info", cube_, ""}, "MESH");
  expect_usage_error({"info", cube_, "--json", "--csv"}, "--json: cannot be combined with --csv");
  expect_usage_error({"info", cube_, open_, "--mark", dir_ / "marks.ply"}, "expected one mesh");
  expect_usage_error({"info", cube_, "--no-clobber"}, "expected --mark");
  std::filesystem::create_symlink(cube_, std::string(dir_ / "link.ply"));
  expect_usage_error({"info", cube_, "--mark", dir_ / "link.ply"}, "is input and marked mesh");
  expect_usage_error({"info", cube_, "--mark", dir_ / "marks.stl"}, "expected a name that ends in .ply");
  expect_usage_error({"info", cube_, "--mark", "-"}, "is output and marked mesh");
}

TEST_F(InfoGate, MarksKeepTheFacesOfTheMeshInFront) {
  const std::string marks = dir_ / "marks.ply";
  const CommandResult result = run_raycone({"info", crossing_, "--mark", marks});
  EXPECT_NE(result.err.find("raycone: " + crossing_ + " -> " + marks + ": 1 pair of faces intersects"),
            std::string::npos)
      << result.err;
  EXPECT_EQ(run_raycone({"info", crossing_, "--mark", marks, "--json", "--quiet"}).err, "");
  EXPECT_EQ(result.status, 0) << result.err;
  const std::string bytes = read_text(marks);
  // 6 vertices of the mesh, 3 of each intersecting face, 2 and a bar's 6 of each exterior edge; 6 faces a bar.
  EXPECT_NE(bytes.find("element vertex " + std::to_string(6 + 6 + 6 * 8) + "\n"), std::string::npos);
  EXPECT_NE(bytes.find("element face " + std::to_string(2 + 6 * 6) + "\n"), std::string::npos);
  EXPECT_NE(bytes.find("element edge 6\n"), std::string::npos);
  EXPECT_NE(run_raycone({"info", marks}).out.find("  faces                38\n"), std::string::npos);
}

TEST_F(InfoGate, MarksOfASoundMeshAreTheMesh) {
  const std::string marks = dir_ / "marks.ply";
  EXPECT_EQ(run_raycone({"info", cube_, "--mark", marks, "--require", "closed,embedded"}).status, 0);
  const auto json = nlohmann::json::parse(run_raycone({"info", marks, "--json"}).out);
  EXPECT_EQ(json["faces"], 12);
  EXPECT_EQ(json["signed_volume"], 1.0);
  EXPECT_EQ(run_raycone({"info", cube_, "--mark", marks, "--no-clobber"}).status, 3);
}

TEST_F(InfoGate, MarksAreNotWrittenForAMeshThatCannotBeRead) {
  EXPECT_EQ(run_raycone({"info", broken_, "--mark", dir_ / "marks.ply"}).status, 2);
  EXPECT_FALSE(std::filesystem::exists(dir_ / "marks.ply"));
}

// All boxes meet: a count would look at 5 * 10^7 pairs, for longer than the second that it gets.
TEST_F(InfoGate, AHostileSoupIsRefusedAtItsFirstPair) {
  std::string text;
  for (int i = 0; i < 10000; ++i) {
    const std::string far = std::to_string(i + 1);
    text += "v -" + far + " -" + far + " -" + far + "\nv " + far + " " + far + " " + far + "\nv 0 " + far + " -" + far +
            "\n";
  }
  for (int i = 0; i < 10000; ++i) {
    text += "f " + std::to_string(3 * i + 1) + " " + std::to_string(3 * i + 2) + " " + std::to_string(3 * i + 3) + "\n";
  }
  const std::string soup = mesh("soup.obj", text);
  EXPECT_EQ(run_raycone({"info", soup, "--require", "embedded", "--timeout", "60"}).status, 2);
  const CommandResult count = run_raycone({"info", soup, "--intersections", "--timeout", "1", "--threads", "1"});
  EXPECT_EQ(count.status, 4);
  EXPECT_NE(count.err.find("--timeout"), std::string::npos);
}

}  // namespace
}  // namespace raycone::test
