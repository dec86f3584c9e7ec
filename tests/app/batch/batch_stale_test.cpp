// Sequences of batches: rows that must not be trusted any more, and failures that must not stay. Black box.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "tests/app/batch/batch_fixture.h"

namespace raycone::test {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

std::string cube_of(char size) {
  std::string text = kCube;
  for (std::size_t at = text.find('f'); at-- > 0;) {
    if (text[at] == '1') text[at] = size;
  }
  return text;
}

// As if it had been there for long.
void age(const std::string& path) {
  fs::last_write_time(path, fs::file_time_type::clock::now() - std::chrono::hours(1));
}

class BatchStale : public Batch {
 protected:
  [[nodiscard]] static std::vector<std::string> words(const std::vector<std::string>& operands, const std::string& out,
                                                      const std::vector<std::string>& more = {}) {
    const std::vector<std::string> operands_and_more = with_more(operands, more);
    return with_more({"batch", "--out-dir", out, "--resolution", "8", "--format", "csv", "--quiet"}, operands_and_more);
  }
  [[nodiscard]] CommandResult run_on(const std::vector<std::string>& operands,
                                     const std::vector<std::string>& more = {}) const {
    return run_raycone(words(operands, out_, more));
  }
  // What would be done.
  [[nodiscard]] std::string planned(const std::vector<std::string>& operands,
                                    const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all = more;
    all.push_back("--dry-run");
    return run_on(operands, all).out;
  }
  [[nodiscard]] std::string fresh(const std::string& operand, const std::string& name) const {
    const std::string out = dir_ / "fresh";
    fs::remove_all(out);
    EXPECT_EQ(run_raycone(words({operand}, out)).status, 0);
    return read_text(out + '/' + name);
  }
};

TEST_F(BatchStale, BuffersAreThoseBesideTheMeshOfToday) {
  for (const auto& [version, size] : {std::pair("v1", 1.0F), {"v2", 2.0F}}) {
    put(std::string(version) + "/box.gltf", gltf_of("box.bin"));
    put(std::string(version) + "/box.bin", triangle_corners(size));
  }
  const std::string first = meshes_ + "/v1", second = meshes_ + "/v2";
  ASSERT_EQ(run_on({first}).status, 0);
  EXPECT_EQ(planned({second}), second + "/box.gltf\ta file that the mesh refers to changed\n");
  ASSERT_EQ(run_on({second}).status, 0);
  EXPECT_EQ(read_text(out_ + "/box.csv"), fresh(second, "box.csv"));
  fs::rename(second, dir_ / "moved");
  EXPECT_EQ(planned({dir_ / "moved"}), "") << "its files have moved with it";
}

TEST_F(BatchStale, WorkingDirectoriesDoNotMatter) {
  put("box.gltf", gltf_of("sub/box.bin"));
  put("sub/box.bin", triangle_corners(1));
  const auto run_there = [this](const std::string& more) {
    std::string line = "cd '" + meshes_ + "' && exec";
    for (const std::string& word : raycone_command(words({"box.gltf"}, out_))) line += " '" + word + "'";
    return Command({"/bin/sh", "-c", line + more}).wait();
  };
  ASSERT_EQ(run_there("").status, 0);
  EXPECT_EQ(run_there(" --dry-run").out, "");
  EXPECT_EQ(planned({meshes_}), "");
  put("sub/box.bin", triangle_corners(2));
  EXPECT_NE(planned({meshes_}), "");
}

TEST_F(BatchStale, WhatWouldHoldAnywayChangesNothing) {
  const std::string mesh = put("a.obj");
  ASSERT_EQ(run_on({mesh}).status, 0);
  EXPECT_EQ(planned({mesh}, {"--orient", "keep", "--weld", "exact", "--scale", "1.0", "--tolerance", "1e-10"}), "");
  EXPECT_EQ(planned({mesh}, {"--field", "winding"}), "");
  EXPECT_EQ(planned({mesh}, {"--scale", "2"}), mesh + "\toptions changed\n");
  const std::vector<std::string> sampled{"batch", mesh, "--out-dir", out_, "--sample", "uniform=5", "--quiet"};
  ASSERT_EQ(run_raycone(sampled).status, 0);
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), sampled.begin(), sampled.end());
    more.push_back("--dry-run");
    return run_raycone(more).out;
  };
  EXPECT_EQ(with({"--dtype", "f64", "--seed", "1"}), "");
  EXPECT_EQ(with({"--field", "winding"}), mesh + "\toptions changed\n") << "more is asked about drawn points";
}

