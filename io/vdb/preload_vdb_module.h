// OpenVDB's libraries take tens of milliseconds to load, in which a mesh can be read.
#pragma once

#include <thread>

namespace raycone {

// Loads the module for OpenVDB on a thread of its own. Only a hint: whoever needs the module loads it, or waits for it,
// and is told what is wrong. Not for processes that are short of memory while it loads, which the libraries cannot
// handle. Waits for its thread at the end.
class VdbModulePreload {
 public:
  VdbModulePreload() = default;
  // `others`: the threads that may be started meanwhile. Does nothing where there may not be as many.
  explicit VdbModulePreload(int others);

 private:
  std::jthread thread_;
};

}  // namespace raycone
