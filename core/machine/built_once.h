// What is built when it is first needed, and kept.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>

namespace raycone {

// A value that the first caller makes. Thread-safe: whoever asks meanwhile waits, so that within a loop over tasks only
// what starts no such loop itself may be made. Neither copied nor moved.
template <class T>
class BuiltOnce {
 public:
  // make(): a T. Where it throws, nothing was built, and the next caller makes it.
  template <class Make>
  const T& get(const Make& make) const {
    std::call_once(once_, [&] {
      value_.reset(new T(make()));  // which need not be movable
      built_.store(value_.get(), std::memory_order_release);
    });
    return *value_;
  }

  // Null until it is made.
  [[nodiscard]] const T* if_built() const { return built_.load(std::memory_order_acquire); }

 private:
  mutable std::once_flag once_;
  mutable std::unique_ptr<const T> value_;
  mutable std::atomic<const T*> built_ = nullptr;
};

}  // namespace raycone
