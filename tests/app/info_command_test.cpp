// `raycone info`. Black box: the real executable.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/app/meshes.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/text_files.h"

namespace raycone::test {
namespace {

class InfoCommand : public testing::Test {
 protected:
  [[nodiscard]] nlohmann::ordered_json info(const std::string& obj) const {
    const CommandResult result =
        run_raycone({"info", "-", "--mesh-format", "obj", "--json", "--quiet"}, {.input = obj});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.err, "");
    return nlohmann::ordered_json::parse(result.out);
  }

  TemporaryDirectory dir_;
};

TEST_F(InfoCommand, JsonDescribesAClosedMesh) {
  EXPECT_EQ(info(kCube), nlohmann::ordered_json::parse(R"({
    "faces": 12, "vertices": 8, "welded_vertices": 8, "exterior_edges": 0, "closed": true, "components": 1,
    "degenerate_faces": 0, "duplicate_faces": 0, "nonmanifold_edges": 0, "inconsistent_edges": 0,
    "bounds": [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]], "signed_volume": 1.0, "surface_area": 6.0, "skipped_faces": 0,
    "opposite_duplicate_faces": 0, "warnings": [], "warning_lines": []})"));
}

TEST_F(InfoCommand, TellsWhatIsTurned) {
  const std::string mesh = dir_ / "twice.obj";
  write_text(mesh, std::string(kCube) + "f 1 2 3\nf 3 2 1\n");
  const auto lines = [&](const char* orient) { return run_raycone({"info", mesh, "--orient", orient}).out; };
  EXPECT_NE(lines("auto").find("  turned               0 faces, in 2 patches; 1 duplicate left out\n"),
            std::string::npos)
      << lines("auto");
  EXPECT_EQ(lines("keep").find("turned"), std::string::npos);
}

TEST_F(InfoCommand, JsonDescribesAnOpenMeshWithFlaws) {
  // Two equal faces, one of zero area, one of two corners; vertex 4 repeats vertex 1.
  const auto json = info("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nv 2 0 0\nf 1 2 3\nf 2 3 4\nf 1 2 5\nf 1 2\n");
  EXPECT_EQ(json["faces"], 3);
  EXPECT_EQ(json["vertices"], 5);
  EXPECT_EQ(json["welded_vertices"], 4);
  EXPECT_EQ(json["closed"], false);
  EXPECT_TRUE(json["signed_volume"].is_null());
  EXPECT_EQ(json["degenerate_faces"], 1);
  EXPECT_EQ(json["duplicate_faces"], 1);
  EXPECT_EQ(json["skipped_faces"], 1);
}

TEST_F(InfoCommand, TextIsForPeople) {
  const std::string mesh = dir_ / "mesh.obj";
  write_text(mesh, kTriangle);
  const CommandResult result = run_raycone({"info", mesh, "--threads", "1"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out.rfind(mesh + "\n", 0), 0U);
  for (const char* const line :
       {"  faces                1\n", "  exterior edges       3\n", "  surface              open\n",
        "  cost on 1 thread     less than 0.1 s for 64 x 64 x 1 samples\n"}) {
    EXPECT_NE(result.out.find(line), std::string::npos) << line << result.out;
  }
}

TEST_F(InfoCommand, DescribesMeshesTooLargeForALattice) {
  const CommandResult result = run_raycone({"info", "-", "--mesh-format", "obj"},
                                           {.input = "v -1e308 0 0\nv 1e308 0 0\nv 0 1e308 0\nf 1 2 3\n"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("  no lattice           the box is too large"), std::string::npos) << result.out;
}

TEST_F(InfoCommand, FailureToWriteStandardOutputIsAnOutputError) {
  const std::string mesh = dir_ / "mesh.obj";
  write_text(mesh, kCube);
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"info", mesh}, {"--help"}, {"--version"}}) {
    const CommandResult full = run_raycone(arguments, {.output_file = "/dev/full"});
    EXPECT_EQ(full.status, 3);
    EXPECT_NE(full.err, "");
    EXPECT_EQ(run_raycone(arguments, {.close_output = true}).status, 3);
  }
}

TEST_F(InfoCommand, StrictRefusesWarnings) {
  const std::string mesh = dir_ / "mesh.obj";
  write_text(mesh, std::string(kTriangle) + "f 1 2\n");
  EXPECT_EQ(run_raycone({"info", mesh}).status, 0);
  const CommandResult strict = run_raycone({"info", mesh, "--strict"});
  EXPECT_EQ(strict.status, 2);
  EXPECT_EQ(strict.out, "");
}

}  // namespace
}  // namespace raycone::test
