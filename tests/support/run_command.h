// Runs the real executable, as a script would.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace raycone::test {

// What takes longer than this hangs, however busy the machine is. Below the time that CTest gives to a test.
inline constexpr std::chrono::seconds kPatience{300};

// Whether `condition` comes to hold in that time.
[[nodiscard]] bool becomes_true(const std::function<bool()>& condition);

struct CommandResult {
  int status = -1;  // exit status; -1 if a signal ended it
  int signal = 0;   // that signal, else 0
  std::string out;
  std::string err;
};

struct CommandOptions {
  std::string input{};                               // standard input, closed behind it
  std::map<std::string, std::string> environment{};  // added to this process's
  std::optional<std::string> output_file{};          // opened as standard output in place of a pipe
  std::optional<std::uint64_t> file_size_limit{};    // RLIMIT_FSIZE, bytes
  bool close_output = false;                         // standard output is closed at the start
  bool break_output_pipe = false;                    // nobody reads standard output
  std::vector<int> ignored_signals{};                // ignored at the start, as under nohup
};

// A command that runs; killed if still running at the end of its life.
class Command {
 public:
  explicit Command(const std::vector<std::string>& arguments, const CommandOptions& options = {});
  ~Command();
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;

  void write(const std::string& text) const;
  void close_input();
  // The next line of standard output without its line feed; nothing if none comes in time or ever.
  [[nodiscard]] std::optional<std::string> read_line();
  // The next `count` bytes of standard output; nothing if they do not come in time or ever.
  [[nodiscard]] std::optional<std::string> read_bytes(std::size_t count);
  void send_signal(int signal) const;
  [[nodiscard]] pid_t process() const { return process_; }
  // Reads both outputs to their ends.
  [[nodiscard]] CommandResult wait();

 private:
  void read_available(int& descriptor, std::string& text) const;

  pid_t process_ = -1;
  int input_ = -1;  // our ends of the pipes; -1 where closed
  int output_ = -1;
  int error_ = -1;
  std::string out_;
  std::string err_;
};

// Executable `raycone` with these arguments: this build's, or that of RAYCONE_TEST_EXECUTABLE (tests/sanitize.sh).
[[nodiscard]] CommandResult run_raycone(const std::vector<std::string>& arguments, const CommandOptions& options = {});
[[nodiscard]] std::vector<std::string> raycone_command(const std::vector<std::string>& arguments);

// `words`, and `more` behind them.
[[nodiscard]] std::vector<std::string> with_more(std::vector<std::string> words, const std::vector<std::string>& more);

}  // namespace raycone::test
