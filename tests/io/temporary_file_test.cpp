#include "io/files/temporary_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <thread>

#include "io/files/output_file.h"
#include "tests/support/output_checks.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/text_files.h"

namespace raycone {
namespace {

using test::read_text;
using test::TemporaryDirectory;

std::set<std::string> names_in(const TemporaryDirectory& directory) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(directory.path())) {
    names.insert(entry.path().filename().string());
  }
  return names;
}

void put(const std::string& path) { std::ofstream(path) << "precious"; }

// The parts of the name that this process gives now.
TemporaryName own_name() {
  const TemporaryDirectory directory;
  const TemporaryFile file(directory.path().string());
  return temporary_name_from(*names_in(directory).begin()).value();
}

// A process that makes a temporary file, and is killed.
TemporaryName name_of_killed(const TemporaryDirectory& directory) {
  const std::set<std::string> before = names_in(directory);
  const pid_t child = fork();
  if (child == 0) {
    const TemporaryFile file(directory.path().string());
    raise(SIGKILL);
  }
  waitpid(child, nullptr, 0);
  for (const std::string& name : names_in(directory)) {
    if (!before.contains(name)) return temporary_name_from(name).value();
  }
  return {};
}

TEST(TemporaryName, TellsItsProcess) {
  const TemporaryName name = own_name();
  EXPECT_EQ(name.process, getpid());
  EXPECT_GT(name.start, 0U);
  EXPECT_FALSE(is_abandoned(name));
  EXPECT_EQ(temporary_name_from(name.text())->text(), name.text());
}

TEST(TemporaryName, IsAbandonedWhereItsProcessIsKnownToHaveEnded) {
  const TemporaryDirectory directory;
  const TemporaryName killed = name_of_killed(directory);
  EXPECT_TRUE(is_abandoned(killed));
  TemporaryName elsewhere = killed;
  elsewhere.host = "0123456789abcdef";
  EXPECT_FALSE(is_abandoned(elsewhere)) << "nothing is known of processes on another host";
  TemporaryName earlier = own_name();
  ++earlier.start;
  EXPECT_TRUE(is_abandoned(earlier)) << "its number has been given to another process";
}

// Names that are nearly ours: none is, and none is touched.
TEST(TemporaryName, IsNoOther) {
  const TemporaryDirectory directory;
  const std::string own = name_of_killed(directory).text();
  const std::set<std::string> others{".raycone-notes",
                                     ".raycone-",
                                     ".raycone-1-2",
                                     own + "~",
                                     own + ".bak",
                                     own + ".batch-",
                                     own + ".batch-0123456789abcdeg",
                                     own + "-1",
                                     "x" + own,
                                     own.substr(1),
                                     ".raycone-0" + own.substr(9),
                                     ".raycone-" + own.substr(10)};
  for (const std::string& name : others) {
    EXPECT_FALSE(temporary_name_from(name)) << name;
    put(directory / name);
  }
  remove_abandoned_files(directory.path().string());
  EXPECT_EQ(names_in(directory), others) << "and the one that was abandoned is gone";
}

TEST(RemoveAbandonedFiles, LeavesThoseOfOthersThatLive) {
  const TemporaryDirectory directory;
  TemporaryName other_host = name_of_killed(directory);
  other_host.host = "0123456789abcdef";
  put(directory / other_host.text());
  OutputFile output(directory / "out");
  remove_abandoned_files(directory.path().string());
  EXPECT_EQ(names_in(directory).size(), 2U) << "that of another host, and that of `output`";
  EXPECT_TRUE(names_in(directory).contains(other_host.text()));
  output.commit();
  EXPECT_TRUE(names_in(directory).contains("out"));
}

TEST(RemoveAbandonedFiles, NeverDisturbsWritersThatStart) {
  const TemporaryDirectory directory;
  std::atomic<bool> done{false};
  std::thread remover([&] {
    while (!done) remove_abandoned_files(directory.path().string());
  });
  for (int i = 0; i < 300; ++i) {
    OutputFile output(directory / "out");
    const std::string text = std::to_string(i);
    output.write(text.data(), text.size());
    EXPECT_NO_THROW(output.commit());
  }
  done = true;
  remover.join();
  EXPECT_EQ(read_text(directory / "out"), "299");
  EXPECT_EQ(names_in(directory), std::set<std::string>{"out"});
}

}  // namespace
}  // namespace raycone
