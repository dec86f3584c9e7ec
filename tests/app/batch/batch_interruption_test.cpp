// Batches that are killed, as a whole or in part. Black box, real signals.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/syscall.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <sstream>
#include <thread>

#include "tests/app/batch/batch_fixture.h"

namespace raycone::test {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

std::vector<pid_t> children_of(pid_t process) {
  const std::string id = std::to_string(process);
  std::ifstream list("/proc/" + id + "/task/" + id + "/children");
  std::vector<pid_t> children;
  for (pid_t child = 0; list >> child;) children.push_back(child);
  return children;
}

// The fields of a stat file of /proc behind the name, from the state on; none where there is no such process or thread.
std::vector<std::string> stat_fields(const std::string& path) {
  std::ifstream file(path);
  std::string stat;
  std::getline(file, stat);
  const std::size_t end_of_name = stat.rfind(')');
  if (end_of_name == std::string::npos) return {};
  std::istringstream words(stat.substr(end_of_name + 1));
  return {std::istream_iterator<std::string>(words), {}};
}

// Zombies do not run.
bool runs(pid_t process) {
  const std::vector<std::string> fields = stat_fields("/proc/" + std::to_string(process) + "/stat");
  return !fields.empty() && fields[0] != "Z" && fields[0] != "X";
}

// CPU time, in clock ticks, of each thread that has had any.
std::map<std::string, int> thread_times(const std::vector<pid_t>& processes) {
  std::map<std::string, int> times;
  for (const pid_t process : processes) {
    std::error_code error;
    for (const auto& thread : fs::directory_iterator("/proc/" + std::to_string(process) + "/task", error)) {
      const std::vector<std::string> fields = stat_fields(thread.path().string() + "/stat");
      if (fields.size() > 12) times[thread.path().string()] = std::stoi(fields[11]) + std::stoi(fields[12]);
    }
  }
  std::erase_if(times, [](const auto& time) { return time.second == 0; });
  return times;
}

int sum(const std::map<std::string, int>& times) {
  int sum = 0;
  for (const auto& [thread, ticks] : times) sum += ticks;
  return sum;
}

// Of the thread with the second most.
int second_most(const std::map<std::string, int>& times) {
  std::vector<int> ticks{0, 0};
  for (const auto& [thread, count] : times) ticks.push_back(count);
  std::ranges::nth_element(ticks, ticks.begin() + 1, std::ranges::greater());
  return ticks[1];
}

// Whether a worker is a program of its own by now.
bool has_started(pid_t worker) {
  return read_text("/proc/" + std::to_string(worker) + "/cmdline").find("batch-worker") != std::string::npos;
}

// Whether it waits for something to receive, as a worker that is idle does.
bool receives(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/syscall");
  long call = -1;
  return file >> call && call == SYS_recvfrom;
}

class BatchInterruption : public Batch {
 protected:
  // Meshes that take some milliseconds each, one of which is broken.
  void put_many() const {
    for (int i = 0; i < 30; ++i) put(std::to_string(i) + ".obj", triangle_soup(20 + 7 * i));
    put("sub/bad.obj", "broken");
  }

  // Two meshes whose evaluation takes minutes.
  void put_long() const {
    put("a.obj", triangle_soup(2000));
    put("b.obj", triangle_soup(2001));
  }
  [[nodiscard]] std::vector<std::string> long_run() const {
    return raycone_command(arguments({"--resolution", "300", "--threads", "2", "--format", "vdb"}));
  }

  // Waits until two workers have opened their temporary files.
  [[nodiscard]] std::vector<pid_t> wait_for_workers(const Command& command) const {
    EXPECT_TRUE(becomes_true([this] { return fs::exists(out_) && temporaries() == 2; }));
    return children_of(command.process());
  }

  [[nodiscard]] std::size_t temporaries() const {
    std::size_t count = 0;
    for (const auto& [name, text] : outputs_in(out_)) {
      const bool is_marker = name.find(".batch-") != std::string::npos;
      count += name.find(".raycone-") != std::string::npos && !is_marker ? 1 : 0;
    }
    return count;
  }

  // A run that was killed may leave half a line and no order.
  [[nodiscard]] bool has_rows() const {
    const std::string table = out_ + "/results.csv";
    return fs::exists(table) && std::ranges::count(read_text(table), '\n') > 1;
  }