TEST_F(BatchStale, GridsAreKnownByWhatTheyHold) {
  const std::string mesh = put("a.obj");
  const std::string grid = dir_ / "grid.npz";
  const auto make_grid = [&](const char* resolution) {
    ASSERT_EQ(run_raycone({"lattice", mesh, "-o", grid, "--resolution", resolution, "--quiet"}).status, 0);
  };
  const auto like = [&](const std::string& path, const std::vector<std::string>& more) {
    return run_raycone(
        with_more({"batch", mesh, "--out-dir", out_, "--format", "csv", "--quiet", "--like", path}, more));
  };
  make_grid("4");
  ASSERT_EQ(like(grid, {}).status, 0);
  make_grid("5");
  EXPECT_EQ(like(grid, {"--dry-run"}).out, mesh + "\toptions changed\n");
  make_grid("4");
  EXPECT_EQ(like(grid, {"--dry-run"}).out, "") << "another time stamp, but the same content";
  write_text(mesh, "broken");
  fs::last_write_time(grid, fs::file_time_type::clock::now());  // long ago, where runs are slow
  EXPECT_EQ(like(grid, {}).status, 5);
  age(grid);
  EXPECT_EQ(like(grid, {"--dry-run"}).out, mesh + "\toptions changed\n") << "it had just been made";
  std::this_thread::sleep_for(milliseconds(2100));
  EXPECT_EQ(like(grid, {}).status, 5);
  EXPECT_EQ(like(grid, {"--dry-run"}).out, "");
}

TEST_F(BatchStale, OutputsOfAnotherMeshAreNotTakenForItsOwn) {
  const std::string one = put("a.obj"), other = put("a.off", "OFF\n3 1 0\n0 0 0\n2 0 0\n0 2 0\n3 0 1 2\n");
  ASSERT_EQ(run_on({one}).status, 0);
  ASSERT_EQ(run_on({other}).status, 0);
  EXPECT_EQ(planned({one}), one + "\toutput changed\n");
  ASSERT_EQ(run_on({one}).status, 0);
  EXPECT_EQ(read_text(out_ + "/a.csv"), fresh(one, "a.csv"));
}

TEST_F(BatchStale, OutputsThatChangedAreMadeAgain) {
  const std::string mesh = put("a.obj");
  ASSERT_EQ(run_on({mesh}).status, 0);
  const std::string output = out_ + "/a.csv";
  const std::string text = read_text(output);
  fs::remove(output);
  fs::create_directory(output);
  EXPECT_EQ(planned({mesh}), mesh + "\toutput changed\n");
  fs::remove(output);
  EXPECT_EQ(planned({mesh}), mesh + "\toutput missing\n");
  write_text(output, text);
  EXPECT_EQ(planned({mesh}), mesh + "\toutput changed\n") << "of another time";
  ASSERT_EQ(run_on({mesh}).status, 0);
  // As cp -a and rsync -t do.
  const auto time = fs::last_write_time(output);
  fs::rename(output, dir_ / "saved");
  write_text(output, text);
  fs::last_write_time(output, time);
  EXPECT_EQ(planned({mesh}), "");
}

TEST_F(BatchStale, OutputsWhereLinksLeadAreChecked) {
  const std::string mesh = put("a.obj");
  fs::create_directories(out_);
  fs::create_directories(dir_ / "elsewhere");
  fs::create_symlink(dir_ / "elsewhere/a.csv", out_ + "/a.csv");
  ASSERT_EQ(run_on({mesh}).status, 0);
  EXPECT_EQ(planned({mesh}), "");
  write_text(dir_ / "elsewhere/a.csv", "another");
  EXPECT_EQ(planned({mesh}), mesh + "\toutput changed\n");
  fs::remove(out_ + "/a.csv");
  fs::create_symlink("/dev/null", out_ + "/a.csv");
  ASSERT_EQ(run_on({mesh}).status, 0);
  EXPECT_EQ(planned({mesh}), "") << "a device holds nothing that could change";
}

