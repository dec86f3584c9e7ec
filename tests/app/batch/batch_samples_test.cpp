// raycone batch --sample. Black box: the real executable.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/app/batch/batch_fixture.h"

namespace raycone::test {
namespace {

namespace fs = std::filesystem;

class BatchSamples : public Batch {
 protected:
  BatchSamples() {
    put("a.obj");
    put("sub/b.obj", kTriangle);
  }

  static inline const std::string kSpec = "uniform=300,near=200:0.01";

  // Unlike that of lattices, without --resolution.
  [[nodiscard]] CommandResult sample(const std::vector<std::string>& more = {}, const std::string& spec = kSpec) const {
    return run_raycone(with_more({"batch", meshes_, "--out-dir", out_, "--sample", spec}, more));
  }
  // What `raycone points` writes for the mesh of this name.
  [[nodiscard]] std::string alone(const std::string& mesh, const std::string& format,
                                  const std::vector<std::string>& more = {}) const {
    const std::string output = dir_ / "alone." + format;
    EXPECT_EQ(run_raycone(with_more({"points", meshes_ + '/' + mesh, "--sample", kSpec, "-o", output}, more)).status,
              0);
    return read_text(output);
  }
  [[nodiscard]] std::size_t listed(const std::vector<std::string>& more, const std::string& spec = kSpec) const {
    std::vector<std::string> words = more;
    words.push_back("--dry-run");
    return static_cast<std::size_t>(std::ranges::count(sample(words, spec).out, '\n'));
  }
};

TEST_F(BatchSamples, GivesEachMeshWhatPointsGivesIt) {
  const std::vector<std::string> options{"--seed", "7", "--padding", "0.25", "--scale", "2"};
  ASSERT_EQ(sample(options).status, 0);
  EXPECT_EQ(statuses(rows()), (Statuses{{"a.obj", "ok"}, {"sub/b.obj", "ok"}}));
  EXPECT_EQ(rows().at("a.obj").output, "a.npz");
  for (const auto& [mesh, row] : rows()) {
    EXPECT_EQ(row.figures->samples, 500U);
    EXPECT_EQ(read_text(out_ + '/' + row.output), alone(mesh, "npz", options)) << mesh;
    EXPECT_NE(read_text(out_ + '/' + row.output), alone(mesh, "npz", {"--seed", "8"})) << mesh;
  }
  const std::vector<std::string> other{"--field", "winding,density", "--format", "csv"};
  ASSERT_EQ(sample(other).status, 0);
  EXPECT_EQ(read_text(out_ + "/sub/b.csv"), alone("sub/b.obj", "csv", other));
}

TEST_F(BatchSamples, AgainDoesNothingButWhatIsMissingOrOutOfDate) {
  ASSERT_EQ(sample().status, 0);
  EXPECT_EQ(listed({}), 0U);
  EXPECT_EQ(listed({"--threads", "1", "--engine", "embree"}), 0U) << "no effect";
  EXPECT_EQ(listed({"--seed", "2"}), 2U);
  EXPECT_EQ(listed({}, "uniform=300,near=200:0.02"), 2U);
  EXPECT_EQ(listed({"--field", "winding"}), 2U);
  EXPECT_EQ(listed({"--padding", "1"}), 2U);
  EXPECT_EQ(std::ranges::count(run({"--dry-run"}).out, '\n'), 2) << "lattices instead";

  fs::remove(out_ + "/a.npz");
  put("sub/b.obj", kCube);
  EXPECT_EQ(sample({"--dry-run"}).out, meshes_ + "/a.obj\toutput missing\n" + meshes_ + "/sub/b.obj\tmesh changed\n");
  ASSERT_EQ(sample().status, 0);
  EXPECT_EQ(listed({}), 0U);
  EXPECT_EQ(read_text(out_ + "/sub/b.npz"), read_text(out_ + "/a.npz")) << "two equal meshes";
}

TEST_F(BatchSamples, ShardsMakeTheSameAsOneRun) {
  put("c.obj", kCube);
  ASSERT_EQ(sample().status, 0);
  const auto whole = outputs_in(out_);
  EXPECT_EQ(whole.size(), 3U);
  out_ = dir_ / "shards";
  ASSERT_EQ(sample({"--shard", "2/2", "--threads", "1"}).status, 0);
  EXPECT_LT(outputs_in(out_).size(), 3U);
  ASSERT_EQ(sample({"--shard", "1/2"}).status, 0);
  EXPECT_EQ(outputs_in(out_), whole);
  EXPECT_EQ(listed({}), 0U);
}

TEST_F(BatchSamples, MeasuresOnlyWithFormatNone) {
  ASSERT_EQ(sample({"--format", "none"}).status, 0);
  EXPECT_TRUE(outputs_in(out_).empty());
  EXPECT_EQ(rows().at("a.obj").figures->samples, 500U);
}

TEST_F(BatchSamples, AMeshWithoutASurfaceCostsItsRow) {
  put("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  EXPECT_EQ(sample().status, 5);
  EXPECT_EQ(statuses(rows()), (Statuses{{"a.obj", "ok"}, {"flat.obj", "invalid"}, {"sub/b.obj", "ok"}}));
  EXPECT_NE(rows().at("flat.obj").message.find("no triangle has an area"), std::string::npos);
}

TEST_F(BatchSamples, RefusesWhatBelongsToLattices) {
  const auto expect_usage_error = [](const CommandResult& result, const std::string& message) {
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(result.err.rfind("raycone: " + message, 0), 0U) << result.err;
  };
  const std::vector<std::vector<std::string>> of_lattices{
      {"--resolution", "8"}, {"--voxel-size", "1"}, {"--like", "a.vdb"}, {"--centers"}, {"--double"}, {"--half"},
      {"--grid-name", "w"}};
  for (const std::vector<std::string>& option : of_lattices) {
    expect_usage_error(sample(option), "--sample: cannot be combined with " + option.front());
  }
  expect_usage_error(sample({"--padding", "3v"}), "--padding 3v: expected a distance");
  expect_usage_error(sample({"--format", "vdb"}), "--format vdb: expected npz or csv");
  expect_usage_error(sample({}, "uniform=0"), "--sample uniform=0: expected");
  expect_usage_error(run({"--seed", "2"}), "--seed 2: expected --sample with it");
  EXPECT_FALSE(fs::exists(out_));
}

}  // namespace
}  // namespace raycone::test
