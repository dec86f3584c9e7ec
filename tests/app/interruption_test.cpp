// Runs that are interrupted leave no trace but the way they ended. Black box: the real executable.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>

#include "tests/app/meshes.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_directory.h"

namespace raycone::test {
namespace {

using std::chrono::milliseconds;

// A directory with a mesh whose evaluation at this resolution takes minutes, and an output of an earlier run.
class Interruption : public testing::Test {
 protected:
  Interruption() {
    write_text(mesh_, triangle_soup(1000));
    write_text(output_, "earlier result");
  }

  [[nodiscard]] std::size_t file_count() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(dir_.path()), {}));
  }

  // Waits until the run has opened its temporary files and is evaluating.
  void wait_for_work(std::size_t files) const {
    ASSERT_TRUE(becomes_true([&] { return file_count() >= files; })) << "the run opened no temporary file";
    std::this_thread::sleep_for(milliseconds(100));
  }

  [[nodiscard]] CommandResult long_run_until(int signal) const {
    Command command(raycone_command(long_run_));
    wait_for_work(2 + 2);
    command.send_signal(signal);
    return command.wait();
  }

  void expect_only_what_was_there() const {
    EXPECT_EQ(file_count(), 2U);
    EXPECT_EQ(read_text(output_), "earlier result");
  }

  TemporaryDirectory dir_;
  std::string mesh_ = dir_ / "mesh.obj";
  std::string output_ = dir_ / "out.vdb";
  std::vector<std::string> long_run_{"lattice",  mesh_,           "-o",        output_, "--resolution", "400",
                                     "--report", dir_ / "r.json", "--threads", "1"};
};

TEST_F(Interruption, BySignalCleansUpAndDiesOfIt) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGXCPU, SIGALRM, SIGPROF}) {
    const CommandResult result = long_run_until(signal);
    EXPECT_EQ(result.signal, signal);
    EXPECT_EQ(result.err, "");
    expect_only_what_was_there();
  }
}

// As std::terminate() raises it; sanitizers take the other signals of faults for themselves.
TEST_F(Interruption, ByAFaultCleansUpAndCallsItOne) {
  const CommandResult result = long_run_until(SIGABRT);
  EXPECT_EQ(result.signal, SIGABRT);
  EXPECT_EQ(result.err, "raycone: internal error, please report: Aborted\n");
  expect_only_what_was_there();
}

TEST_F(Interruption, SignalsIgnoredByTheCallerStayIgnored) {
  Command command(raycone_command(long_run_), {.ignored_signals = {SIGHUP}});
  wait_for_work(2 + 2);
  command.send_signal(SIGHUP);
  std::this_thread::sleep_for(milliseconds(100));
  command.send_signal(SIGTERM);
  EXPECT_EQ(command.wait().signal, SIGTERM);
}

TEST_F(Interruption, ByTimeoutCleansUpAndEndsWithStatus4) {
  const CommandResult result = run_raycone(with_more(long_run_, {"--timeout", "0.3"}));
  EXPECT_EQ(result.status, 4);
  EXPECT_EQ(result.err, "raycone: " + mesh_ + ": not finished within 0.3 seconds (--timeout)\n");
  expect_only_what_was_there();
}

TEST_F(Interruption, TimeoutHoldsWhileWaitingForInput) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"info", "-", "--timeout", "0.2"}, {"points", mesh_, "-", "--timeout", "0.2"}}) {
    Command command(raycone_command(arguments));
    EXPECT_EQ(command.wait().status, 4);
  }
}

}  // namespace
}  // namespace raycone::test
