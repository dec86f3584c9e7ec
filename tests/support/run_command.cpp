// By fork, exec and poll.
#include "tests/support/run_command.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <stdexcept>
#include <thread>

namespace raycone::test {
namespace {

constexpr int kPatienceOfPoll = std::chrono::milliseconds(kPatience).count();

struct Pipe {
  int read_end = -1;
  int write_end = -1;
};

Pipe make_pipe() {
  int ends[2];
  // Not inherited by commands started later, who would keep it open.
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  return {ends[0], ends[1]};
}

void close_if_open(int& descriptor) {
  if (descriptor >= 0) close(descriptor);
  descriptor = -1;
}

[[noreturn]] void become(const std::vector<std::string>& arguments, const CommandOptions& options) {
  const rlimit none{0, 0};  // of the cores that tests of crashes would leave
  setrlimit(RLIMIT_CORE, &none);
  for (const auto& [name, value] : options.environment) setenv(name.c_str(), value.c_str(), 1);
  if (options.file_size_limit) {
    const rlimit limit{*options.file_size_limit, *options.file_size_limit};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  for (const int signal : options.ignored_signals) ::signal(signal, SIG_IGN);
  std::vector<char*> words;
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  execv(words[0], words.data());
  _exit(127);
}

}  // namespace

bool becomes_true(const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!condition() && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return condition();
}

Command::Command(const std::vector<std::string>& arguments, const CommandOptions& options) {
  Pipe input = make_pipe();
  Pipe output = make_pipe();
  Pipe error = make_pipe();
  signal(SIGPIPE, SIG_IGN);  // ours, when the command does not read its input
  process_ = fork();
  if (process_ == 0) {
    signal(SIGPIPE, SIG_DFL);
    dup2(input.read_end, STDIN_FILENO);
    dup2(output.write_end, STDOUT_FILENO);
    dup2(error.write_end, STDERR_FILENO);
    if (options.output_file) dup2(open(options.output_file->c_str(), O_WRONLY | O_CREAT, 0666), STDOUT_FILENO);
    if (options.close_output) close(STDOUT_FILENO);
    if (options.break_output_pipe) close(output.read_end);
    become(arguments, options);
  }
  close(input.read_end);
  close(output.write_end);
  close(error.write_end);
  input_ = input.write_end;
  output_ = output.read_end;
  error_ = error.read_end;
  if (options.break_output_pipe) close_if_open(output_);
  if (process_ < 0) throw std::runtime_error("cannot start " + arguments.front());
}

Command::~Command() {
  if (process_ > 0) {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  for (int* const descriptor : {&input_, &output_, &error_}) close_if_open(*descriptor);
}

void Command::write(const std::string& text) const {
  for (std::size_t written = 0; written < text.size();) {
    const ssize_t count = ::write(input_, text.data() + written, text.size() - written);
    if (count < 0) return;  // the command has closed its input, which is its right
    written += static_cast<std::size_t>(count);
  }
}

void Command::close_input() { close_if_open(input_); }

void Command::send_signal(int signal) const { kill(process_, signal); }

void Command::read_available(int& descriptor, std::string& text) const {
  char buffer[65536];
  const ssize_t count = read(descriptor, buffer, sizeof buffer);
  if (count > 0) {
    text.append(buffer, static_cast<std::size_t>(count));
  } else {
    close_if_open(descriptor);
  }
}

std::optional<std::string> Command::read_bytes(std::size_t count) {
  while (out_.size() < count) {
    pollfd ready{output_, POLLIN, 0};
    if (output_ < 0 || poll(&ready, 1, kPatienceOfPoll) <= 0) return std::nullopt;
    read_available(output_, out_);
  }
  std::string bytes = out_.substr(0, count);
  out_.erase(0, count);
  return bytes;
}

std::optional<std::string> Command::read_line() {
  std::size_t end;
  while ((end = out_.find('\n')) == std::string::npos) {
    pollfd ready{output_, POLLIN, 0};
    if (output_ < 0 || poll(&ready, 1, kPatienceOfPoll) <= 0) return std::nullopt;
    read_available(output_, out_);
  }
  std::string line = out_.substr(0, end);
  out_.erase(0, end + 1);
  return line;
}

CommandResult Command::wait() {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (output_ >= 0 || error_ >= 0) {
    pollfd ready[2] = {{output_, POLLIN, 0}, {error_, POLLIN, 0}};
    poll(ready, 2, 1000);
    if (ready[0].revents) read_available(output_, out_);
    if (ready[1].revents) read_available(error_, err_);
    if (std::chrono::steady_clock::now() > deadline) kill(process_, SIGKILL);
  }
  int state = 0;
  waitpid(process_, &state, 0);
  process_ = -1;
  return {WIFEXITED(state) ? WEXITSTATUS(state) : -1, WIFSIGNALED(state) ? WTERMSIG(state) : 0, out_, err_};
}

CommandResult run_raycone(const std::vector<std::string>& arguments, const CommandOptions& options) {
  Command command(raycone_command(arguments), options);
  command.write(options.input);
  command.close_input();
  return command.wait();
}

std::vector<std::string> raycone_command(const std::vector<std::string>& arguments) {
  const char* const other = std::getenv("RAYCONE_TEST_EXECUTABLE");
  return with_more({other ? other : RAYCONE_EXECUTABLE}, arguments);
}

std::vector<std::string> with_more(std::vector<std::string> words, const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

}  // namespace raycone::test
