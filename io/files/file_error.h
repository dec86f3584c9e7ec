// Errors about files, worded for the person who named them on the command line.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace raycone {

// A file cannot be read or is invalid: exit status 2. what() is one complete line without the leading "raycone: ":
// "FILE:LINE: what is wrong, what was expected", FILE as given on the command line, LINE a line number or "byte N".
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The same of a file that may be as good as ever: the system refused to read it (permissions, a damaged disk, too many
// open files), or what reads it is not installed or was killed. Another attempt may succeed.
class UnreadableError : public InputError {
 public:
  using InputError::InputError;
};

// Output cannot be written: exit status 3. what() is "FILE: what is wrong".
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A request exceeds a limit (memory, size): exit status 4. what() names the number.
class LimitError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The same where the system refuses what it may grant later: threads, processes.
class UnavailableError : public LimitError {
 public:
  using LimitError::LimitError;
};

// Throws InputError "FILE:byte N: what", bytes counted from 0.
[[noreturn]] inline void fail_at_byte(const std::string& file, std::uint64_t offset, const std::string& what) {
  throw InputError(file + ":byte " + std::to_string(offset) + ": " + what);
}

}  // namespace raycone
