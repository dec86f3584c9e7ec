// raycone batch as scripts see it. Black box: the real executable.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include "tests/app/batch/batch_fixture.h"
#include "tests/support/bytes.h"

namespace raycone::test {
namespace {

namespace fs = std::filesystem;

// A cube of this size without its top: open, so that all values of its field differ.
std::string open_cube(double size) {
  std::string text;
  for (const char* const corner : {"0 0 0", "1 0 0", "1 1 0", "0 1 0", "0 0 1", "1 0 1", "1 1 1", "0 1 1"}) {
    text += "v";
    for (int i = 0; i < 3; ++i) text += corner[2 * i] == '1' ? " " + std::to_string(size) : " 0";
    text += "\n";
  }
  return text + "f 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
}

std::size_t count_lines(const std::string& text) { return static_cast<std::size_t>(std::ranges::count(text, '\n')); }

TEST_F(Batch, AWorkerIsChargedForOpenVdbOnce) {
  for (const char* const name : {"a.obj", "b.obj", "c.obj", "d.obj"}) put(name);
  const CommandResult result = run({"--threads", "1", "--memory-limit", "64M", "--format", "vdb"});
  EXPECT_EQ(result.status, 0) << result.err;
}

TEST_F(Batch, GivesEachMeshWhatLatticeGivesIt) {
  const std::string cube = put("sub/cube one.OBJ");
  const std::string triangle = put("\xC3\xA4.obj", kTriangle);
  const CommandResult result = run_raycone({"batch", meshes_, "--out-dir", out_, "--resolution", "8"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(statuses(rows()), (Statuses{{"sub/cube one.OBJ", "ok"}, {"\xC3\xA4.obj", "ok"}}));
  const ResultRow row = rows().at("sub/cube one.OBJ");
  EXPECT_EQ(row.output, "sub/cube one.vdb");
  EXPECT_EQ(row.figures->faces, 12U);
  EXPECT_EQ(row.figures->samples, 512U);
  EXPECT_EQ(row.figures->exterior_edges, 0U);
  EXPECT_GT(row.figures->peak_memory_bytes, 1'000'000U);
  ASSERT_EQ(run_raycone({"lattice", cube, "-o", dir_ / "cube one.vdb", "--resolution", "8"}).status, 0);
  EXPECT_EQ(read_text(out_ + "/sub/cube one.vdb"), read_text(dir_ / "cube one.vdb"));
}

TEST_F(Batch, BrokenMeshesCostTheirRowsOnly) {
  put("a.obj");
  const std::string broken = put("b.obj", "v 0 0 0\nf 1 2 9\n");
  put("c.stl", "solid x\nfacet normal 0 0 1\n");
  put("d.obj");
  const CommandResult result = run();
  EXPECT_EQ(result.status, 5);
  EXPECT_NE(result.err.find("raycone: " + broken + ":2: face index"), std::string::npos) << result.err;
  EXPECT_EQ(statuses(rows()), (Statuses{{"a.obj", "ok"}, {"b.obj", "invalid"}, {"c.stl", "invalid"}, {"d.obj", "ok"}}));
  EXPECT_EQ(rows().at("b.obj").exit, 2);
  EXPECT_NE(rows().at("b.obj").message.find(broken + ":2: face index"), std::string::npos);
  EXPECT_EQ(outputs_in(out_).size(), 2U);
  EXPECT_EQ(run().status, 5) << "failed in an earlier run";
}

TEST_F(Batch, MessagesAreOnOneLine) {
  put("a\nb.obj", "v 0 0 0\nf 1 2 9\n");
  EXPECT_EQ(run().status, 5);
  const std::string message = rows().at("a\nb.obj").message;
  EXPECT_NE(message.find("a?b.obj:2: face index"), std::string::npos) << message;
}

TEST_F(Batch, PoisonIsContainedAndTriedAgainWhereItsCauseMayBeGone) {
  put("a.obj");
  put("bad.obj", "v 0 0 0\n");
  put("big.obj", open_cube(5000));  // 5000^3 values of 4 bytes at voxels of size 1
  put("far.obj", open_cube(1e9));   // 1e27 samples
  const std::string pipe = meshes_ + "/pipe.obj";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);  // a reader without end
  put("z.obj");
  const auto batch = [&](const std::vector<std::string>& more) {
    return run_raycone(with_more({"batch", meshes_, pipe, "--out-dir", out_, "--voxel-size", "1"}, more));
  };
  const CommandResult result = batch({"--timeout", "10", "--memory-limit", "8G"});
  EXPECT_EQ(result.status, 5);
  EXPECT_EQ(statuses(rows()), (Statuses{{"a.obj", "ok"},
                                        {"bad.obj", "invalid"},
                                        {"big.obj", "memory"},
                                        {"far.obj", "memory"},
                                        {"pipe.obj", "timeout"},
                                        {"z.obj", "ok"}}));
  for (const char* const mesh : {"big.obj", "far.obj", "pipe.obj"}) EXPECT_EQ(rows().at(mesh).exit, 4) << mesh;
  for (const auto& [mesh, row] : rows()) EXPECT_EQ(row.sha256.size(), mesh == "pipe.obj" ? 0U : 64U) << mesh;
  EXPECT_NE(result.err.find(pipe + ": not finished within 10 seconds"), std::string::npos) << result.err;
  EXPECT_EQ(outputs_in(out_).size(), 2U) << "no debris of the worker that was killed";

  const auto planned = [&batch](const char* timeout, const char* memory, const std::vector<std::string>& more = {}) {
    return batch(with_more({"--timeout", timeout, "--memory-limit", memory, "--dry-run"}, more)).out;
  };
  EXPECT_EQ(planned("10", "8G"), "");
  EXPECT_EQ(planned("12", "8G"), pipe + "\ttime limit changed\n");
  EXPECT_EQ(planned("10", "9G"),
            meshes_ + "/big.obj\tmemory limit changed\n" + meshes_ + "/far.obj\tmemory limit changed\n");
  EXPECT_EQ(count_lines(planned("10", "8G", {"--retry-failed"})), 4U);
  put("bad.obj");
  EXPECT_EQ(planned("10", "8G"), meshes_ + "/bad.obj\tmesh changed\n");
}

TEST_F(Batch, GoesOnWithTheWorkersThatThereAre) {
  for (int i = 0; i < 30; ++i) put(std::to_string(i) + ".obj");
  std::vector<std::string> words{"/bin/sh", "-c", "ulimit -n 20; exec \"$@\"", "sh"};
  std::ranges::copy(raycone_command(arguments({"--threads", "30", "--format", "csv"})), std::back_inserter(words));
  const CommandResult result = Command(words).wait();
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(rows().size(), 30U);
}

TEST_F(Batch, AgainDoesNothingButWhatIsMissingOrOutOfDate) {
  for (const char* const name : {"a.obj", "b.obj", "c.obj", "d.obj"}) put(name);
  ASSERT_EQ(run().status, 0);
  EXPECT_EQ(run({"--dry-run"}).out, "");
  const auto listed = [this](const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = more;
    words.push_back("--dry-run");
    return run(words).out;
  };
  fs::remove(out_ + "/b.npy");
  EXPECT_EQ(listed(), meshes_ + "/b.obj\toutput missing\n");
  const auto touched = fs::last_write_time(out_ + "/a.npy") + std::chrono::hours(1);
  fs::last_write_time(meshes_ + "/c.obj", touched);
  EXPECT_EQ(count_lines(listed()), 1U) << "another time stamp, but the same content";
  put("d.obj", kTriangle);
  EXPECT_EQ(count_lines(listed()), 2U);
  EXPECT_NE(listed().find("/d.obj\tmesh changed\n"), std::string::npos);
  EXPECT_EQ(count_lines(listed({"--scale", "2"})), 4U) << "other options";
  EXPECT_EQ(count_lines(listed({"--format", "csv"})), 4U);
  EXPECT_EQ(count_lines(listed({"--threads", "1", "--quiet", "--timeout", "7", "--jobs", "1"})), 2U) << "no effect";

  const auto time_of_a = fs::last_write_time(out_ + "/a.npy");
  const std::string row_of_a = csv_line(to_record(rows().at("a.obj")));
  ASSERT_EQ(run().status, 0);
  EXPECT_EQ(fs::last_write_time(out_ + "/a.npy"), time_of_a);
  EXPECT_EQ(csv_line(to_record(rows().at("a.obj"))), row_of_a);
  EXPECT_EQ(rows().at("d.obj").figures->faces, 1U);
  EXPECT_EQ(listed(), "");
}

// NIfTI has no place for them: a.json beside a.nii.gz.
TEST_F(Batch, NamesOfLabelsAreMissedLikeTheOutput) {
  put("a.obj");
  put("sub/b.obj");
  const std::vector<std::string> labels{"--field", "label", "--parts", "component", "--format", "nii.gz"};
  const auto listed = [&] {
    std::vector<std::string> words = labels;
    words.push_back("--dry-run");
    return run(words).out;
  };
  ASSERT_EQ(run(labels).status, 0);
  EXPECT_EQ(listed(), "");
  const std::string names = read_text(out_ + "/sub/b.json");
  ASSERT_TRUE(fs::remove(out_ + "/sub/b.json"));
  EXPECT_EQ(listed(), meshes_ + "/sub/b.obj\toutput missing\n");
  ASSERT_EQ(run(labels).status, 0);
  EXPECT_EQ(read_text(out_ + "/sub/b.json"), names);
  EXPECT_EQ(listed(), "");
}

TEST_F(Batch, NamesOfLabelsReplaceNoInput) {
  const std::string mesh = put("a.obj");
  const std::string list = out_ + "/a.json";
  fs::create_directories(out_);
  write_text(list, mesh + '\n');
  const CommandResult result = run_raycone({"batch", '@' + list, "--out-dir", out_, "--field", "label", "--parts",
                                            "component", "--format", "nii", "--resolution", "4"});
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("a.json would replace the input"), std::string::npos) << result.err;
  EXPECT_EQ(read_text(list), mesh + '\n');
}

TEST_F(Batch, UnwritableOutputsAreTriedAgain) {
  put("sub/a.obj");
  put("b.obj");
  fs::create_directories(out_);
  write_text(out_ + "/sub", "in the way");
  EXPECT_EQ(run().status, 5);
  EXPECT_EQ(statuses(rows()), (Statuses{{"b.obj", "ok"}, {"sub/a.obj", "unwritable"}}));
  EXPECT_EQ(rows().at("sub/a.obj").exit, 3);
  fs::remove(out_ + "/sub");
  EXPECT_EQ(run().status, 0);
  EXPECT_EQ(statuses(rows()), (Statuses{{"b.obj", "ok"}, {"sub/a.obj", "ok"}}));
}

TEST_F(Batch, AFullDiskLeavesNothingHalf) {
  put("a.obj");
  put("b.obj", triangle_soup(50));  // 50^3 values of 8 bytes
  const std::vector<std::string> options{"--format", "npy", "--double", "--resolution", "50"};
  const CommandResult result = run(options, {.file_size_limit = 100'000});
  EXPECT_EQ(result.status, 5) << result.err;
  EXPECT_EQ(statuses(rows()), (Statuses{{"a.obj", "unwritable"}, {"b.obj", "unwritable"}}));
  EXPECT_EQ(outputs_in(out_).size(), 0U);
  EXPECT_EQ(run(options).status, 0);
  EXPECT_EQ(outputs_in(out_).size(), 2U);
  const CommandResult no_row = run({"--format", "none"}, {.file_size_limit = 300});
  EXPECT_EQ(no_row.status, 3) << "without its rows a batch is nothing";
  EXPECT_NE(no_row.err.find(out_ + "/batch-state.csv: cannot write"), std::string::npos) << no_row.err;
  EXPECT_EQ(run({"--format", "none"}).status, 0);
}

TEST_F(Batch, FailFastStopsAndKeepGoingDoesNot) {
  put("a.obj");
  put("b.obj", "broken");
  put("c.obj");
  EXPECT_EQ(run({"--fail-fast", "--jobs", "1"}).status, 5);
  EXPECT_EQ(statuses(rows()), (Statuses{{"a.obj", "ok"}, {"b.obj", "invalid"}}));
  EXPECT_EQ(run({"--keep-going"}).status, 5);
  EXPECT_EQ(rows().size(), 3U);
  EXPECT_EQ(run({"--keep-going", "--fail-fast"}).status, 1);
}

TEST_F(Batch, ExitsWithZeroOnlyWhereMeshesFailed) {
  put("a.obj");
  put("bad.obj", "broken");
  put("big.obj", open_cube(5000));
  put("sub/c.obj");
  fs::create_directories(out_);
  write_text(out_ + "/sub", "in the way");
  const std::vector<std::string> words{"batch", meshes_,          "--out-dir", out_,         "--voxel-size",
                                       "1",     "--memory-limit", "8G",        "--exit-zero"};
  EXPECT_EQ(run_raycone(words).status, 0);
  EXPECT_EQ(statuses(rows()),
            (Statuses{{"a.obj", "ok"}, {"bad.obj", "invalid"}, {"big.obj", "memory"}, {"sub/c.obj", "unwritable"}}));
  EXPECT_EQ(run_raycone(words).status, 0) << "failed in an earlier run";
  EXPECT_EQ(run({"--exit-zero", "--jobs", "0"}).status, 1);
  EXPECT_EQ(run({"--exit-zero", "--fail-fast"}).status, 1);
  EXPECT_EQ(run_raycone({"batch", "@" + dir_ / "absent", "--out-dir", out_, "--exit-zero"}).status, 2);
  EXPECT_EQ(run({"--exit-zero", "--scale", "2"}, {.file_size_limit = 300}).status, 3) << "no rows to say so";
}

TEST_F(Batch, OfADirectoryThatIsMissingIsNone) {
  put("a.obj");
  for (const std::string& operand : {dir_ / "no", dir_ / "no/", std::string()}) {
    const CommandResult result = run_raycone({"batch", meshes_, operand, "--out-dir", out_, "--format", "none"});
    EXPECT_EQ(result.status, operand.empty() ? 1 : 2) << operand;
    EXPECT_FALSE(fs::exists(out_)) << operand;
  }
}

TEST_F(Batch, MeasuresOnlyWithFormatNone) {
  put("a.obj");
  put("a.stl", kCube);  // OBJ inside, which has no signature: fails
  const CommandResult result = run({"--format", "none"});
  EXPECT_EQ(result.status, 5);
  EXPECT_EQ(rows().at("a.obj").figures->samples, 512U);
  EXPECT_EQ(rows().at("a.obj").output, "");
  EXPECT_TRUE(outputs_in(out_).empty());
  EXPECT_EQ(run({"--format", "none", "--dry-run"}).out, "");
}

TEST_F(Batch, ListsComeFromFilesAndStandardInput) {
  const std::string a = put("a b.obj");
  const std::string b = put("c.obj");
  const auto with_list = [this](const std::vector<std::string>& words, const std::string& input) {
    Command command(raycone_command(with_more({"batch", "--out-dir", out_, "--resolution", "8"}, words)));
    command.write(input);
    command.close_input();
    return command.wait().status;
  };
  EXPECT_EQ(with_list({"@-"}, a + "\n"), 0);
  EXPECT_EQ(rows().size(), 1U);
  EXPECT_EQ(with_list({"-0", "@-"}, a + '\0' + b + '\0'), 0);
  EXPECT_EQ(rows().size(), 2U);
  EXPECT_EQ(with_list({"@" + dir_ / "absent"}, ""), 2);
}

TEST_F(Batch, CollisionsAreRefusedBeforeAnything) {
  const std::string a = put("a.obj");
  const std::string b = put("a.ply");
  const CommandResult result = run();
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find(a), std::string::npos);
  EXPECT_NE(result.err.find(b), std::string::npos);
  EXPECT_FALSE(fs::exists(out_));
  put("results.obj");
  fs::remove(b);
  EXPECT_EQ(run({"--format", "csv"}).status, 1) << "results.csv is taken";
  EXPECT_EQ(run().status, 0);
}

TEST_F(Batch, ShardsAndAFinalRunMakeTheSameAsOneRun) {
  for (int i = 0; i < 12; ++i) put(std::to_string(i) + ".obj", triangle_soup(1 + i));
  put("bad.obj", "broken");
  for (const char* const shard : {"3/3", "1/3"}) (void)run({"--shard", shard});
  EXPECT_FALSE(fs::exists(out_ + "/results.csv"));
  const Rows first = rows_in(out_ + "/results-1-of-3.csv");
  const Rows third = rows_in(out_ + "/results-3-of-3.csv");
  EXPECT_EQ(first.size(), 5U);
  EXPECT_EQ(third.size(), 4U);
  for (const auto& [mesh, row] : first) EXPECT_FALSE(third.contains(mesh));
  put("late.obj");
  EXPECT_EQ(run().status, 5);
  EXPECT_EQ(rows().size(), 14U);
  EXPECT_EQ(count_lines(run({"--dry-run"}).out), 0U);
  const std::string single = dir_ / "single";
  EXPECT_EQ(run_raycone(arguments_into(single)).status, 5);
  EXPECT_EQ(lasting(rows()), lasting(rows_in(single + "/results.csv")));
  EXPECT_EQ(outputs_in(out_), outputs_in(single));
  EXPECT_EQ(run({"--shard", "1/1"}).status, 5);
  EXPECT_EQ(rows_in(out_ + "/results-1-of-1.csv").size(), 14U) << "what others did counts, and is taken over";
  const Environment environment = outside_array_jobs();
  for (const char* const wrong : {"0/3", "4/3", "slurm", "x"}) EXPECT_EQ(run({"--shard", wrong}).status, 1) << wrong;
}

TEST_F(Batch, ReadsWhatTheLargestNumbersOfShardsHaveWritten) {
  put("a.obj");
  EXPECT_EQ(run({"--shard", "1/9223372036854775807"}).status, 0);
  EXPECT_EQ(run().status, 0);
  EXPECT_EQ(rows().size(), 1U);
  EXPECT_EQ(rows_in(out_ + "/results-1-of-9223372036854775807.csv").size(), 1U);
}

TEST_F(Batch, SaysInOneLineWhatATableOfOthersIsNot) {
  put("a.obj");
  fs::create_directories(out_);
  std::ofstream(out_ + "/results.csv") << "name,size\n";
  const CommandResult result = run();
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find(": not written by raycone batch, expected mesh,status,"), std::string::npos) << result.err;
  EXPECT_EQ(result.err.find('?'), std::string::npos) << result.err;
}

TEST_F(Batch, DoesNotWaitForAPipeInPlaceOfItsTable) {
  put("a.obj");
  fs::create_directories(out_);
  ASSERT_EQ(mkfifo((out_ + "/results.csv").c_str(), 0600), 0);
  const CommandResult result = run();
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.err, "raycone: " + out_ + "/results.csv: is a pipe or device, expected a file\n");
  EXPECT_EQ(run_raycone({"report", out_}).status, 2);
}

TEST_F(Batch, WarnsOncePerMeshAndObeysStrict) {
  const std::string mesh = put("a.obj", std::string(kTriangle) + "f 1 2\n");
  const CommandResult result = run();
  EXPECT_EQ(result.status, 0);
  EXPECT_NE(result.err.find("raycone: warning: " + mesh + ": skipped-faces: 1 face"), std::string::npos) << result.err;
  EXPECT_NE(rows().at("a.obj").message.find("1 face"), std::string::npos);
  EXPECT_EQ(run({"--strict", "--quiet"}).status, 5);
  EXPECT_EQ(rows().at("a.obj").exit, 2);
  EXPECT_EQ(run({"--quiet"}).err, "");
}

TEST_F(Batch, WarnsInALineOfEachKind) {
  const std::string mesh = put("a.obj", std::string(kTriangle) + "f 1 2 3\nf 1 2\n");
  const CommandResult result = run();
  for (const std::string name : {"skipped-faces", "inconsistent"}) {
    EXPECT_NE(result.err.find("raycone: warning: " + mesh + ": " + name + ": "), std::string::npos) << result.err;
  }
  EXPECT_NE(rows().at("a.obj").message.find("; inconsistent: "), std::string::npos);
}

TEST_F(Batch, NamesTheMeshThatOptionsDoNotSuit) {
  const std::string mesh = put("a.obj", open_cube(1));
  const CommandResult result = run({"--field", "sdf", "--resolution", "3,4,5"});
  EXPECT_EQ(result.status, 5);
  EXPECT_NE(result.err.find("raycone: " + mesh + ": --field sdf: voxels of "), std::string::npos) << result.err;
}

// Two triangles, their corners in box.bin.
constexpr const char* kBox = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":6,"type":"VEC3","min":[0,0,0],"max":[1,1,1]}],
    "bufferViews":[{"buffer":0,"byteLength":72}],"buffers":[{"uri":"box.bin","byteLength":72}]})";

