#include "io/child_process.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <stdexcept>

namespace raycone {
namespace {

std::string death_of(const std::function<std::string()>& work) {
  try {
    (void)in_child_process(work);
  } catch (const ChildDied& death) {
    return death.what();
  }
  return "none";
}

TEST(InChildProcess, ReturnsWhatTheWorkReturns) {
  EXPECT_EQ(in_child_process([] { return ""; }), "");
  const std::string larger_than_a_pipe(1 << 20, 'x');
  EXPECT_EQ(in_child_process([&] { return larger_than_a_pipe; }), larger_than_a_pipe);
}

TEST(InChildProcess, ChangesNothingHere) {
  int number = 1;
  EXPECT_EQ(in_child_process([&] { return std::to_string(++number); }), "2");
  EXPECT_EQ(number, 1);
}

TEST(InChildProcess, TellsHowTheWorkDied) {
  EXPECT_EQ(death_of([]() -> std::string { std::abort(); }), "Aborted");
  EXPECT_EQ(death_of([]() -> std::string {
              kill(getpid(), SIGKILL);
              return "";
            }),
            "Killed");
  EXPECT_EQ(death_of([]() -> std::string { _exit(3); }), "exit status 3");
  EXPECT_EQ(death_of([]() -> std::string { throw std::runtime_error("nobody catches this"); }), "exit status 1");
}

TEST(InChildProcess, TakesNoSignals) {
  EXPECT_EQ(in_child_process([] {
              for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGALRM}) raise(signal);
              return "alive";
            }),
            "alive");
}

// A pipe that the child holds open is closed by its end.
TEST(InChildProcess, EndsWithItsParent) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t parent = fork();
  if (parent == 0) {
    (void)in_child_process([&]() -> std::string {
      if (write(ends[1], "!", 1) != 1) _exit(1);
      for (;;) pause();
    });
    _exit(0);
  }
  close(ends[1]);
  char byte = 0;
  ASSERT_EQ(read(ends[0], &byte, 1), 1);
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  EXPECT_EQ(read(ends[0], &byte, 1), 0);
  close(ends[0]);
}

}  // namespace
}  // namespace raycone
