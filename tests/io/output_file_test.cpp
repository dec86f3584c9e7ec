#include "io/files/output_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <climits>
#include <csignal>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "io/files/file_error.h"
#include "io/files/file_time.h"
#include "io/files/spool_file.h"
#include "io/files/temporary_file.h"
#include "tests/support/output_checks.h"
#include "tests/support/pipe.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/text_files.h"

namespace raycone {
namespace {

using test::output_error_of;
using test::read_text;
using test::received_through_pipe;
using test::TemporaryDirectory;
using test::write_text;

void write(OutputFile& output, const std::string& text) { output.write(text.data(), text.size()); }

std::vector<std::string> entries(const TemporaryDirectory& directory) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(directory.path())) {
    names.push_back(entry.path().filename().string());
  }
  return names;
}

mode_t mode_of(const std::string& path) {
  struct stat status {};
  EXPECT_EQ(stat(path.c_str(), &status), 0) << path;
  return status.st_mode & 07777;
}

class Umask {
 public:
  explicit Umask(mode_t mask) : saved_(umask(mask)) {}
  ~Umask() { umask(saved_); }
  Umask(const Umask&) = delete;
  Umask& operator=(const Umask&) = delete;

 private:
  mode_t saved_;
};

TEST(OutputFile, AppearsOnlyWhenCommitted) {
  const TemporaryDirectory directory;
  OutputFile output(directory / "out");
  write(output, "hello");
  output.flush();
  EXPECT_FALSE(std::filesystem::exists(directory / "out"));
  output.commit();
  EXPECT_EQ(read_text(directory / "out"), "hello");
  EXPECT_EQ(entries(directory).size(), 1U);
}

TEST(OutputFile, LeavesNoDebrisWhenNotCommitted) {
  const TemporaryDirectory directory;
  {
    OutputFile output(directory / "out");
    write(output, "hello");
    output.flush();
    ASSERT_EQ(entries(directory).size(), 1U);
  }
  EXPECT_TRUE(entries(directory).empty());
}

TEST(OutputFile, KeepsTheOldFileWhenNotCommitted) {
  const TemporaryDirectory directory;
  write_text(directory / "out", "old");
  {
    OutputFile output(directory / "out");
    write(output, "new");
  }
  EXPECT_EQ(read_text(directory / "out"), "old");
}

TEST(OutputGroup, FilesAppearTogether) {
  const TemporaryDirectory directory;
  OutputGroup group;
  OutputFile first(directory / "first", Existing::kReplaced, &group),
      second(directory / "second", Existing::kReplaced, &group);
  write(first, "1");
  first.commit();
  EXPECT_FALSE(std::filesystem::exists(directory / "first"));
  write(second, "2");
  second.commit();
  EXPECT_FALSE(std::filesystem::exists(directory / "second"));
  group.commit();
  EXPECT_EQ(read_text(directory / "first"), "1");
  EXPECT_EQ(read_text(directory / "second"), "2");
  EXPECT_EQ(entries(directory).size(), 2U);
}

TEST(OutputGroup, TellsWhatItPutInPlace) {
  const TemporaryDirectory directory;
  OutputGroup group;
  OutputFile file(directory / "out", Existing::kReplaced, &group), device("/dev/null", Existing::kReplaced, &group);
  write(file, "hello");
  file.commit();
  device.commit();
  const std::vector<PlacedFile> placed = group.commit();
  ASSERT_EQ(placed.size(), 1U);
  EXPECT_EQ(placed[0].name, directory / "out");
  EXPECT_EQ(placed[0].size, 5U);
  struct stat status {};
  ASSERT_EQ(stat((directory / "out").c_str(), &status), 0);
  EXPECT_EQ(placed[0].modified, nanoseconds(status.st_mtim));
}

TEST(OutputGroup, NoneAppearsWhereOneFails) {
  const TemporaryDirectory directory;
  write_text(directory / "first", "old");
  {
    OutputGroup group;
    OutputFile first(directory / "first", Existing::kReplaced, &group),
        second("/dev/full", Existing::kReplaced, &group);
    write(first, "new");
    first.commit();
    write(second, "2");
    EXPECT_THROW(second.commit(), OutputError);
  }
  EXPECT_EQ(read_text(directory / "first"), "old");
  EXPECT_EQ(entries(directory).size(), 1U);
}

TEST(OutputGroup, FilesOutliveTheirWriters) {
  const TemporaryDirectory directory;
  OutputGroup group;
  {
    OutputFile file(directory / "out", Existing::kReplaced, &group);
    write(file, "hello");
    file.commit();
  }
  group.commit();
  EXPECT_EQ(read_text(directory / "out"), "hello");
}