// A killed worker leaves its temporary file where the output was to be.
TEST_F(BatchStale, TemporaryFilesWhereLinksLeadAreRemoved) {
  const std::string mesh = put("a.obj", triangle_soup(2000));
  const std::string elsewhere = dir_ / "elsewhere";
  fs::create_directories(out_);
  fs::create_directories(elsewhere);
  fs::create_symlink(elsewhere + "/a.csv", out_ + "/a.csv");
  EXPECT_EQ(run_on({mesh}, {"--resolution", "400", "--timeout", "1"}).status, 5);
  EXPECT_TRUE(fs::is_empty(elsewhere));
  Command command(raycone_command(words({mesh}, out_, {"--resolution", "400"})));
  EXPECT_TRUE(becomes_true([&elsewhere] { return !fs::is_empty(elsewhere); }));
  command.send_signal(SIGKILL);
  (void)command.wait();
  EXPECT_TRUE(becomes_true([&] {
    EXPECT_EQ(run_on({mesh}).status, 0);
    return std::distance(fs::directory_iterator(elsewhere), {}) == 1;
  }));
}

// The file is the same before and after the batch, but not while it is read.
TEST_F(BatchStale, MeshesAreKnownAsTheyWereRead) {
  fs::create_directories(meshes_);
  const std::string blocked = meshes_ + "/0.obj";
  ASSERT_EQ(mkfifo(blocked.c_str(), 0600), 0);
  const std::string there = put("dir/a.obj");
  put("dir/b.obj", cube_of('2'));
  put("dir/c.obj");
  const std::string link = meshes_ + "/link.obj", gone = meshes_ + "/gone.obj";
  fs::create_symlink("dir/a.obj", link);
  fs::create_symlink("dir/c.obj", gone);
  std::this_thread::sleep_for(milliseconds(2100));  // their stamps are to be trusted
  const std::vector<std::string> operands{blocked, link, gone};
  Command command(raycone_command(words(operands, out_, {"--jobs", "1", "--threads", "1"})));
  {
    std::ofstream pipe;
    // Opens when the worker does. The others are planned then.
    pipe.open(blocked);
    fs::remove(link);
    fs::create_symlink("dir/b.obj", link);
    fs::remove(gone);
    pipe << kCube;
  }
  EXPECT_EQ(command.wait().status, 5);
  fs::remove(link);
  fs::create_symlink("dir/a.obj", link);
  fs::create_symlink("dir/c.obj", gone);
  const std::string again = planned({link, gone});
  EXPECT_NE(again.find(link + "\tmesh changed\n"), std::string::npos) << again;
  EXPECT_NE(again.find(gone + "\tmesh changed\n"), std::string::npos) << again;
  ASSERT_EQ(run_on({link, gone}).status, 0);
  EXPECT_EQ(read_text(out_ + "/link.csv"), fresh(there, "a.csv"));
  fs::remove(gone);
  EXPECT_EQ(run_on({gone}).status, 5);
  EXPECT_EQ(planned({gone}), "") << "it is missing still";
}

// Hashes are told by workers, which have their own time for that.
TEST_F(BatchStale, HugeMeshesHoldUpNoOtherAndAreTriedAgainIfTheyMayReferToFiles) {
  const auto put_huge = [this](const std::string& name) {
    constexpr std::uintmax_t kTerabyte = std::uintmax_t{1} << 40;  // of nothing; minutes to hash
    put(name, "");
    fs::resize_file(meshes_ + '/' + name, kTerabyte);
    age(meshes_ + '/' + name);
  };
  put_huge("a.glb");
  put_huge("b.stl");
  age(put("c.obj"));
  std::this_thread::sleep_for(milliseconds(2100));  // their stamps are to be trusted
  EXPECT_EQ(run_on({meshes_}, {"--timeout", "1"}).status, 5);
  const auto results = rows();
  EXPECT_EQ(statuses(results), (Statuses{{"a.glb", "memory"}, {"b.stl", "memory"}, {"c.obj", "ok"}}));
  EXPECT_EQ(results.at("a.glb").sha256 + results.at("b.stl").sha256, "") << "not known";
  EXPECT_EQ(planned({meshes_}, {"--timeout", "1"}), meshes_ + "/a.glb\tnot known what it was read from\n");
}

