#include "core/exact/integer_memory.h"

#include <gmp.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <mutex>
#include <string_view>

namespace raycone {
namespace {

// For the numbers of one expression in each thread, some dozens. Numbers that are kept for longer live in containers,
// whose own allocation fails first where memory is short.
class Reserve {
 public:
  // Aborts where it has no room.
  void* allocate(std::size_t size) {
    const std::lock_guard lock(mutex_);
    const auto slot = std::ranges::find(is_taken_, false);
    if (size > kSlot || slot == is_taken_.end()) fail();
    *slot = true;
    return &slots_[static_cast<std::size_t>(slot - is_taken_.begin()) * kSlot];
  }

  // Whether the block was from here. The caller then has no use for it any more.
  bool release(const void* block) {
    if (!holds(block)) return false;
    const std::lock_guard lock(mutex_);
    is_taken_[static_cast<std::size_t>(static_cast<const std::byte*>(block) - slots_.data()) / kSlot] = false;
    return true;
  }

  [[nodiscard]] bool holds(const void* block) const {
    const std::less<const void*> before;
    return !before(block, slots_.data()) && before(block, slots_.data() + slots_.size());
  }

 private:
  static constexpr std::size_t kSlot = 1024, kSlots = 512;

  [[noreturn]] static void fail() {
    constexpr std::string_view kMessage = "raycone: no memory is left for integers\n";
    if (write(STDERR_FILENO, kMessage.data(), kMessage.size()) < 0) std::abort();
    std::abort();
  }

  std::mutex mutex_;
  std::array<bool, kSlots> is_taken_{};
  alignas(std::max_align_t) std::array<std::byte, kSlot * kSlots> slots_{};
};

constinit Reserve reserve{};

void* allocate(std::size_t size) {
  void* const block = std::malloc(size);
  return block ? block : reserve.allocate(size);
}

void release(void* block, std::size_t /*size*/) {
  if (!reserve.release(block)) std::free(block);
}

void* reallocate(void* block, std::size_t size, std::size_t new_size) {
  if (!reserve.holds(block)) {
    if (void* const moved = std::realloc(block, new_size)) return moved;
  }
  void* const moved = allocate(new_size);
  std::memcpy(moved, block, std::min(size, new_size));
  release(block, size);
  return moved;
}

}  // namespace

void reserve_memory_for_integers() { mp_set_memory_functions(allocate, reallocate, release); }

}  // namespace raycone
