// Times of files as one number.
#pragma once

#include <sys/stat.h>

#include <chrono>
#include <cstdint>

namespace raycone {

// Nanoseconds since 1970.
[[nodiscard]] inline std::int64_t nanoseconds(const timespec& time) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  return static_cast<std::int64_t>(time.tv_sec) * kSecond + static_cast<std::int64_t>(time.tv_nsec);
}

// The same of now, by the clock of this host.
[[nodiscard]] inline std::int64_t nanoseconds_now() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
}

}  // namespace raycone
