// Every engine and every SIMD level writes the same bytes. Black box: the real executable. All shared meshes are
// compared in tests/shared_meshes_test.py.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "core/machine/simd.h"
#include "tests/app/meshes.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_directory.h"

namespace raycone::test {
namespace {

struct NamedLevel {
  SimdLevel level;
  const char* name;
};
constexpr NamedLevel kLevels[] = {
    {SimdLevel::kBest, "auto"}, {SimdLevel::kSse4, "sse4"}, {SimdLevel::kAvx2, "avx2"}, {SimdLevel::kAvx512, "avx512"}};

class Engines : public testing::Test {
 protected:
  // The output of `command` by the default engine; fails unless all others give the same.
  static std::string output_of_all(std::vector<std::string> command) {
    command.insert(command.end(), {"--diagnostics", "--quiet"});
    const CommandResult expected = run_raycone(command);
    EXPECT_EQ(expected.status, 0) << expected.err;
    for (const char* const engine : {"auto", "scan", "embree"}) {
      for (const NamedLevel& level : kLevels) {
        if (!is_available(level.level)) continue;
        const CommandResult result = run_raycone(with_more(command, {"--engine", engine, "--simd", level.name}));
        EXPECT_EQ(result.status, 0) << result.err;
        EXPECT_TRUE(result.out == expected.out) << engine << ' ' << level.name;
      }
    }
    return expected.out;
  }

  TemporaryDirectory dir_;
  std::string cube_ = dir_ / "cube.obj";
  std::string soup_ = dir_ / "soup.obj";
  std::string teapot_ = RAYCONE_DATA "/meshes/teapot.obj";
};

TEST_F(Engines, AgreeOnLattices) {
  write_text(cube_, kCube);  // samples on faces, edges and corners
  write_text(soup_, triangle_soup(50));
  (void)output_of_all({"lattice", cube_, "-o", "-", "--resolution", "5", "--padding", "1v"});
  const std::string soup = output_of_all({"lattice", soup_, "-o", "-", "--resolution", "9"});
  const std::string teapot = output_of_all({"lattice", teapot_, "-o", "-", "--resolution", "11,9,8"});
  EXPECT_NE(soup, teapot);
}

// At the samples of a lattice: points take another way than rows.
TEST_F(Engines, AgreeOnPoints) {
  write_text(soup_, triangle_soup(50));
  for (const std::string& mesh : {teapot_, soup_}) {
    const CommandResult lattice = run_raycone({"lattice", mesh, "-o", "-", "--resolution", "9", "--quiet"});
    const std::string points = dir_ / "points.csv";
    write_text(points, lattice.out);
    EXPECT_GT(output_of_all({"points", mesh, points}).size(), 1000U);
  }
}

TEST_F(Engines, OfOtherNamesAreUsageErrors) {
  write_text(cube_, kCube);
  for (const auto& [option, value] : {std::pair{"--engine", "bvh"}, {"--simd", "mmx"}, {"--engine", ""}}) {
    const CommandResult result = run_raycone({"lattice", cube_, "-o", "-", option, value});
    EXPECT_EQ(result.status, 1);
    EXPECT_NE(result.err.find(option), std::string::npos) << result.err;
  }
  for (const NamedLevel& level : kLevels) {
    if (is_available(level.level)) continue;
    const CommandResult result = run_raycone({"lattice", cube_, "-o", "-", "--simd", level.name});
    EXPECT_EQ(result.status, 1);
    EXPECT_NE(result.err.find("processor"), std::string::npos) << result.err;
  }
}

// Embree is a file that only --engine embree reads: what cannot be loaded in its place disturbs no other run.
TEST_F(Engines, WithoutEmbreeOnlyThatOneIsRefused) {
  write_text(cube_, kCube);
  const std::string directory = dir_ / "broken";
  std::filesystem::create_directory(directory);
  for (const char* const name : {"/libembree3.so.3", "/libembree4.so.4"}) write_text(directory + name, "");
  const CommandOptions options{.environment = {{"LD_LIBRARY_PATH", directory}}};
  const std::vector<std::string> words{"lattice", cube_, "-o", "-", "--resolution", "3"};
  EXPECT_EQ(run_raycone(words, options).status, 0);
  const std::vector<std::string> by_embree = with_more(words, {"--engine", "embree"});
  EXPECT_EQ(run_raycone(by_embree).status, 0);
  const CommandResult refused = run_raycone(by_embree, options);
  EXPECT_EQ(refused.status, 4);
  EXPECT_EQ(refused.out, "");
  EXPECT_EQ(std::ranges::count(refused.err, '\n'), 1) << refused.err;
  EXPECT_NE(refused.err.find("cube.obj: cannot load Embree: "), std::string::npos) << refused.err;
}

}  // namespace
}  // namespace raycone::test
