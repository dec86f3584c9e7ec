// Large blocks of memory in huge pages: touching a new page costs a microsecond or two, and with pages of 4 kB that was
// half of the time that reading, welding and edge tables took. Many systems give huge pages only to who asks for them
// (Linux, admin-guide/mm/transhuge, "madvise").
#include <sys/mman.h>

#include <cstdlib>
#include <new>

namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20;
// Smaller blocks would waste too much of their last page.
constexpr std::size_t kLargeBlock = 4 * kHugePage;

// Nothing where there is no memory left.
void* allocate(std::size_t size) {
  if (size < kLargeBlock) return std::malloc(size > 0 ? size : 1);
  const std::size_t whole_pages = (size + kHugePage - 1) / kHugePage * kHugePage;
  if (whole_pages < size) return nullptr;
  void* const block = std::aligned_alloc(kHugePage, whole_pages);
  if (block) madvise(block, size / kHugePage * kHugePage, MADV_HUGEPAGE);  // a failure costs time only
  return block;
}

}  // namespace

// The forms for arrays and for alignments that are not extended call this one; free() is what the standard library's
// operator delete calls.
void* operator new(std::size_t size) {
  if (void* const block = allocate(size)) return block;
  throw std::bad_alloc();
}

void operator delete(void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t /*size*/) noexcept { std::free(block); }
