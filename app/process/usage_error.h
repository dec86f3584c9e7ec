// The command line itself is wrong: exit status 1.
#pragma once

#include <stdexcept>

namespace raycone {

// what() is one complete line without the leading "raycone: ".
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The same of an output that would replace an input, or another output.
class ReplacesFileError : public UsageError {
 public:
  using UsageError::UsageError;
};

}  // namespace raycone