  static void expect_all_to_end(const std::vector<pid_t>& processes) {
    for (const pid_t process : processes) EXPECT_TRUE(becomes_true([process] { return !runs(process); }));
  }
};

TEST_F(BatchInterruption, KilledAtAnyMomentTheLastRunEqualsAnUndisturbedOne) {
  put_many();
  const std::vector<std::string> options{"--resolution", "24", "--threads", "2"};
  const std::string undisturbed = dir_ / "undisturbed";
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(run_raycone(arguments_into(undisturbed, options)).status, 5);
  auto duration = std::chrono::duration_cast<milliseconds>(std::chrono::steady_clock::now() - start).count();
  std::mt19937 random(1);
  std::size_t interrupted = 0;
  std::size_t with_rows = 0;
  std::size_t with_temporaries = 0;
  for (int i = 0; i < 100 && interrupted < 12; ++i) {
    Command command(raycone_command(arguments(options)));
    std::this_thread::sleep_for(milliseconds(random() % (duration + duration / 10)));
    const std::vector<pid_t> workers = children_of(command.process());
    command.send_signal(SIGKILL);
    const bool is_interrupted = command.wait().signal == SIGKILL;
    expect_all_to_end(workers);
    if (!is_interrupted) {
      fs::remove_all(out_);  // all is done: from the start again, and for less long
      duration -= duration / 10;
      continue;
    }
    ++interrupted;
    with_rows += has_rows() ? 1 : 0;
    with_temporaries += fs::exists(out_) && temporaries() > 0 ? 1 : 0;
  }
  EXPECT_EQ(interrupted, 12U);
  EXPECT_GT(with_rows, 0U);
  EXPECT_GT(with_temporaries, 0U);
  EXPECT_EQ(run(options).status, 5);
  EXPECT_EQ(lasting(rows()), lasting(rows_in(undisturbed + "/results.csv")));
  EXPECT_EQ(outputs_in(out_), outputs_in(undisturbed)) << "also: no temporary file is left";
}

TEST_F(BatchInterruption, BySignalCleansUpAndDiesOfIt) {
  put_long();
  put("c.obj", kCube + ("# " + std::string(1'500'000, 'x') + '\n'));  // by far the largest file comes first
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGXCPU}) {
    fs::remove_all(out_);
    Command command(long_run());
    EXPECT_TRUE(becomes_true([this] { return has_rows(); }));
    const std::vector<pid_t> workers = wait_for_workers(command);
    EXPECT_EQ(workers.size(), 2U);
    command.send_signal(signal);
    const CommandResult result = command.wait();
    EXPECT_EQ(result.signal, signal);
    EXPECT_NE(result.err.find("raycone: interrupted: 1 mesh done, 0 failed"), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("; 2 not done; run it again to go on\n"), std::string::npos) << result.err;
    expect_all_to_end(workers);
    EXPECT_EQ(temporaries(), 0U);
    const auto kept = rows();
    EXPECT_TRUE(kept.size() == 1 && kept.contains("c.obj")) << "an interrupted mesh has no row";
  }
}

// As in `raycone batch ... 2>&1 | head -1`: what is told of the first mesh finds no reader.
TEST_F(BatchInterruption, ByAClosedStandardErrorCleansUp) {
  put_long();
  put("c.obj", std::string(1'500'000, 'x'));  // by far the largest file comes first
  std::vector<std::string> words{"/bin/sh", "-c", "(sleep 0.5; exec \"$@\") 2>&1 | true", "sh"};
  for (const std::string& word : long_run()) words.push_back(word);
  EXPECT_EQ(Command(words).wait().status, 0);  // of `true`, when both have ended
  EXPECT_EQ(temporaries(), 0U);
  const auto kept = rows();
  EXPECT_TRUE(kept.size() == 1 && kept.contains("c.obj"));
}

// Installed anew, or on a file system that was mounted anew, while the batch runs.
TEST_F(BatchInterruption, AProgramThatMayNotBeExecutedIsNoLackOfMemory) {
  const std::string program = dir_ / "program";
  fs::copy_file(fs::canonical(raycone_command({}).front()), program);
  put("a.obj", triangle_soup(2000));  // its worker is replaced when its time is over
  put("b.obj");
  std::vector<std::string> words =
      arguments({"--resolution", "300", "--threads", "1", "--timeout", "2", "--format", "csv"});
  words.insert(words.begin(), program);
  Command command(words);
  EXPECT_TRUE(becomes_true([&] { return std::ranges::any_of(children_of(command.process()), has_started); }));
  fs::permissions(program, fs::perms::owner_read);
  EXPECT_EQ(command.wait().status, 5);
  const auto results = rows();
  EXPECT_EQ(results.at("a.obj").status, MeshStatus::kTimeout);
  EXPECT_EQ(results.at("b.obj").status, MeshStatus::kCrashed);
  EXPECT_NE(results.at("b.obj").message.find("raycone's own program cannot be executed any more"), std::string::npos)
      << results.at("b.obj").message;
}