TEST(OutputFile, RemoveTemporaryFilesRemovesThemOnly) {
  const TemporaryDirectory directory;
  write_text(directory / "other", "kept");
  OutputFile committed(directory / "committed");
  committed.commit();
  OutputFile first(directory / "first");
  OutputFile second(directory / "second");
  ASSERT_EQ(entries(directory).size(), 4U);
  remove_temporary_files();
  EXPECT_EQ(entries(directory).size(), 2U);
  EXPECT_TRUE(std::filesystem::exists(directory / "other"));
  EXPECT_TRUE(std::filesystem::exists(directory / "committed"));
}

TEST(OutputFile, ManyMayBeOpenAtOnce) {
  const TemporaryDirectory directory;
  std::vector<std::unique_ptr<OutputFile>> outputs;
  for (int i = 0; i < 50; ++i) outputs.push_back(std::make_unique<OutputFile>(directory / std::to_string(i)));
  for (auto& output : outputs) output->commit();
  EXPECT_EQ(entries(directory).size(), 50U);
}

TEST(OutputFile, HasModeOfTheUmask) {
  const TemporaryDirectory directory;
  const Umask mask(027);
  OutputFile output(directory / "out");
  output.commit();
  EXPECT_EQ(mode_of(directory / "out"), 0640U);
}

TEST(OutputFile, HasModeOfTheFileItReplaces) {
  const TemporaryDirectory directory;
  const Umask mask(077);
  write_text(directory / "out", "old");
  ASSERT_EQ(chmod((directory / "out").c_str(), 0664), 0);
  OutputFile output(directory / "out");
  write(output, "new");
  output.commit();
  EXPECT_EQ(mode_of(directory / "out"), 0664U);
  EXPECT_EQ(read_text(directory / "out"), "new");
}

TEST(OutputFile, FollowsSymbolicLinks) {
  const TemporaryDirectory directory;
  std::filesystem::create_directory(directory / "real");
  write_text(directory / "real/file", "old");
  std::filesystem::create_symlink("real/file", directory / "middle");
  std::filesystem::create_symlink(directory / "middle", directory / "link");
  OutputFile output(directory / "link");
  write(output, "new");
  output.commit();
  EXPECT_TRUE(std::filesystem::is_symlink(directory / "link"));
  EXPECT_EQ(read_text(directory / "real/file"), "new");
}

TEST(OutputFile, CreatesTheTargetOfADanglingLink) {
  const TemporaryDirectory directory;
  std::filesystem::create_symlink("missing", directory / "link");
  OutputFile output(directory / "link", Existing::kKept);
  write(output, "new");
  output.commit();
  EXPECT_TRUE(std::filesystem::is_symlink(directory / "link"));
  EXPECT_EQ(read_text(directory / "missing"), "new");
}

TEST(OutputFile, RefusesALoopOfLinks) {
  const TemporaryDirectory directory;
  std::filesystem::create_symlink("loop", directory / "loop");
  EXPECT_EQ(output_error_of([&] { OutputFile(directory / "loop"); }),
            directory / "loop" + ": cannot write: Too many levels of symbolic links");
}

TEST(OutputFile, WritesToAFifoWithoutReplacingIt) {
  const TemporaryDirectory directory;
  const std::string fifo = directory / "fifo";
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  std::string received;
  std::thread reader([&] { received = read_text(fifo); });
  {
    OutputFile output(fifo);
    EXPECT_FALSE(output.seekable());
    write(output, "through the pipe");
    output.commit();
  }
  reader.join();
  EXPECT_EQ(received, "through the pipe");
  EXPECT_TRUE(std::filesystem::is_fifo(fifo));
}

TEST(OutputFile, WritesToANamedDescriptor) {
  EXPECT_EQ(received_through_pipe([](const std::string& path) {
              OutputFile output(path);
              write(output, "hello");
              output.commit();
            }),
            "hello");
}

TEST(OutputFile, SeeksOnAPipeToWhereItIsAndNowhereElse) {
  EXPECT_EQ(received_through_pipe([](const std::string& path) {
              OutputFile output(path);
              write(output, "ab");
              output.seek(2);
              write(output, "c");
              output.flush();
              output.seek(3);
              EXPECT_THROW(output.seek(1), OutputError);
            }),
            "abc");
}

// The link there reads "pipe:[...]".
TEST(OutputFile, WritesToAPipeOfAnyProcess) {
  EXPECT_EQ(received_through_pipe([](const std::string& path) {
              OutputFile output("/proc/" + std::to_string(getpid()) + path.substr(path.find("/fd/")));
              write(output, "abc");
              output.commit();
            }),
            "abc");
}

