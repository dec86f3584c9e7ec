// Wording of errors that the readers of volumes share.
#pragma once

#include <string>

#include "io/files/file_error.h"

namespace raycone {

// Throws InputError.
[[noreturn]] inline void fail_as_volume(const std::string& path, const std::string& what) {
  throw InputError(path + ": not a readable volume: " + what);
}

}  // namespace raycone