TEST_F(BatchStale, MeshesThatTheSystemDoesNotReadAreTriedAgain) {
  fs::create_directories(meshes_);
  const std::string mesh = meshes_ + "/a.obj";
  fs::create_symlink("/proc/self/mem", mesh);  // an input/output error, as of a damaged disk
  EXPECT_EQ(run_on({mesh}).status, 5);
  EXPECT_EQ(statuses(rows()), (Statuses{{"a.obj", "invalid"}}));
  EXPECT_EQ(planned({mesh}), mesh + "\tnot known what it was read from\n");
}

TEST_F(BatchStale, OutputsThatWouldReplaceABufferAreTriedAgain) {
  put("box.gltf", gltf_of("box.csv"));
  put("box.csv", triangle_corners(1));
  const std::vector<std::string> all = words({meshes_}, meshes_);
  EXPECT_EQ(run_raycone(all).status, 5);
  EXPECT_EQ(statuses(rows_in(meshes_ + "/results.csv")), (Statuses{{"box.gltf", "unwritable"}}));
  EXPECT_EQ(read_text(meshes_ + "/box.csv"), triangle_corners(1));
}

TEST_F(BatchStale, RowsThatLostTheirOriginBeatOlderOnesOfShards) {
  const std::string mesh = put("a.obj");
  ASSERT_EQ(run_on({mesh}, {"--shard", "1/1"}).status, 0);
  const std::string state = out_ + "/batch-state.csv";
  const std::string output = read_text(out_ + "/a.csv");
  const auto time = fs::last_write_time(out_ + "/a.csv");
  ASSERT_EQ(run_on({mesh}, {"--scale", "2"}).status, 0);
  ASSERT_TRUE(fs::remove(state));
  // So that the output does not tell.
  write_text(out_ + "/a.csv", output);
  fs::last_write_time(out_ + "/a.csv", time);
  EXPECT_EQ(planned({mesh}), mesh + "\tnot known how it was made\n");
  ASSERT_EQ(run_on({mesh}).status, 0);
  EXPECT_EQ(planned({mesh}), "");
  EXPECT_EQ(planned({mesh}, {"--shard", "1/1"}), "");
}

TEST_F(BatchStale, OriginsWithoutTheirRowsCountAsStarts) {
  const std::string mesh = put("a.obj");
  ASSERT_EQ(run_on({mesh}, {"--shard", "1/1"}).status, 0);
  const std::string output = read_text(out_ + "/a.csv");
  const auto time = fs::last_write_time(out_ + "/a.csv");
  ASSERT_EQ(run_on({mesh}, {"--scale", "2"}).status, 0);
  const std::string table = out_ + "/results.csv";
  const std::string text = read_text(table);
  write_text(table, text.substr(0, text.find('\n') + 1));
  write_text(out_ + "/a.csv", output);
  fs::last_write_time(out_ + "/a.csv", time);
  EXPECT_EQ(planned({mesh}), mesh + "\tnot known how it was made\n");
  ASSERT_EQ(run_on({mesh}).status, 0);
  EXPECT_EQ(planned({mesh}), "");
}

TEST_F(BatchStale, MemoryLimitsHoldForThoseThatLookForBuffers) {
  // Half a gigabyte of nothing, packed.
  const std::string part = put("part", "");
  fs::resize_file(part, std::uintmax_t{1} << 26);
  ASSERT_EQ(Command({"/bin/sh", "-c", "gzip '" + part + "'"}).wait().status, 0);
  std::string packed;
  for (int n = 0; n < 8; ++n) packed += read_text(part + ".gz");
  put("bomb.stl.gz", packed);
  put("bomb.gltf.gz", packed);
  const std::string program =
      "import resource, subprocess, sys; done = subprocess.run(sys.argv[1:]); "
      "print(done.returncode, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss >> 10)";
  std::vector<std::string> all{"/usr/bin/env", "python3", "-c", program};
  const std::vector<std::string> batch =
      raycone_command(words({meshes_}, out_, {"--memory-limit", "200M", "--jobs", "1", "--full-names"}));
  all.insert(all.end(), batch.begin(), batch.end());
  std::istringstream result(Command(all).wait().out);
  int status = 0, megabytes = 0;
  result >> status >> megabytes;
  EXPECT_EQ(status, 5);
  EXPECT_GT(megabytes, 10);
  EXPECT_LT(megabytes, 300);
  const auto failed = rows();
  EXPECT_EQ(failed.size(), 2U);
  for (const auto& [mesh, row] : failed) EXPECT_EQ(name_of(row.status), "memory") << mesh << ": " << row.message;
  const std::string again = planned({meshes_}, {"--full-names", "--memory-limit", "200M"});
  EXPECT_EQ(again, meshes_ + "/bomb.gltf.gz\tnot known what it was read from\n") << "only glTF refers to files";
}