std::string box_buffer(float height) {
  return bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, height, 1, 1, 1, 0, 1, 0});
}

TEST_F(Batch, BuffersOfGltfCountAsPartOfTheMesh) {
  put("box.gltf", kBox);
  const std::string path = put("box.bin", box_buffer(1));
  ASSERT_EQ(run().status, 0);
  EXPECT_EQ(run({"--dry-run"}).out, "");
  fs::last_write_time(path, fs::file_time_type::clock::now() + std::chrono::hours(1));
  EXPECT_EQ(run({"--dry-run"}).out, "") << "another time stamp, but the same content";
  put("box.bin", box_buffer(0.5F));
  EXPECT_EQ(run({"--dry-run"}).out, meshes_ + "/box.gltf\ta file that the mesh refers to changed\n");
  fs::remove(path);
  EXPECT_EQ(count_lines(run({"--dry-run"}).out), 1U);
}

TEST_F(Batch, MeshesWithoutTheirBuffersAreTriedAgainWhenTheyHaveThem) {
  put("box.gltf", kBox);
  EXPECT_EQ(run().status, 5);
  EXPECT_EQ(run({"--dry-run"}).out, "") << "it is missing still";
  put("box.bin", "too short");
  EXPECT_EQ(run({"--dry-run"}).out, meshes_ + "/box.gltf\ta file that the mesh refers to changed\n");
  EXPECT_EQ(run().status, 5);
  put("box.bin", box_buffer(1));
  EXPECT_EQ(run().status, 0);
  fs::remove(meshes_ + "/box.bin");
  EXPECT_EQ(run().status, 5);
  EXPECT_EQ(run({"--dry-run"}).out, "");
}

