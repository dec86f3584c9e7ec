// Memory for destructors that need some.
#pragma once

#include <cstddef>
#include <new>

namespace raycone {

// nlohmann-json's values allocate where they are destroyed, and end the process where they cannot. This keeps memory
// aside for that: the first allocation that fails frees it, and throws std::bad_alloc as ever. To be made before the
// values. One at a time in a process; a second one does nothing.
class UnwindingReserve {
 public:
  UnwindingReserve();
  ~UnwindingReserve();
  UnwindingReserve(const UnwindingReserve&) = delete;
  UnwindingReserve& operator=(const UnwindingReserve&) = delete;

  // Makes it enough for so many values in all. Throws std::bad_alloc.
  void cover(std::size_t values);
  [[nodiscard]] std::size_t covered() const { return covered_; }

 private:
  bool is_in_use_;
  std::size_t covered_ = 0;
  std::new_handler former_ = nullptr;
};

}  // namespace raycone
