// OpenVDB's libraries take tens of milliseconds to load, in which a mesh can be read.
#pragma once

#include <thread>

namespace raycone {

// Loads the module for OpenVDB on a thread of its own, where `wanted`. Only a hint: whoever needs the module loads it,
// or waits for it, and is told what is wrong. Not for processes that are short of threads or memory, which libraries
// cannot handle while they are loaded. Waits for its thread at the end.
class VdbModulePreload {
 public:
  explicit VdbModulePreload(bool wanted);
  ~VdbModulePreload();
  VdbModulePreload(const VdbModulePreload&) = delete;
  VdbModulePreload& operator=(const VdbModulePreload&) = delete;

 private:
  std::thread thread_;
};

}  // namespace raycone
