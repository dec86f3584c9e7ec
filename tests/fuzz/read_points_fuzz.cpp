// libFuzzer target of the point readers (text, NPY, PLY; with RAYCONE_RAW coordinates alone, in the precision that the
// first byte says): whatever the bytes, they return finite points, as many as announced, or throw InputError or
// LimitError.
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "io/files/file_error.h"
#include "io/points/read_points.h"

namespace raycone {
namespace {

// A file in memory, under a name that can be opened.
class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* data, std::size_t size) : descriptor_(memfd_create("points", 0)) {
    if (descriptor_ < 0 || write(descriptor_, data, size) != static_cast<ssize_t>(size)) std::abort();
  }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

void read_all(const std::string& path, const ReadPointsOptions& options) {
  constexpr std::size_t kBatch = 7;
  const std::unique_ptr<PointReader> reader = open_points(path, options);
  std::vector<Vec3> batch;
  std::uint64_t count = 0;
  while (reader->next(batch, kBatch)) {
    if (batch.empty() || batch.size() > kBatch) std::abort();
    for (const Vec3& p : batch) {
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) std::abort();
    }
    count += batch.size();
  }
  if (reader->size() && *reader->size() != count) std::abort();
}

}  // namespace
}  // namespace raycone

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  raycone::ReadPointsOptions options;
#ifdef RAYCONE_RAW
  if (size == 0) return 0;
  options.raw = data[0] % 2 == 0 ? raycone::RawPrecision::kSingle : raycone::RawPrecision::kDouble;
  ++data, --size;
#endif
  const raycone::MemoryFile file(data, size);
  try {
    raycone::read_all(file.path(), options);
  } catch (const raycone::InputError&) {
  } catch (const raycone::LimitError&) {
  }
  return 0;
}
