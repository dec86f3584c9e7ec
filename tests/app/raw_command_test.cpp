// `raycone points --raw`. Black box: the real executable.
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "tests/app/meshes.h"
#include "tests/support/bytes.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_directory.h"

namespace raycone::test {
namespace {

class RawOption : public testing::Test {
 protected:
  RawOption() { write_text(mesh_, kCube); }

  CommandResult raw(const std::string& input, const std::vector<std::string>& more) const {
    return run_raycone(with_more({"points", mesh_, "-", "--quiet", "--raw"}, more), {.input = input});
  }

  TemporaryDirectory dir_;
  std::string mesh_ = dir_ / "mesh.obj";
};

TEST_F(RawOption, TakesTriplesAndReturnsValues) {
  EXPECT_EQ(raw(bytes_of<double>({.5, .5, .5, 2, 0, 0}), {"f64"}).out, bytes_of<double>({1, 0}));
  EXPECT_EQ(raw(bytes_of<float>({.5F, .5F, .25F, 2, 0, 0}), {"f32", "--field", "sdf,inside"}).out,
            bytes_of<float>({-.25F, 1, 1, 0}));
  EXPECT_EQ(raw("", {"f64"}).out, "");
}

TEST_F(RawOption, RefusesDistancesBeyondFloats) {
  const std::string far = bytes_of<float>({3e38F, 3e38F, 3e38F});
  const CommandResult result = raw(far, {"f32", "--field", "sdf"});
  EXPECT_EQ(result.status, 3);
  EXPECT_EQ(result.out, "");
  EXPECT_NE(
      result.err.find(": the distance 5.19615e+38 is beyond 3.40282e+38, the range of 32 bits; expected --raw f64"),
      std::string::npos)
      << result.err;
  EXPECT_EQ(raw(far, {"f32", "--field", "inside"}).out, bytes_of<float>({0}));
}

TEST_F(RawOption, ReadsFilesOfAnyNameAndWritesThoseThatPromiseNoOtherFormat) {
  write_text(dir_ / "points.csv", bytes_of<double>({.5, .5, .5}));
  const auto to = [&](const char* name) {
    return run_raycone({"points", mesh_, dir_ / "points.csv", "--raw", "f64", "-o", dir_ / name});
  };
  for (const char* const name : {"out.raw", "out.f64", "out"}) {
    const CommandResult result = to(name);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(read_text(dir_ / name), bytes_of<double>({1}));
  }
  for (const char* const name : {"out.npy", "out.csv", "out.NPZ"}) {
    const CommandResult result = to(name);
    EXPECT_EQ(result.status, 1) << name;
    EXPECT_NE(result.err.find("its extension names a format, but --raw writes bare numbers"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(std::string(dir_ / name)));
  }
}

TEST_F(RawOption, AnswersEachPointOfAReaderThatWaits) {
  Command command(raycone_command({"points", mesh_, "-", "--quiet", "--raw", "f64"}));
  const std::string half = bytes_of<double>({.5, .5});
  command.write(half);  // no question yet
  command.write(bytes_of<double>({.5}));
  EXPECT_EQ(command.read_bytes(8), bytes_of<double>({1}));
  command.write(bytes_of<double>({2, .5, .5}));
  EXPECT_EQ(command.read_bytes(8), bytes_of<double>({0}));
  command.close_input();
  EXPECT_EQ(command.wait().status, 0);
}

TEST_F(RawOption, NamesTheByteOfWhatIsNoPoint) {
  const CommandResult cut = raw(bytes_of<double>({1, 2, 3, 4}), {"f64"});
  EXPECT_EQ(cut.status, 2);
  EXPECT_EQ(cut.err, "raycone: -:byte 32: end of the input 8 bytes into a point, expected 24\n");
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const CommandResult bad = raw(bytes_of<float>({1, 2, 3, 4, nan, 5}), {"f32"});
  EXPECT_EQ(bad.status, 2);
  EXPECT_EQ(bad.err, "raycone: -:byte 16: coordinate nan, expected a finite number\n");
}

TEST_F(RawOption, RefusesContradictions) {
  EXPECT_EQ(raw("", {"f16"}).err, "raycone: --raw f16: expected f64 or f32\n");
  EXPECT_EQ(raw("", {"f64", "--format", "csv"}).err, "raycone: --raw: cannot be combined with --format\n");
  EXPECT_EQ(raw("", {"f64", "--columns", "1,2,3"}).err, "raycone: --raw: cannot be combined with --columns\n");
}

}  // namespace
}  // namespace raycone::test
