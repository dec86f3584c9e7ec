#include "io/mesh/unwinding_reserve.h"

#include <atomic>
#include <cstdlib>
#include <exception>

namespace raycone {
namespace {

// A value takes 16 bytes on the stack of values that are still to be destroyed, which grows by doubling: then the old
// one and one of twice its size are there.
constexpr std::size_t kBytesPerValue = 48;

std::atomic<bool> is_taken = false;
std::atomic<void*> memory = nullptr;

// Where another exception passes already, it is a destructor that asks, and tries again.
void give_back() {
  void* const kept = memory.exchange(nullptr);
  std::free(kept);
  if (!kept || std::uncaught_exceptions() == 0) throw std::bad_alloc();
}

}  // namespace

UnwindingReserve::UnwindingReserve() : is_in_use_(!is_taken.exchange(true)) {
  if (is_in_use_) former_ = std::set_new_handler(&give_back);
}

UnwindingReserve::~UnwindingReserve() {
  if (!is_in_use_) return;
  std::set_new_handler(former_);
  std::free(memory.exchange(nullptr));
  is_taken = false;
}

void UnwindingReserve::cover(std::size_t values) {
  if (!is_in_use_ || values <= covered_) return;
  void* const more = std::malloc(values * kBytesPerValue);  // before the other one is given up
  if (!more) throw std::bad_alloc();
  std::free(memory.exchange(more));
  covered_ = values;
}

}  // namespace raycone
