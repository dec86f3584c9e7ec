#include "app/input/grid_reader.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <new>
#include <stdexcept>
#include <system_error>
#include <type_traits>

#include "app/process/message.h"
#include "app/process/own_process.h"
#include "app/process/signals.h"
#include "io/files/descriptor.h"
#include "io/files/file_error.h"
#include "io/vdb/read_vdb.h"

namespace raycone {
namespace {

// What the reader writes is a message that begins with one of these words. Behind it is what was read, or why not.
constexpr const char* kRead = "read";
constexpr const char* kInvalid = "invalid";
constexpr const char* kUnreadable = "unreadable";
constexpr const char* kLimited = "limited";
constexpr const char* kUnavailable = "unavailable";
constexpr const char* kOutOfMemory = "out of memory";

constexpr const char* kLatticeWord = "lattice";
constexpr const char* kFactsWord = "facts";

std::string bytes_of(const PlacedLattice& lattice) {
  static_assert(std::is_trivially_copyable_v<PlacedLattice>);
  return {reinterpret_cast<const char*>(&lattice), sizeof lattice};
}

// The facts as a message: grids and notes on how the file was made come last, in groups of two and three.
Message message_of(const VolumeFacts& facts) {
  Message message{facts.format, facts.lattice ? bytes_of(*facts.lattice) : "", facts.no_lattice,
                  std::to_string(facts.arrays.size())};
  for (const ArrayFacts& grid : facts.arrays) message.insert(message.end(), {grid.name, grid.type});
  for (const MadeFact& fact : facts.made)
    message.insert(message.end(), {fact.key, fact.value, fact.is_json ? "1" : ""});
  return message;
}

Message what_was_read(const std::string& what, const std::string& path, const std::string& name) {
  return what == kFactsWord ? message_of(read_vdb_facts(path)) : Message{bytes_of(read_vdb_lattice(path, name))};
}

Message outcome_of_reading(const std::string& what, const std::string& path, const std::string& name) {
  try {
    Message message = what_was_read(what, path, name);
    message.insert(message.begin(), kRead);
    return message;
  } catch (const UnreadableError& error) {
    return {kUnreadable, error.what()};
  } catch (const InputError& error) {
    return {kInvalid, error.what()};
  } catch (const UnavailableError& error) {
    return {kUnavailable, error.what()};
  } catch (const LimitError& error) {
    return {kLimited, error.what()};
  } catch (const std::bad_alloc&) {
    return {kOutOfMemory, ""};
  }
}

[[noreturn]] void fail_disturbed(const std::string& path) {
  throw UnreadableError(path + ": cannot read: the process that does it was disturbed");
}

// Throws what the reader did, where it read nothing.
[[noreturn]] void fail_as_reader(const std::string& path, const Message& outcome) {
  if (outcome.size() != 2) fail_disturbed(path);
  if (outcome[0] == kInvalid) throw InputError(outcome[1]);
  if (outcome[0] == kUnreadable) throw UnreadableError(outcome[1]);
  if (outcome[0] == kUnavailable) throw UnavailableError(outcome[1]);
  if (outcome[0] == kLimited) throw LimitError(outcome[1]);
  if (outcome[0] == kOutOfMemory) throw std::bad_alloc();
  fail_disturbed(path);
}

// The next two throw std::runtime_error for bytes that no reader writes.
PlacedLattice lattice_from(const std::string& bytes) {
  PlacedLattice lattice;
  if (bytes.size() != sizeof lattice) throw std::runtime_error("a lattice of another size");
  std::memcpy(&lattice, bytes.data(), sizeof lattice);
  return lattice;
}

VolumeFacts facts_from(MessageStrings& strings) {
  VolumeFacts facts;
  facts.format = strings.text();
  if (const std::string lattice = strings.text(); !lattice.empty()) facts.lattice = lattice_from(lattice);
  facts.no_lattice = strings.text();
  for (std::size_t left = strings.count(); left > 0; --left) {
    const auto grid = strings.take(2);
    facts.arrays.push_back({grid[0], grid[1]});
  }
  while (!strings.rest().empty()) {
    const auto fact = strings.take(3);
    facts.made.push_back({fact[0], fact[1], !fact[2].empty()});
  }
  return facts;
}

struct Pipe {
  Descriptor reading, writing;
};

Pipe open_pipe(const std::string& path) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) == 0) return {Descriptor(ends[0]), Descriptor(ends[1])};
  throw UnavailableError(path + ": cannot open a pipe: " + std::generic_category().message(errno));
}