TEST_F(Batch, MeshesThatRanOutOfTimeAreTriedAgainWithOtherBuffers) {
  put("box.gltf", kBox);
  put("box.bin", box_buffer(1));
  std::this_thread::sleep_for(std::chrono::milliseconds(2100));  // a younger buffer would not be trusted
  const std::vector<std::string> options{"--timeout", "0.2", "--resolution", "3000", "--format", "none"};
  EXPECT_EQ(run(options).status, 5);
  EXPECT_EQ(statuses(rows()), (Statuses{{"box.gltf", "timeout"}}));
  std::vector<std::string> again = options;
  again.push_back("--dry-run");
  EXPECT_EQ(run(again).out, "");
  put("box.bin", box_buffer(0.5F));
  EXPECT_EQ(run(again).out, meshes_ + "/box.gltf\ta file that the mesh refers to changed\n");
}

// As on a file system of coarse times, or where a tool sets them: size and time stamp are the same.
TEST_F(Batch, NoticesChangesThatLeaveSizeAndTimeStamp) {
  put("box.gltf", kBox);
  put("cube.obj", kCube);
  for (const auto& [name, text] : {std::pair<std::string, std::string>{"box.bin", box_buffer(0.5F)},
                                   {"cube.obj", std::string(kCube).replace(std::string(kCube).find('1'), 1, "2")}}) {
    put("box.bin", box_buffer(1));
    put("cube.obj", kCube);
    ASSERT_EQ(run().status, 0);
    ASSERT_EQ(run({"--dry-run"}).out, "");
    const std::string path = meshes_ + "/" + name;
    const auto time = fs::last_write_time(path);
    put("replacement", text);
    fs::last_write_time(meshes_ + "/replacement", time);
    fs::rename(meshes_ + "/replacement", path);
    EXPECT_EQ(count_lines(run({"--dry-run"}).out), 1U) << name;
  }
}

