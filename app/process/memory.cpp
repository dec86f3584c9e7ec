// Memory without its hidden costs: touching a new page takes a microsecond or two, and with pages of 4 kB that was half
// of the time that reading, welding and edge tables took. The heap and large blocks therefore come in huge pages, which
// many systems give only to who asks for them (Linux, admin-guide/mm/transhuge, "madvise"), and smaller blocks are kept
// when they are freed, for the next step to use.
#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <new>

namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20;
// Smaller blocks would waste too much of their last page.
constexpr std::size_t kLargeBlock = 4 * kHugePage;
// After blocks of this size the heap is looked at; smaller ones are many.
constexpr std::size_t kLeastFollowed = std::size_t{1} << 16;

constexpr int kKept = 1 << 26;
[[maybe_unused]] const int done_at_start =
    mallopt(M_MMAP_THRESHOLD, static_cast<int>(kLargeBlock)) + mallopt(M_TRIM_THRESHOLD, kKept);

std::atomic<std::uintptr_t> heap_end = 0;  // when it was looked at last

// Asks for huge pages where the heap has grown. It grows by more than one block at a time (cap_memory() in
// memory_limit.cpp), so that most of what is new has not been touched. `block`: a new one. Blocks of other threads may
// have heaps of their own, which stay as they are. Failures cost time only.
void follow_heap(std::uintptr_t block) {
  const auto end = reinterpret_cast<std::uintptr_t>(sbrk(0));
  if (block == 0 || block >= end || end == heap_end.load(std::memory_order_relaxed)) return;
  const std::uintptr_t known = heap_end.exchange(end, std::memory_order_relaxed);
  const std::uintptr_t grown = known > 0 ? known : block;
  const std::uintptr_t begin = grown / kHugePage * kHugePage;
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

// Null where there is no memory left.
void* allocate_large(std::size_t size) {
  const std::size_t whole_pages = (size + kHugePage - 1) / kHugePage * kHugePage;
  if (whole_pages < size) return nullptr;
  void* const block = std::aligned_alloc(kHugePage, whole_pages);
  if (block) madvise(block, whole_pages, MADV_HUGEPAGE);
  return block;
}

// Where no step of the heap fits into the limit, less may.
void* allocate_without_step(std::size_t size) {
  constexpr int kLeastStep = 1 << 17;
  mallopt(M_TOP_PAD, kLeastStep);
  return std::malloc(size);
}

void* allocate(std::size_t size) {
  if (size >= kLargeBlock) return allocate_large(size);
  const std::size_t some = size > 0 ? size : 1;
  void* block = std::malloc(some);
  if (!block) block = allocate_without_step(some);
  if (size >= kLeastFollowed) follow_heap(reinterpret_cast<std::uintptr_t>(block));
  return block;
}

// `alignment`: extended, as the columns of kernels have it.
void* allocate(std::size_t size, std::size_t alignment) {
  if (size >= kLargeBlock && alignment <= kHugePage) return allocate_large(size);
  const std::size_t whole = (size + alignment - 1) / alignment * alignment;
  if (whole < size) return nullptr;
  void* const block = std::aligned_alloc(alignment, whole > 0 ? whole : alignment);
  if (size >= kLeastFollowed) follow_heap(reinterpret_cast<std::uintptr_t>(block));
  return block;
}

}  // namespace

// The forms for arrays call these; free() is what the standard library's operator delete calls.
void* operator new(std::size_t size) {
  if (void* const block = allocate(size)) return block;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  if (void* const block = allocate(size, static_cast<std::size_t>(alignment))) return block;
  throw std::bad_alloc();
}

void operator delete(void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t /*size*/) noexcept { std::free(block); }
void operator delete(void* block, std::align_val_t /*alignment*/) noexcept { std::free(block); }
void operator delete(void* block, std::size_t /*size*/, std::align_val_t /*alignment*/) noexcept { std::free(block); }