TEST_F(BatchInterruption, ATerminalsSignalToAllIsTheSupervisors) {
  put_long();
  Command command(long_run());
  const std::vector<pid_t> workers = wait_for_workers(command);
  for (const pid_t worker : workers) kill(worker, SIGINT);
  command.send_signal(SIGINT);
  EXPECT_EQ(command.wait().signal, SIGINT);
  expect_all_to_end(workers);
  EXPECT_TRUE(rows().empty());
}

TEST_F(BatchInterruption, AWorkerThatCrashesCostsItsRowAndIsReplaced) {
  put_long();
  Command command(long_run());
  const std::vector<pid_t> workers = wait_for_workers(command);
  ASSERT_EQ(workers.size(), 2U);
  kill(workers[0], SIGABRT);  // not SIGSEGV, which sanitizers would take for their own
  kill(workers[1], SIGKILL);
  const CommandResult result = command.wait();
  EXPECT_EQ(result.status, 5);
  EXPECT_EQ(statuses(rows()), (Statuses{{"a.obj", "crashed"}, {"b.obj", "crashed"}}));
  EXPECT_EQ(rows().at("a.obj").exit + rows().at("b.obj").exit, 128 + SIGABRT + 128 + SIGKILL);
  EXPECT_EQ(temporaries(), 0U);
  EXPECT_NE(run({"--resolution", "300", "--format", "vdb", "--dry-run"}).out.find("a.obj\tcrashed before"),
            std::string::npos);
}

// Some launchers leave that to their children, and the system then does not tell how those of raycone ended.
TEST_F(BatchInterruption, TellsHowAWorkerEndedWhereSigchldWasIgnored) {
  put_long();
  Command command(long_run(), {.ignored_signals = {SIGCHLD}});
  for (const pid_t worker : wait_for_workers(command)) kill(worker, SIGKILL);
  EXPECT_EQ(command.wait().status, 5);
  const auto ended = rows();
  EXPECT_EQ(ended.size(), 2U);
  for (const auto& [mesh, row] : ended) EXPECT_EQ(row.exit, 128 + SIGKILL) << mesh << ": " << row.message;
}

// The worker answers and dies while the supervisor looks elsewhere.
TEST_F(BatchInterruption, AWorkerThatDiesBetweenMeshesCostsNone) {
  fs::create_directories(meshes_);
  const std::string pipe = meshes_ + "/a.obj";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  put("b.obj");
  Command command(
      raycone_command({"batch", pipe, meshes_ + "/b.obj", "--out-dir", out_, "--resolution", "8", "--jobs", "1"}));
  {
    std::ofstream mesh(pipe);  // opens when the worker does
    command.send_signal(SIGSTOP);
    mesh << kCube;
  }
  const std::vector<pid_t> workers = children_of(command.process());
  ASSERT_EQ(workers.size(), 1U);
  EXPECT_TRUE(becomes_true([&] { return fs::exists(out_ + "/a.vdb") && receives(workers[0]); })) << "has answered";
  kill(workers[0], SIGKILL);
  expect_all_to_end(workers);
  // Its socket is open as long as one of its threads is.
  const fs::path threads = "/proc/" + std::to_string(workers[0]) + "/task";
  EXPECT_TRUE(becomes_true([&] { return std::distance(fs::directory_iterator(threads), {}) == 1; }));
  command.send_signal(SIGCONT);
  EXPECT_EQ(command.wait().status, 0);
  EXPECT_EQ(statuses(rows()), (Statuses{{"a.obj", "ok"}, {"b.obj", "ok"}}));
}

TEST_F(BatchInterruption, FourBatchesInOneDirectoryDisturbNoOther) {
  put_many();
  const std::vector<std::string> options{"--resolution", "16", "--threads", "1"};
  const std::string alone = dir_ / "alone";
  ASSERT_EQ(run_raycone(arguments_into(alone, options)).status, 5);
  std::vector<std::unique_ptr<Command>> commands;
  for (int i = 0; i < 4; ++i) commands.push_back(std::make_unique<Command>(raycone_command(arguments(options))));
  for (const std::unique_ptr<Command>& command : commands) EXPECT_EQ(command->wait().status, 5);
  EXPECT_EQ(lasting(rows()), lasting(rows_in(alone + "/results.csv")));
  EXPECT_EQ(outputs_in(out_), outputs_in(alone));
}

