// Query points: which format a file has, and the vertices of PLY files. Text and NPY have files of their own.
#include "io/points/read_points.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "io/files/ascii.h"
#include "io/files/file_error.h"
#include "io/files/npy_head.h"
#include "io/files/text_scanner.h"
#include "io/files/unpack.h"
#include "io/files/zip_reader.h"
#include "io/mesh/ply.h"
#include "io/points/point_readers.h"

namespace raycone {
namespace {

// Points that are in memory.
class StoredPoints : public PointReader {
 public:
  explicit StoredPoints(std::vector<Vec3> points) : points_(std::move(points)) {}

  bool next(std::vector<Vec3>& batch, std::size_t max) override {
    const std::size_t count = std::min(max, points_.size() - next_);
    const auto first = points_.begin() + static_cast<std::ptrdiff_t>(next_);
    batch.assign(first, first + static_cast<std::ptrdiff_t>(count));
    next_ += count;
    return count > 0;
  }
  [[nodiscard]] bool would_block() override { return false; }
  [[nodiscard]] std::optional<std::uint64_t> size() const override { return points_.size(); }

 private:
  std::vector<Vec3> points_;
  std::size_t next_ = 0;
};

// Reads until the input is seen to begin with `signature` or not to.
bool begins_with(InputBuffer& input, std::string_view signature) {
  while (input.pending().size() < signature.size() && signature.starts_with(input.pending())) {
    if (!input.fill()) return false;
  }
  return input.pending().starts_with(signature);
}

// As read_mesh() knows it.
bool begins_with_ply(InputBuffer& input) {
  for (const std::string_view mark : {std::string_view(), kByteOrderMark}) {
    for (const char blank : {'\n', '\r', ' ', '\t'}) {
      if (begins_with(input, std::string(mark) + "ply" + blank)) return true;
    }
  }
  return false;
}

// A file of no bytes is text of no points, but no binary file: whoever was to write that one has failed.
void refuse_empty(const std::string& path, const InputBuffer& input) {
  if (!input.pending().empty()) return;
  for (const std::string extension : {".npy", ".npz", ".ply"}) {
    for (const std::string compressed : {"", ".gz", ".zst"}) {
      if (ends_with_word(path, extension + compressed)) throw InputError(path + ": is empty, expected points");
    }
  }
}

}  // namespace

std::unique_ptr<PointReader> read_ply_points(std::unique_ptr<InputBuffer> input) {
  while (input->fill()) continue;
  return std::make_unique<StoredPoints>(read_ply_vertices({input->name(), {}, input->pending()}));
}

std::unique_ptr<PointReader> read_npz_points(const std::string& path) {
  const ZipReader archive(path);
  const ZipReader::Member* const points = archive.find("points.npy");
  if (points == nullptr) throw InputError(path + ": has no array 'points', expected one of shape (n, 3)");
  return read_npy_points(std::make_unique<InputBuffer>(archive.name_of(*points), archive.open_checked(*points)));
}

std::unique_ptr<PointReader> open_points(const std::string& path, const ReadPointsOptions& options) {
  if (options.raw) return read_raw_points(std::make_unique<InputBuffer>(path), *options.raw);
  auto input = std::make_unique<InputBuffer>(path, unpacked(open_source(path), path));
  // Nothing may wait on standard input before the first point is asked for.
  if (path != "-") {
    if (begins_with(*input, kNpyMagic)) return read_npy_points(std::move(input));
    if (begins_with(*input, "PK\x03\x04")) {
      if (!input->is_seekable()) {
        throw InputError(path + ": is NPZ on a pipe or compressed, expected a file that is neither");
      }
      return read_npz_points(path);
    }
    if (begins_with_ply(*input)) return read_ply_points(std::move(input));
    refuse_empty(path, *input);
  }
  return read_text_points(std::move(input), options);
}

}  // namespace raycone
