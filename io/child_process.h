// Work that hostile bytes may crash, in a process of its own.
#pragma once

#include <functional>
#include <stdexcept>
#include <string>

namespace raycone {

// what() tells how the child ended: "Segmentation fault", "exit status 1".
class ChildDied : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The bytes that `work` returns, computed in a copy of this process: whatever it crashes or changes there, this one
// goes on. The copy prints nothing, leaves no core file, takes no signals and ends with this process at the latest.
// `work` must not wait for other threads, which the copy lacks, and an exception that leaves it is a crash. Throws
// ChildDied, and LimitError where there is no room for another process.
[[nodiscard]] std::string in_child_process(const std::function<std::string()>& work);

}  // namespace raycone
