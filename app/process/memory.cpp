// Memory without its hidden costs: touching a new page takes a microsecond or two, and with pages of 4 kB that was half
// of the time that reading, welding and edge tables took. Large blocks therefore come in huge pages, which many systems
// give only to who asks for them (Linux, admin-guide/mm/transhuge, "madvise"), and smaller ones are kept when they are
// freed, for the next step to use.
#include <malloc.h>
#include <sys/mman.h>

#include <cstdlib>
#include <new>

namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20;
// Smaller blocks would waste too much of their last page.
constexpr std::size_t kLargeBlock = 4 * kHugePage;

constexpr int kKept = 1 << 26;
[[maybe_unused]] const int done_at_start =
    mallopt(M_MMAP_THRESHOLD, static_cast<int>(kLargeBlock)) + mallopt(M_TRIM_THRESHOLD, kKept);

// Nothing where there is no memory left.
void* allocate_large(std::size_t size) {
  const std::size_t whole_pages = (size + kHugePage - 1) / kHugePage * kHugePage;
  if (whole_pages < size) return nullptr;
  void* const block = std::aligned_alloc(kHugePage, whole_pages);
  if (block) madvise(block, size / kHugePage * kHugePage, MADV_HUGEPAGE);  // a failure costs time only
  return block;
}

void* allocate(std::size_t size) {
  return size < kLargeBlock ? std::malloc(size > 0 ? size : 1) : allocate_large(size);
}

// `alignment`: extended, as the columns of kernels have it.
void* allocate(std::size_t size, std::size_t alignment) {
  if (size >= kLargeBlock && alignment <= kHugePage) return allocate_large(size);
  const std::size_t whole = (size + alignment - 1) / alignment * alignment;
  return whole < size ? nullptr : std::aligned_alloc(alignment, whole > 0 ? whole : alignment);
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