// Whenever the buffer changes during a run, after another one the output is that of what is there now.
TEST_F(Batch, NoticesBuffersThatChangeWhileTheyAreUsed) {
  const std::vector<std::string> options{"--resolution", "120", "--format", "npy", "--quiet"};
  put("box.gltf", kBox);
  for (const int delay : {0, 60, 120}) {
    fs::remove_all(out_);
    put("box.bin", box_buffer(1));
    Command running(raycone_command(arguments(options)));
    ASSERT_TRUE(becomes_true([this] { return fs::exists(out_) && !outputs_in(out_).empty(); }));
    std::this_thread::sleep_for(std::chrono::milliseconds(delay));
    put("box.bin", box_buffer(0.5F));
    (void)running.wait();  // an error where it saw the file while it was empty
    ASSERT_EQ(run(options).status, 0);
    const std::string again = read_text(out_ + "/box.npy");
    ASSERT_EQ(run_raycone(arguments_into(dir_ / "fresh", options)).status, 0);
    EXPECT_TRUE(again == read_text(dir_ / "fresh/box.npy")) << delay;
  }
}

TEST_F(Batch, SaysWhatIsWrongWithItsOptions) {
  put("a.obj");
  EXPECT_EQ(run_raycone({"batch", meshes_}).status, 1) << "no --out-dir";
  EXPECT_EQ(run_raycone({"batch", "--out-dir", out_}).status, 1) << "no operand";
  EXPECT_EQ(run({"--format", "xyz"}).status, 1);
  EXPECT_EQ(run({"--jobs", "0"}).status, 1);
  EXPECT_EQ(run({"-o", "x.vdb"}).status, 1) << "of a single mesh";
  EXPECT_EQ(run({"--voxel-size", "1"}).status, 1) << "contradicts --resolution";
  EXPECT_FALSE(fs::exists(out_));
  write_text(out_, "a file");
  EXPECT_EQ(run().status, 3);
}

TEST_F(Batch, ShowsProgressWhenAsked) {
  put("a.obj");
  put("b.obj", "broken");
  const CommandResult result = run({"--progress", "always"});
  EXPECT_NE(result.err.find("/2 meshes"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("1 failed"), std::string::npos) << result.err;
  EXPECT_EQ(run({"--retry-failed"}).err.find("/1 mesh"), std::string::npos) << "not on a pipe";
}

}  // namespace
}  // namespace raycone::test