// In the child: async-signal-safe calls only.
void prepare_reader(const Descriptor& answer) {
  ignore_interruptions();
  constexpr rlimit kNone{0, 0};
  setrlimit(RLIMIT_CORE, &kNone);
  const int nowhere = open("/dev/null", O_WRONLY);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
  fcntl(answer.number(), F_SETFD, 0);  // stays open
}

pid_t start_reader(const Descriptor& answer, const std::string& what, const std::string& path,
                   const std::string& name) {
  const HeldSignals until_child_ignores_them;
  try {
    return start_anew({kGridReaderCommand, std::to_string(answer.number()), what, path, name},
                      [&answer] { prepare_reader(answer); });
  } catch (const std::system_error& error) {
    throw UnavailableError(path + ": cannot start another process: " + error.code().message());
  }
}

std::string read_to_end(const Descriptor& file) {
  std::string bytes;
  char buffer[4096];
  for (;;) {
    const ssize_t count = read(file.number(), buffer, sizeof buffer);
    if (count == 0 || (count < 0 && errno != EINTR)) return bytes;
    if (count > 0) bytes.append(buffer, static_cast<std::size_t>(count));
  }
}

// How it ended, for people; nothing where it ended well. Throws std::bad_alloc where it had no memory to say so itself,
// UnreadableError where it was killed.
std::string end_of(pid_t process, const std::string& path) {
  int state = 0;
  while (waitpid(process, &state, 0) < 0 && errno == EINTR) continue;
  if (WIFSIGNALED(state) && WTERMSIG(state) == SIGKILL) fail_disturbed(path);  // no fault of the file's
  if (WIFSIGNALED(state)) return strsignal(WTERMSIG(state));
  const int status = WEXITSTATUS(state);
  if (status == kNotExecuted) throw UnavailableError(path + ": cannot start another process: execution was refused");
  if (status == kNotStarted || status == static_cast<int>(ExitCode::kLimit)) throw std::bad_alloc();
  return status == 0 ? "" : "exit status " + std::to_string(status);
}

// Starts a reader, waits for it, and returns what it wrote.
std::string answer_of_reader(const std::string& what, const std::string& path, const std::string& name) {
  Pipe pipe = open_pipe(path);
  const pid_t process = start_reader(pipe.writing, what, path, name);
  pipe.writing = Descriptor();  // else there would be no end to what is read
  std::string answer = read_to_end(pipe.reading);
  const std::string end = end_of(process, path);
  if (!end.empty()) throw InputError(path + ": not a readable OpenVDB file: it crashed OpenVDB (" + end + ")");
  return answer;
}

// Has another process read a file. Returns what `take` makes of the strings that it wrote.
template <typename Take>
auto read_elsewhere(const std::string& what, const std::string& path, const std::string& name, const Take& take) {
  const std::string answer = answer_of_reader(what, path, name);
  Message outcome;
  try {
    outcome = message_from(answer);
    MessageStrings strings(outcome);
    if (strings.text() == kRead) return take(strings);
  } catch (const std::runtime_error&) {
    fail_disturbed(path);
  }
  fail_as_reader(path, outcome);
}

}  // namespace

ExitCode run_grid_reader(const std::vector<std::string>& words) {
  const std::string answer = to_bytes(outcome_of_reading(words.at(1), words.at(2), words.at(3)));
  const ssize_t written = write(std::stoi(words.at(0)), answer.data(), answer.size());
  return written == static_cast<ssize_t>(answer.size()) ? ExitCode::kDone : ExitCode::kOutput;
}

PlacedLattice read_grid_lattice(const std::string& path, const std::string& name) {
  return read_elsewhere(kLatticeWord, path, name, [](MessageStrings& strings) { return lattice_from(strings.text()); });
}

VolumeFacts read_grid_facts(const std::string& path) { return read_elsewhere(kFactsWord, path, "", facts_from); }

}  // namespace raycone
