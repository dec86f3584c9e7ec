// Keeps batches with different options out of each other's directory while they run.
#pragma once

#include <chrono>
#include <string>

#include "io/files/descriptor.h"
#include "io/files/temporary_file.h"

namespace raycone {

// An empty file whose name tells who is at work in a directory, and by a hash with which options; there while this
// lives. A row could else describe one batch beside a file of the other, and never be made again. Needs no locks, which
// many network file systems keep to a host.
class BatchMarker {
 public:
  // Throws OutputError where a batch with other `options` runs in `directory`. Of two that start at once at least one
  // is refused. One on another host has ended when it has given no sign of life for ten minutes.
  BatchMarker(const std::string& directory, const std::string& options);

  // To be called again and again: from time to time it gives a sign of life.
  void renew();

 private:
  TemporaryFile file_;
  Descriptor descriptor_;
  std::chrono::steady_clock::time_point renewed_ = std::chrono::steady_clock::now();
};

}  // namespace raycone
