#include "app/batch/results_files.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <map>
#include <thread>
#include <vector>

#include "io/files/file_error.h"
#include "tests/app/meshes.h"
#include "tests/support/error_text.h"
#include "tests/support/temporary_directory.h"

namespace raycone::test {
namespace {

BatchRecord record(const std::string& mesh, std::uint64_t faces = 1, std::int64_t finished = 1) {
  BatchRecord result;
  result.row.mesh = mesh;
  result.row.figures = MeshFigures{.faces = faces, .read_s = 0.5};
  result.row.output = mesh + ".vdb";
  result.row.message = "a \"quoted\", message";
  result.row.warnings = "reversed inconsistent";
  result.origin = RowOrigin{.stamp = {7, 8, 9, 10},
                            .buffers = {{"a,b.bin", {1, 2, 3, 4}, "hash"}, {.path = "c.vdb", .sha256 = "other"}},
                            .written = {{11, 12}, {}},
                            .version = "1",
                            .options = "--a\n--b",
                            .finished = finished,
                            .path = "/d/" + mesh};
  return result;
}

class ResultsFilesTest : public testing::Test {
 protected:
  [[nodiscard]] std::string results() const { return read_text(dir_ / "results.csv"); }

  TemporaryDirectory dir_;
  ResultsFiles files_{dir_.path().string(), std::nullopt};
};

std::vector<std::string> meshes_of(const BatchRecords& records) {
  std::vector<std::string> meshes;
  for (const auto& [mesh, one] : records) meshes.push_back(mesh);
  return meshes;
}

using Names = std::vector<std::string>;

TEST_F(ResultsFilesTest, KeepRowsAndWhatTheyWereMadeFrom) {
  EXPECT_TRUE(files_.read().empty());
  files_.append(record("b", 2));
  files_.append(record("a", 1));
  const BatchRecords read = files_.read();
  ASSERT_EQ(meshes_of(read), (Names{"a", "b"}));
  const BatchRecord& b = read.at("b");
  EXPECT_EQ(to_record(b.row), to_record(record("b", 2).row));
  ASSERT_TRUE(b.origin);
  EXPECT_EQ(b.origin->stamp, (FileStamp{7, 8, 9, 10}));
  EXPECT_EQ(b.origin->buffers, record("b").origin->buffers);
  EXPECT_EQ(b.origin->written, record("b").origin->written);
  EXPECT_EQ(b.origin->options, "--a\n--b");
  EXPECT_EQ(b.origin->path, "/d/b");
  EXPECT_LT(results().find("\nb,"), results().find("\na,")) << "as they come";
  files_.merge({});
  EXPECT_GT(results().find("\nb,"), results().find("\na,")) << "sorted";
}

TEST_F(ResultsFilesTest, SurviveWritersKilledAtAnyByte) {
  files_.append(record("a"));
  files_.append(record("b"));
  const std::map<std::string, std::string> whole{{"results.csv", results()},
                                                 {"batch-state.csv", read_text(dir_ / "batch-state.csv")}};
  for (const auto& [cut, text] : whole) {
    for (std::size_t size = 0; size <= text.size(); ++size) {
      for (const auto& [name, all] : whole) write_text(dir_ / name, name == cut ? all.substr(0, size) : all);
      files_.append(record("c"));
      const BatchRecords read = files_.read();
      ASSERT_TRUE(read.contains("c")) << cut << ' ' << size;
      EXPECT_TRUE(read.at("c").origin) << cut << ' ' << size;
      for (const auto& [mesh, one] : read) EXPECT_EQ(to_record(one.row), to_record(record(mesh).row)) << size;
    }
  }
}

// Rows behind it would be taken for a line that a killed writer left, and dropped. (Of batch-state.csv, whose rows have
// line feeds, they may be: those meshes are evaluated again.)
TEST_F(ResultsFilesTest, WithAStrayQuotationMarkAreLeftAsTheyAre) {
  for (const char* const mesh : {"a", "b", "c"}) files_.append(record(mesh));
  const std::string whole = results();
  const std::string damaged = std::string(whole).insert(whole.find("\nb,") + 2, "\"");
  write_text(dir_ / "results.csv", damaged);
  const auto expect_refused = [&](const std::function<void()>& action) {
    const std::string error = error_text<InputError>(action);
    EXPECT_TRUE(error.ends_with("results.csv:3: a quotation mark without its end, expected a row")) << error;
    EXPECT_EQ(results(), damaged);
  };
  const ResultsFiles others(dir_.path().string(), std::nullopt);
  expect_refused([&] { (void)others.read(); });
  expect_refused([&] { others.append(record("d")); });
  expect_refused([&] { others.forget({{"a", 6}}); });
  expect_refused([&] { others.merge({{"d", record("d")}}); });
  expect_refused([&] { (void)read_all_results(dir_.path().string()); });
  write_text(dir_ / "results.csv", whole);
  EXPECT_EQ(files_.read().size(), 3U);
}

TEST_F(ResultsFilesTest, WaitForALockNoLongerThanASignal) {
  const int holder = open(dir_.path().c_str(), O_RDONLY | O_DIRECTORY);
  ASSERT_EQ(flock(holder, LOCK_EX), 0);
  sigset_t held, before;
  sigemptyset(&held);
  sigaddset(&held, SIGUSR1);
  pthread_sigmask(SIG_BLOCK, &held, &before);
  raise(SIGUSR1);
  EXPECT_THROW(files_.append(record("a")), OutputError);
  int taken = 0;
  sigwait(&held, &taken);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  std::thread release([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    close(holder);
  });
  files_.append(record("a"));
  release.join();
  EXPECT_EQ(files_.read().size(), 1U);
}

TEST_F(ResultsFilesTest, DoNotTrustAnOriginOfAnotherRow) {
  files_.append(record("a", 1));
  const std::string old_row = results();
  files_.append(record("a", 2));
  write_text(dir_ / "results.csv", old_row);  // the new row was never written
  EXPECT_FALSE(files_.read().at("a").origin);
}

TEST_F(ResultsFilesTest, ForgetAndMerge) {
  for (const char* const mesh : {"a", "b", "c"}) files_.append(record(mesh, 1, 5));
  files_.forget({{"b", 6}});
  EXPECT_EQ(meshes_of(files_.read()), (Names{"a", "c"}));
  files_.merge({{"a", record("a", 7, 4)}, {"c", record("c", 7, 6)}, {"d", record("d", 7)}});
  const BatchRecords read = files_.read();
  EXPECT_EQ(meshes_of(read), (Names{"a", "c", "d"}));
  EXPECT_EQ(read.at("a").row.figures->faces, 1U) << "what is there is newer";
  EXPECT_EQ(read.at("c").row.figures->faces, 7U);
}

TEST_F(ResultsFilesTest, OfShardsAreReadTogether) {
  const std::string directory = dir_.path().string();
  files_.append(record("a", 1, 1));
  ResultsFiles(directory, Shard{1, 2}).append(record("a", 2, 2));
  ResultsFiles(directory, Shard{2, 2}).append(record("b", 3));
  write_text(dir_ / "results-of-mine.csv", "not a file of ours");
  write_text(dir_ / "results-01-of-2.csv", "nor this");
  const BatchRecords all = read_all_results(directory);
  EXPECT_EQ(meshes_of(all), (Names{"a", "b"}));
  EXPECT_EQ(all.at("a").row.figures->faces, 2U) << "the latest counts";
}

// A batch that began a mesh again, and was killed before its row: the output may be its own already.
TEST_F(ResultsFilesTest, DoNotTrustRowsOfOtherShardsFromBeforeAStart) {
  const std::string directory = dir_.path().string();
  const ResultsFiles shard(directory, Shard{1, 2});
  for (const char* const mesh : {"a", "b", "c"}) files_.append(record(mesh, 1, 10));
  shard.forget({{"a", 11}, {"b", 11}});
  shard.append(record("b", 2, 12));
  shard.merge({});
  const BatchRecords all = read_all_results(directory);
  EXPECT_TRUE(all.at("a").origin->superseded);
  EXPECT_FALSE(all.at("b").origin->superseded);
  EXPECT_EQ(all.at("b").row.figures->faces, 2U);
  EXPECT_FALSE(all.at("c").origin->superseded);
  files_.append(record("a", 3, finished(all.at("a")) + 1));
  EXPECT_FALSE(read_all_results(directory).at("a").origin->superseded);
}

TEST_F(ResultsFilesTest, DoNotTrustStatesOfVersionsBefore) {
  for (const CsvRecord& old : former_origin_columns()) {
    files_.append(record("a"));
    write_text(dir_ / "batch-state.csv", csv_line(old) + csv_line(CsvRecord(old.size(), "1")));
    EXPECT_FALSE(files_.read().at("a").origin);
    files_.forget({{"b", 1}});
    files_.append(record("c"));
    EXPECT_TRUE(files_.read().at("c").origin);
  }
}

TEST_F(ResultsFilesTest, DropRowsWithoutAName) {
  write_text(dir_ / "results.csv", csv_line(result_columns()) + csv_line(to_record(record("").row)));
  EXPECT_TRUE(files_.read().empty());
}

TEST_F(ResultsFilesTest, RemoveRowsOfAllShards) {
  const std::string directory = dir_.path().string();
  const ResultsFiles shard(directory, Shard{1, 2});
  for (const char* const mesh : {"a", "b"}) files_.append(record(mesh));
  shard.append(record("b"));
  files_.remove({"a", "x"});
  EXPECT_EQ(meshes_of(files_.read()), Names{"b"});
  remove_from_all_results(directory, {"b"});
  EXPECT_TRUE(files_.read().empty());
  EXPECT_TRUE(shard.read().empty());
}

TEST_F(ResultsFilesTest, KeepRowsOfTheVersionBefore) {
  CsvRecord row = to_record(record("a").row);
  row.resize(former_result_columns().size());
  write_text(dir_ / "results.csv", csv_line(former_result_columns()) + csv_line(row));
  EXPECT_EQ(meshes_of(files_.read()), Names{"a"});
  files_.forget({{"b", 1}});
  files_.append(record("c"));
  EXPECT_EQ(meshes_of(files_.read()), (Names{"a", "c"}));
  EXPECT_EQ(results().rfind(csv_line(result_columns()), 0), 0U);
}

TEST_F(ResultsFilesTest, RefuseTablesOfOthers) {
  write_text(dir_ / "results.csv", "name,value\nx,1\n");
  EXPECT_THROW((void)files_.read(), InputError);
}

TEST_F(ResultsFilesTest, MayBeWrittenBySeveralAtOnce) {
  std::vector<std::thread> writers;
  for (int i = 0; i < 4; ++i) {
    writers.emplace_back([this, i] {
      const ResultsFiles mine(dir_.path().string(), std::nullopt);
      BatchRecords records;
      for (int j = 0; j < 20; ++j) {
        const BatchRecord one = record(std::to_string(i) + "-" + std::to_string(j));
        mine.append(one);
        records.emplace(one.row.mesh, one);
      }
      mine.merge(records);
    });
  }
  for (std::thread& writer : writers) writer.join();
  const BatchRecords all = files_.read();
  EXPECT_EQ(all.size(), 80U);
  for (const auto& [mesh, one] : all) EXPECT_TRUE(one.origin) << mesh;
}

// Names of tables tell, whatever they hold; of many that are missing a few are named.
TEST_F(ResultsFilesTest, TellWhichShardsAreMissing) {
  const std::string directory = dir_.path().string();
  const auto put = [&](const std::string& name) { write_text(dir_ / name, ""); };
  using Lines = std::vector<std::string>;
  EXPECT_EQ(missing_shards(directory), Lines());
  put("results-1-of-1.csv");
  put("results-9-of-4.csv");  // no shard
  put("batch-state-1-of-7.csv");
  EXPECT_EQ(missing_shards(directory), Lines());
  put("results-2-of-5.csv");
  put("results-5-of-5.csv");
  EXPECT_EQ(missing_shards(directory), Lines{"no results of shards 1, 3 and 4 of 5"});
  put("results-1-of-1000000000000000000.csv");
  EXPECT_EQ(missing_shards(directory),
            (Lines{"no results of shards 1, 3 and 4 of 5",
                   "no results of shards 2, 3, 4, 5, 6, 7, 8, 9, 10, 11 and 999999999999999989 more of "
                   "1000000000000000000"}));
  put("results.csv");
  EXPECT_EQ(missing_shards(directory), Lines());
}

TEST_F(ResultsFilesTest, NamesAreReserved) {
  for (const char* const name : {"results.csv", "batch-state.csv", "results-1-of-3.csv", "batch-state-10-of-12.csv"}) {
    EXPECT_TRUE(is_results_file(name)) << name;
  }
  for (const char* const name : {"results.vdb", "sub/results.csv", "results-a.csv", "results-1-of-.csv"}) {
    EXPECT_FALSE(is_results_file(name)) << name;
  }
}

}  // namespace
}  // namespace raycone::test
