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

// Of another process of our own: it lacked memory to start. Also the dynamic linker's, which lacks a library, too.
inline constexpr int kNotStarted = 127;
// Likewise, for another reason: its file may not be executed, as in shells.
inline constexpr int kNotExecuted = 126;

}  // namespace raycone
