// How long a computation may go on.
#pragma once

#include <cstdint>

namespace raycone {

// A number of steps, each of a fraction of a microsecond or some.
class Effort {
 public:
  explicit Effort(std::uint64_t steps) : left_(steps) {}

  // Takes one. False where none is left.
  [[nodiscard]] bool take() {
    if (left_ == 0) return false;
    --left_;
    return true;
  }

 private:
  std::uint64_t left_;
};

}  // namespace raycone
