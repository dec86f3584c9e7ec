// Concave polygons through the whole tool.
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <string>

#include "tests/support/run_command.h"
#include "tests/support/temporary_directory.h"

namespace raycone {
namespace {

using test::CommandResult;
using test::run_raycone;
using test::TemporaryDirectory;

// The outline, from its corner `first` on, as floor and ceiling at z = 0 and 1, and walls between them.
std::string prism(const std::vector<std::array<int, 2>>& outline, std::size_t first) {
  const std::size_t n = outline.size();
  std::string text;
  for (const int z : {0, 1})
    for (const auto& [x, y] : outline)
      text += "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
  const auto corner = [&](std::size_t i, std::size_t layer) { return " " + std::to_string(1 + i % n + layer * n); };
  std::string floor = "f", ceiling = "f";
  for (std::size_t i = 0; i < n; ++i) {
    floor += corner(first + n - i, 0);
    ceiling += corner(first + i, 1);
    text += "f" + corner(i, 0) + corner(i + 1, 0) + corner(i + 1, 1) + corner(i, 1) + "\n";
  }
  return text + floor + "\n" + ceiling + "\n";
}

class PolygonsCommand : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) {
    std::ofstream(directory_ / name) << text;
    return directory_ / name;
  }

  TemporaryDirectory directory_;
};

// The notch of an L is (1, 3) x (1, 3); in the plane of its floor a fan put triangles there.
TEST_F(PolygonsCommand, DistancesInTheNotchAreThoseToTheWalls) {
  const std::string points = write("points.csv", "1.5,1.5,0\n2,1.5,1\n1.25,2,0\n0.5,0.5,0.5\n");
  for (std::size_t first = 0; first < 6; ++first) {
    const std::string mesh = write("l.obj", prism({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}}, first));
    const CommandResult result = run_raycone({"points", mesh, points, "--field", "sdf,winding", "--quiet"});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.out, "x,y,z,sdf,w\n1.5,1.5,0,0.5,0\n2,1.5,1,0.5,0\n1.25,2,0,0.25,0\n0.5,0.5,0.5,-0.5,1\n")
        << first;
  }
}

TEST_F(PolygonsCommand, ThoseThatCrossThemselvesAreWarnedAboutInEveryReport) {
  const std::string mesh = write("bow.obj", prism({{0, 0}, {4, 3}, {4, 0}, {0, 2}}, 0));
  const CommandResult info = run_raycone({"info", mesh});
  EXPECT_EQ(info.status, 0);
  EXPECT_NE(info.err.find("warning: " + mesh + ": bad-polygons: 2 polygons "), std::string::npos) << info.err;
  EXPECT_NE(info.out.find("faces                12\n"), std::string::npos) << info.out;
  const std::string report = directory_ / "r.json";
  EXPECT_EQ(run_raycone({"lattice", mesh, "--resolution", "3", "-o", directory_ / "a.csv", "--report", report}).status,
            0);
  std::ifstream file(report);
  EXPECT_NE(std::string(std::istreambuf_iterator<char>(file), {}).find("\"bad-polygons: 2 polygons "),
            std::string::npos);
  const CommandResult strict = run_raycone({"info", mesh, "--strict"});
  EXPECT_EQ(strict.status, 2);
  EXPECT_NE(strict.err.find("bad-polygons: 2 polygons "), std::string::npos) << strict.err;
}

}  // namespace
}  // namespace raycone