TEST_F(BatchStale, TablesOfBatchesBelowAreNotReplaced) {
  put("sub/results.obj");
  const CommandResult result = run_on({meshes_});
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("sub/results.csv would have the name of a table of results"), std::string::npos)
      << result.err;
  EXPECT_EQ(run_on({meshes_}, {"--full-names"}).status, 0);
}

TEST_F(BatchStale, AFileThatIsCalledMinusIsNoStandardInput) {
  put("a.gltf", gltf_of("-"));
  put("-", triangle_corners(1));
  write_text(meshes_ + "/list", "-\na.gltf\n");
  std::string line = "cd '" + meshes_ + "' && exec";
  for (const std::string& word : raycone_command(words({"@list"}, out_))) line += " '" + word + "'";
  const auto run_there = [&line](const std::string& more) {
    Command command({"/bin/sh", "-c", line + more});  // with a standard input that does not end
    return command.wait();
  };
  EXPECT_EQ(run_there("").status, 5) << "the file is no mesh";
  EXPECT_EQ(statuses(rows()), (Statuses{{"-", "invalid"}, {"a.gltf", "ok"}}));
  EXPECT_EQ(run_there(" --dry-run").out, "");
}

TEST_F(BatchStale, RowsOfDirectoriesOfOtherCommandsStay) {
  const std::string mesh = put("a.obj");
  const std::string list = dir_ / "list";
  write_text(list, meshes_ + "/later/\n");
  EXPECT_EQ(run_on({'@' + list}).status, 5);
  ASSERT_EQ(run_on({mesh}).status, 0);
  EXPECT_EQ(statuses(rows()), (Statuses{{"a.obj", "ok"}, {"later/", "invalid"}}));
  put("later/b.obj");
  EXPECT_EQ(run_on({'@' + list}).status, 0);
  EXPECT_EQ(statuses(rows()), (Statuses{{"a.obj", "ok"}, {"b.obj", "ok"}}));
}

TEST_F(BatchStale, MeshesThatBecameDirectoriesArePruned) {
  put("a.obj");
  const std::string mesh = put("b.obj");
  ASSERT_EQ(run_on({meshes_}).status, 0);
  fs::remove(mesh);
  fs::create_directory(mesh);
  EXPECT_EQ(planned({meshes_}, {"--prune"}), mesh + "\tgone\n");
}

// A terminal suspends all processes of a batch; that time is nobody's.
// The mesh comes when the batch goes on, so that it takes hardly any time.
TEST_F(BatchStale, SuspensionIsNoTimeOfTheMeshs) {
  fs::create_directories(meshes_);
  const std::string mesh = meshes_ + "/a.obj";
  ASSERT_EQ(mkfifo(mesh.c_str(), 0600), 0);
  std::string line = "exec setsid";  // a group of its own
  for (const std::string& word : raycone_command(words({mesh}, out_, {"--resolution", "8", "--timeout", "4"}))) {
    line += " '" + word + "'";
  }
  Command command({"/bin/sh", "-c", line});
  std::ofstream pipe(mesh);  // opens when the worker does
  kill(-command.process(), SIGSTOP);
  std::this_thread::sleep_for(milliseconds(6000));
  kill(-command.process(), SIGCONT);
  pipe << kCube;
  pipe.close();
  EXPECT_EQ(command.wait().status, 0);
}

}  // namespace
}  // namespace raycone::test
