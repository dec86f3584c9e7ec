#include "app/input/grid_reader.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <new>
#include <optional>
#include <system_error>
#include <type_traits>
#include <utility>

#include "app/process/own_process.h"
#include "app/process/signals.h"
#include "io/files/descriptor.h"
#include "io/files/file_error.h"
#include "io/vdb/read_vdb.h"

namespace raycone {
namespace {

// What the reader writes: one of these letters, and behind it what was read or the message.
enum Outcome : char {
  kRead = 'r',
  kInvalid = 'i',
  kUnreadable = 'u',
  kLimited = 'l',
  kUnavailable = 'a',
  kOutOfMemory = 'm'
};

constexpr const char* kLatticeWord = "lattice";
constexpr const char* kFactsWord = "facts";

std::string bytes_of(const PlacedLattice& lattice) {
  static_assert(std::is_trivially_copyable_v<PlacedLattice>);
  return {reinterpret_cast<const char*>(&lattice), sizeof lattice};
}

// Texts one after the other, each behind its size.
class Texts {
 public:
  explicit Texts(std::string bytes = "") : bytes_(std::move(bytes)) {}

  void put(const std::string& text) {
    const std::uint64_t size = text.size();
    bytes_.append(reinterpret_cast<const char*>(&size), sizeof size).append(text);
  }
  // Nothing where there is no other.
  [[nodiscard]] std::optional<std::string> take() {
    std::uint64_t size = 0;
    if (bytes_.size() - at_ < sizeof size) return std::nullopt;
    std::memcpy(&size, &bytes_[at_], sizeof size);
    if (bytes_.size() - at_ - sizeof size < size) return std::nullopt;
    at_ += sizeof size + size;
    return bytes_.substr(at_ - size, size);
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

// Grids and facts come behind the rest, in groups of two and three.
std::string bytes_of(const VolumeFacts& facts) {
  Texts texts;
  texts.put(facts.format);
  texts.put(facts.lattice ? bytes_of(*facts.lattice) : "");
  texts.put(facts.no_lattice);
  texts.put(std::to_string(facts.arrays.size()));
  for (const ArrayFacts& grid : facts.arrays) {
    texts.put(grid.name);
    texts.put(grid.type);
  }
  for (const MadeFact& fact : facts.made) {
    texts.put(fact.key);
    texts.put(fact.value);
    texts.put(fact.is_json ? "1" : "");
  }
  return texts.bytes();
}

std::string read_as(const std::string& what, const std::string& path, const std::string& name) {
  return what == kFactsWord ? bytes_of(read_vdb_facts(path)) : bytes_of(read_vdb_lattice(path, name));
}

std::string outcome_of_reading(const std::string& what, const std::string& path, const std::string& name) {
  try {
    return std::string(1, kRead) + read_as(what, path, name);
  } catch (const UnreadableError& error) {
    return std::string(1, kUnreadable) + error.what();
  } catch (const InputError& error) {
    return std::string(1, kInvalid) + error.what();
  } catch (const UnavailableError& error) {
    return std::string(1, kUnavailable) + error.what();
  } catch (const LimitError& error) {
    return std::string(1, kLimited) + error.what();
  } catch (const std::bad_alloc&) {
    return std::string(1, kOutOfMemory);
  }
}

[[noreturn]] void fail_disturbed(const std::string& path) {
  throw UnreadableError(path + ": cannot read: the process that does it was disturbed");
}

// What was read.
std::string content_of(const std::string& path, const std::string& outcome) {
  if (outcome[0] == kInvalid) throw InputError(outcome.substr(1));
  if (outcome[0] == kUnreadable) throw UnreadableError(outcome.substr(1));
  if (outcome[0] == kUnavailable) throw UnavailableError(outcome.substr(1));
  if (outcome[0] == kLimited) throw LimitError(outcome.substr(1));
  if (outcome[0] == kOutOfMemory) throw std::bad_alloc();
  if (outcome[0] != kRead) fail_disturbed(path);
  return outcome.substr(1);
}

PlacedLattice lattice_from(const std::string& path, const std::string& bytes) {
  PlacedLattice lattice;
  if (bytes.size() != sizeof lattice) fail_disturbed(path);
  std::memcpy(&lattice, bytes.data(), sizeof lattice);
  return lattice;
}

VolumeFacts facts_from(const std::string& path, const std::string& bytes) {
  Texts texts(bytes);
  const auto next = [&] {
    std::optional<std::string> text = texts.take();
    if (!text) fail_disturbed(path);
    return *text;
  };
  VolumeFacts facts;
  facts.format = next();
  if (const std::string lattice = next(); !lattice.empty()) facts.lattice = lattice_from(path, lattice);
  facts.no_lattice = next();
  const std::string grids = next();
  while (std::to_string(facts.arrays.size()) != grids) {
    const std::string name = next();
    facts.arrays.push_back({name, next()});
  }
  while (std::optional<std::string> key = texts.take()) {
    const std::string value = next();
    facts.made.push_back({*key, value, !next().empty()});
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

// What another process has read.
std::string read_elsewhere(const std::string& what, const std::string& path, const std::string& name) {
  Pipe pipe = open_pipe(path);
  const pid_t process = start_reader(pipe.writing, what, path, name);
  pipe.writing = Descriptor();  // else there would be no end to what is read
  const std::string outcome = read_to_end(pipe.reading);
  const std::string end = end_of(process, path);
  if (!end.empty()) throw InputError(path + ": not a readable OpenVDB file: it crashed OpenVDB (" + end + ")");
  return content_of(path, outcome);
}

}  // namespace

ExitCode run_grid_reader(const std::vector<std::string>& words) {
  const std::string outcome = outcome_of_reading(words.at(1), words.at(2), words.at(3));
  const ssize_t written = write(std::stoi(words.at(0)), outcome.data(), outcome.size());
  return written == static_cast<ssize_t>(outcome.size()) ? ExitCode::kDone : ExitCode::kOutput;
}

PlacedLattice read_grid_lattice(const std::string& path, const std::string& name) {
  return lattice_from(path, read_elsewhere(kLatticeWord, path, name));
}

VolumeFacts read_grid_facts(const std::string& path) { return facts_from(path, read_elsewhere(kFactsWord, path, "")); }

}  // namespace raycone
