// Exit statuses, as promised to scripts (README, "Exit status").
#pragma once

namespace raycone {

enum class ExitCode : int {
  kDone = 0,
  kUsage = 1,
  kInput = 2,
  kOutput = 3,
  kLimit = 4,
  kBatch = 5,  // some meshes of a batch failed
  kInternal = 6,
};

}  // namespace raycone