// `raycone -o /dev/stdout >> log` must append to the log, not replace or truncate it.
TEST(OutputFile, WritesToANamedDescriptorOfARegularFileWhereItStands) {
  const TemporaryDirectory directory;
  write_text(directory / "log", "before ");
  const int descriptor = open((directory / "log").c_str(), O_WRONLY | O_APPEND);
  ASSERT_GE(descriptor, 0);
  std::filesystem::create_symlink("/proc/self/fd/" + std::to_string(descriptor), directory / "link");
  OutputFile output(directory / "link");
  EXPECT_FALSE(output.seekable());
  write(output, "after");
  output.commit();
  close(descriptor);
  EXPECT_EQ(read_text(directory / "log"), "before after");
}

TEST(OutputFile, RefusesADescriptorThatIsNotOpenForWriting) {
  const int descriptor = open("/dev/null", O_RDONLY);
  const std::string name = "/dev/fd/" + std::to_string(descriptor);
  EXPECT_EQ(output_error_of([&] { OutputFile{name}; }), name + ": cannot write: Bad file descriptor");
  close(descriptor);
  EXPECT_EQ(output_error_of([&] { OutputFile{name}; }), name + ": cannot write: Bad file descriptor");
}

TEST(OutputFile, WritesToTheNullDeviceEvenWithNoClobber) {
  OutputFile output("/dev/null", Existing::kKept);
  write(output, "hello");
  output.commit();
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(OutputFile, ReportsAFullDisk) {
  OutputFile output("/dev/full");
  write(output, "buffered");
  EXPECT_EQ(output_error_of([&] { output.commit(); }), "/dev/full: cannot write: No space left on device");
}

TEST(OutputFile, ReportsAFullDiskOnTheWayToo) {
  OutputFile output("/dev/full");
  const std::string much(std::size_t{3} << 20, 'x');
  EXPECT_EQ(output_error_of([&] { write(output, much); }), "/dev/full: cannot write: No space left on device");
  EXPECT_EQ(output_error_of([&] { write(output, "x"); }), "/dev/full: cannot write: No space left on device");
}

TEST(OutputFile, ReportsErrorsOfTheStreamInCommit) {
  OutputFile output("/dev/full");
  output.stream() << std::string(std::size_t{3} << 20, 'x');
  EXPECT_EQ(output_error_of([&] { output.commit(); }), "/dev/full: cannot write: No space left on device");
}

TEST(OutputFile, ReportsAClosedPipeWhereTheSignalIsIgnored) {
  const auto saved = std::signal(SIGPIPE, SIG_IGN);
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  close(ends[0]);
  const std::string name = "/dev/fd/" + std::to_string(ends[1]);
  {
    OutputFile output(name);
    write(output, "hello");
    EXPECT_EQ(output_error_of([&] { output.flush(); }), name + ": cannot write: Broken pipe");
  }
  close(ends[1]);
  std::signal(SIGPIPE, saved);
}

TEST(OutputFile, WaitsForAReaderWhereThePipeIsNonBlocking) {
  const std::string much(std::size_t{1} << 20, 'x');  // more than a pipe holds
  const std::string received = received_through_pipe([&](const std::string& path) {
    ASSERT_EQ(fcntl(std::stoi(path.substr(path.rfind('/') + 1)), F_SETFL, O_NONBLOCK), 0);
    OutputFile output(path);
    write(output, much);
    output.commit();
  });
  EXPECT_EQ(received.size(), much.size());
}

TEST(OutputFile, RefusesADirectory) {
  const TemporaryDirectory directory;
  const std::string name = directory.path().string();
  EXPECT_EQ(output_error_of([&] { OutputFile{name}; }), name + ": is a directory");
}

TEST(OutputFile, NamesAMissingDirectory) {
  const TemporaryDirectory directory;
  EXPECT_EQ(output_error_of([&] { OutputFile(directory / "missing/out"); }),
            directory / "missing/out" + ": cannot create a file in " + (directory / "missing") +
                ": No such file or directory");
}

TEST(OutputFile, RefusesAFileUsedAsADirectory) {
  const TemporaryDirectory directory;
  write_text(directory / "file", "");
  EXPECT_EQ(output_error_of([&] { OutputFile(directory / "file/out"); }),
            directory / "file/out" + ": cannot write: Not a directory");
}

TEST(OutputFile, RefusesADirectoryWithoutPermission) {
  if (geteuid() == 0) GTEST_SKIP() << "permissions do not bind root";
  const TemporaryDirectory directory;
  ASSERT_EQ(chmod(directory.path().c_str(), 0500), 0);
  EXPECT_EQ(output_error_of([&] { OutputFile(directory / "out"); }),
            directory / "out" + ": cannot create a file in " + directory.path().string() + ": Permission denied");
  ASSERT_EQ(chmod(directory.path().c_str(), 0700), 0);
}

TEST(OutputFile, TakesTheLongestNames) {
  const TemporaryDirectory directory;
  const std::string name(NAME_MAX, 'n');
  OutputFile output(directory / name);
  output.commit();
  EXPECT_EQ(entries(directory), std::vector<std::string>{name});
  EXPECT_EQ(output_error_of([&] { OutputFile(directory / (name + 'n')); }),
            directory / (name + 'n') + ": cannot write: File name too long");
}

TEST(OutputFile, TakesNamesWithoutDirectory) {
  const TemporaryDirectory directory;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(directory.path());
  OutputFile output("out");
  write(output, "hello");
  output.commit();
  std::filesystem::current_path(before);
  EXPECT_EQ(read_text(directory / "out"), "hello");
}

TEST(OutputFile, NoClobberRefusesAnExistingFileAtOnce) {
  const TemporaryDirectory directory;
  write_text(directory / "out", "old");
  EXPECT_EQ(output_error_of([&] { OutputFile(directory / "out", Existing::kKept); }),
            directory / "out" + ": already exists (--no-clobber)");
  EXPECT_EQ(entries(directory).size(), 1U);
}

TEST(OutputFile, NoClobberDoesNotReplaceAFileThatAppearedMeanwhile) {
  const TemporaryDirectory directory;
  {
    OutputFile output(directory / "out", Existing::kKept);
    write_text(directory / "out", "theirs");
    EXPECT_EQ(output_error_of([&] { output.commit(); }), directory / "out" + ": already exists (--no-clobber)");
  }
  EXPECT_EQ(read_text(directory / "out"), "theirs");
  EXPECT_EQ(entries(directory).size(), 1U);
}

TEST(OutputFile, OverwritesInPlaceAndGoesOnAtTheEnd) {
  const TemporaryDirectory directory;
  OutputFile output(directory / "out");
  ASSERT_TRUE(output.seekable());
  write(output, "????, world");
  output.overwrite(0, "Hell", 4);
  output.overwrite(3, "lo", 1);
  write(output, "!");
  output.commit();
  EXPECT_EQ(read_text(directory / "out"), "Hell, world!");
}

TEST(OutputFile, StreamAndWriteShareOneBuffer) {
  const TemporaryDirectory directory;
  OutputFile output(directory / "out");
  write(output, "a");
  output.stream() << "bc";
  EXPECT_EQ(output.stream().tellp(), 3);
  output.stream().seekp(1);
  output.stream() << 'B';
  output.stream().seekp(3);
  write(output, std::string(std::size_t{3} << 20, 'd'));  // more than the buffer holds
  EXPECT_EQ(output.stream().tellp(), 3 + (3 << 20));
  output.commit();
  const std::string text = read_text(directory / "out");
  EXPECT_EQ(text.substr(0, 5), "aBcdd");
  EXPECT_EQ(text.size(), 3U + (std::size_t{3} << 20));
}

TEST(OutputFile, ReservesRoomThatThereIsAndRefusesWhatThereIsNot) {
  const TemporaryDirectory directory;
  OutputFile output(directory / "out");
  EXPECT_NO_THROW(output.reserve(1 << 20));
  write(output, "short");
  const std::string message = output_error_of([&] { output.reserve(std::uint64_t{1} << 60); });
  EXPECT_NE(message.find("No space left on device: needs 1 EB or more, "), std::string::npos) << message;
  output.commit();
  EXPECT_EQ(read_text(directory / "out"), "short") << "room that was reserved is no content";
  struct stat status {};
  ASSERT_EQ(stat((directory / "out").c_str(), &status), 0);
  EXPECT_LT(status.st_blocks * 512, 1 << 19) << "and is given back";
  OutputFile device("/dev/null");
  EXPECT_NO_THROW(device.reserve(std::uint64_t{1} << 60));
}

TEST(SpoolFile, CopiesItsFinalBytes) {
  const TemporaryDirectory directory;
  OutputFile output(directory / "out");
  SpoolFile spool(output.name());
  const std::string much(std::size_t{3} << 20, 'x');
  spool.stream() << "????" << much;
  spool.stream().seekp(0);
  spool.stream() << "head";
  spool.copy_to(output);
  output.commit();
  EXPECT_EQ(read_text(directory / "out"), "head" + much);
}

}  // namespace
}  // namespace raycone
