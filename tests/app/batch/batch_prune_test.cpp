// raycone batch --prune: rows of meshes that are gone. Black box.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/app/batch/batch_fixture.h"

namespace raycone::test {
namespace {

namespace fs = std::filesystem;

class BatchPrune : public Batch {
 protected:
  [[nodiscard]] Statuses kept() const { return statuses(rows()); }
  [[nodiscard]] CommandResult run_on(const std::vector<std::string>& operands,
                                     const std::vector<std::string>& more = {"--prune"}) const {
    return run_raycone(with_more({"batch", "--out-dir", out_, "--resolution", "8"}, with_more(operands, more)));
  }
};

TEST_F(BatchPrune, RemovesRowsAndNothingElse) {
  for (const char* const name : {"a.obj", "b.obj", "sub/c.obj"}) put(name);
  put("bad.obj", "broken");
  EXPECT_EQ(run().status, 5);
  const auto outputs = outputs_in(out_);
  for (const char* const name : {"/b.obj", "/sub/c.obj", "/bad.obj"}) fs::remove(meshes_ + name);
  EXPECT_EQ(run().status, 0) << "rows of meshes that the command does not name do not count";
  EXPECT_EQ(kept().size(), 4U);
  EXPECT_EQ(run({"--prune", "--dry-run"}).out,
            meshes_ + "/b.obj\tgone\n" + meshes_ + "/bad.obj\tgone\n" + meshes_ + "/sub/c.obj\tgone\n");
  EXPECT_EQ(kept().size(), 4U);
  const CommandResult result = run({"--prune"});
  EXPECT_EQ(result.status, 0);
  EXPECT_TRUE(result.err.starts_with("raycone: 0 meshes done, 0 failed in ")) << result.err;
  EXPECT_NE(result.err.find("; 1 skipped: up to date; 3 rows of meshes that are gone removed"), std::string::npos)
      << result.err;
  EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << "one summary line";
  EXPECT_EQ(kept(), (Statuses{{"a.obj", "ok"}}));
  EXPECT_EQ(outputs_in(out_), outputs);
  EXPECT_EQ(read_text(out_ + "/batch-state.csv").find("b.obj"), std::string::npos);
  put("b.obj");
  EXPECT_EQ(run({"--prune", "--dry-run"}).out, meshes_ + "/b.obj\tnew\n");
}

TEST_F(BatchPrune, KeepsRowsOfMeshesThatAreThereUnderOtherOperands) {
  const std::string a = put("a.obj");
  put("sub/b.obj");
  ASSERT_EQ(run().status, 0);
  ASSERT_EQ(run_on({a}).status, 0);
  EXPECT_EQ(kept(), (Statuses{{"a.obj", "ok"}, {"sub/b.obj", "ok"}}));
  fs::rename(meshes_, dir_ / "moved");
  ASSERT_EQ(run_on({dir_ / "moved"}).status, 0) << "another directory, the same names";
  EXPECT_EQ(kept().size(), 2U);
  ASSERT_EQ(run_on({dir_ / "moved/a.obj"}).status, 0) << "of which the rows know now";
  EXPECT_EQ(kept().size(), 2U);
  fs::create_directory(meshes_);
  EXPECT_EQ(run({"--prune"}).status, 0);
  fs::remove_all(dir_ / "moved");
  EXPECT_NE(run({"--prune"}).err.find("no meshes found, no rows removed"), std::string::npos);
  EXPECT_EQ(kept().size(), 2U) << "rather a file system that is not mounted";
}

TEST_F(BatchPrune, LeavesOutNamesOfMeshesThatAreGone) {
  const std::string a = put("a.obj");
  const std::string b = put("b.obj");
  write_text(dir_ / "list", a + "\n" + b + "\n");
  ASSERT_EQ(run_on({"@" + dir_ / "list"}).status, 0);
  fs::remove(b);
  for (int again = 0; again < 2; ++again) {
    const CommandResult result = run_on({"@" + dir_ / "list"});
    EXPECT_EQ(result.status, 0) << again;
    EXPECT_NE(result.err.find("warning: " + b + ": not there, left out"), std::string::npos) << result.err;
    EXPECT_EQ(kept(), (Statuses{{"a.obj", "ok"}})) << again;
  }
  EXPECT_EQ(run_on({"@" + dir_ / "list"}, {}).status, 5);
  EXPECT_EQ(kept(), (Statuses{{"a.obj", "ok"}, {"b.obj", "invalid"}}));
}

TEST_F(BatchPrune, OfAShardIsOfItsOwnRowsAndOfAllWithoutShards) {
  for (int i = 0; i < 8; ++i) put(std::to_string(i) + ".obj");
  for (const char* const shard : {"1/2", "2/2"}) ASSERT_EQ(run({"--shard", shard}).status, 0);
  const auto rows_of = [this](int shard) { return rows_in(out_ + "/results-" + std::to_string(shard) + "-of-2.csv"); };
  const Rows of_both[] = {rows_of(1), rows_of(2)};
  for (const Rows& some : of_both) fs::remove(meshes_ + "/" + some.begin()->first);
  EXPECT_EQ(run({"--shard", "1/2", "--prune", "--dry-run"}).out,
            meshes_ + "/" + of_both[0].begin()->first + "\tgone\n");
  ASSERT_EQ(run({"--shard", "1/2", "--prune"}).status, 0);
  EXPECT_FALSE(rows_of(1).contains(of_both[0].begin()->first));
  EXPECT_TRUE(rows_of(2).contains(of_both[1].begin()->first)) << "the table of another shard";
  ASSERT_EQ(run({"--prune"}).status, 0);
  EXPECT_FALSE(rows_of(2).contains(of_both[1].begin()->first)) << "the report would show it";
  EXPECT_EQ(rows().size(), 6U);
}

TEST_F(BatchPrune, LeavesAllRowsWhereResultsCannotBeWritten) {
  put("a.obj");
  put("b.obj");
  ASSERT_EQ(run().status, 0);
  fs::remove(meshes_ + "/b.obj");
  EXPECT_EQ(run({"--prune", "--exit-zero"}, {.file_size_limit = 300}).status, 3);
  EXPECT_EQ(kept().size(), 2U);
}

}  // namespace
}  // namespace raycone::test