TEST_F(BatchInterruption, CleansUpBehindKilledRunsButNotBehindOthers) {
  put_long();
  Command killed(long_run());
  const std::vector<pid_t> workers = wait_for_workers(killed);
  killed.send_signal(SIGKILL);
  (void)killed.wait();
  expect_all_to_end(workers);
  EXPECT_EQ(temporaries(), 2U) << "nobody was left to remove them";
  Command alive(long_run());
  EXPECT_TRUE(becomes_true([&] { return children_of(alive.process()).size() == 2 && temporaries() == 2; }));
  put("c.obj", kTriangle);  // flat: one layer
  EXPECT_EQ(run_raycone({"batch", meshes_ + "/c.obj", "--out-dir", out_, "--resolution", "300"}).status, 0);
  EXPECT_EQ(temporaries(), 2U) << "of the batch that runs";
}

// A batch with nothing to do, too, looks wherever its outputs are.
TEST_F(BatchInterruption, CleansUpInSubdirectoriesWhereAllIsDone) {
  const std::string mesh = put("sub/a.obj", triangle_soup(2000));
  ASSERT_EQ(run({"--resolution", "4"}).status, 0);
  Command killed(raycone_command({"lattice", mesh, "-o", out_ + "/sub/b.csv", "--resolution", "300"}));
  EXPECT_TRUE(becomes_true([&] { return temporaries() == 1; }));
  killed.send_signal(SIGKILL);
  (void)killed.wait();
  EXPECT_EQ(temporaries(), 1U);
  EXPECT_EQ(run({"--resolution", "4"}).status, 0);
  EXPECT_EQ(temporaries(), 0U);
}

TEST_F(BatchInterruption, ABatchWithOtherOptionsIsRefusedWhileOneRuns) {
  put_long();
  Command running(long_run());
  (void)wait_for_workers(running);
  const auto before = outputs_in(out_);
  const CommandResult other = run({"--resolution", "299"});
  EXPECT_EQ(other.status, 3);
  EXPECT_EQ(other.err, "raycone: " + out_ + ": a batch with other options, or of another version, runs here (process " +
                           std::to_string(running.process()) +
                           "), expected to wait for it or to have another --out-dir\n");
  EXPECT_EQ(outputs_in(out_).size(), before.size());
  EXPECT_EQ(run({"--resolution", "299", "--dry-run"}).status, 0) << "which changes nothing";
  running.send_signal(SIGKILL);
  (void)running.wait();
  fs::remove(meshes_ + "/a.obj");
  put("b.obj");
  EXPECT_EQ(run({"--resolution", "9"}).status, 0) << "that batch has ended";
  EXPECT_EQ(outputs_in(out_).size(), 1U) << "neither marker nor temporary file is left";
}

TEST_F(BatchInterruption, ABatchOnAnotherHostHasEndedWhenItIsSilent) {
  put("a.obj");
  fs::create_directories(out_);
  const std::string marker = out_ + "/.raycone-0123456789abcdef-1-1-0.batch-0123456789abcdef";
  write_text(marker, "");
  EXPECT_EQ(run().status, 3);
  EXPECT_TRUE(fs::exists(marker));
  fs::last_write_time(marker, fs::file_time_type::clock::now() - std::chrono::minutes(9));
  EXPECT_EQ(run().status, 3);
  fs::last_write_time(marker, fs::file_time_type::clock::now() - std::chrono::minutes(11));
  EXPECT_EQ(run().status, 0);
  EXPECT_FALSE(fs::exists(marker));
}

TEST_F(BatchInterruption, NeverMoreThreadsAreBusyThanAllowed) {
#ifdef __SANITIZE_THREAD__
  GTEST_SKIP() << "ThreadSanitizer has a thread of its own, and core/machine/threads.h another implementation";
#endif
  put_long();
  for (const std::size_t threads : {2U, 3U, 5U}) {
    fs::remove_all(out_);
    Command command(
        raycone_command(arguments({"--resolution", "300", "--threads", std::to_string(threads), "--format", "vdb"})));
    const std::vector<pid_t> workers = wait_for_workers(command);
    const int to_start = sum(thread_times({command.process()}));
    std::map<std::string, int> busy;
    const auto two_are_busy = [&] { return second_most(busy = thread_times(workers)) >= 50; };
    ASSERT_TRUE(becomes_true(two_are_busy)) << "for half a second each, which takes longer where others want the CPUs";
    // TBB starts a worker for each CPU at the start, which then sleeps.
    std::erase_if(busy, [least = second_most(busy) / 4](const auto& time) { return time.second <= least; });
    EXPECT_LE(busy.size(), threads);
    EXPECT_GE(busy.size(), 2U);
    const int supervised = sum(thread_times({command.process()})) - to_start;
    EXPECT_LT(10 * supervised, sum(busy)) << "the supervisor mostly sleeps once its workers run";
  }
}

}  // namespace
}  // namespace raycone::test
