// Reading of query points: text (CSV, TSV, blanks), NPY, NPZ, PLY vertices, raw coordinates.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/data/vec3.h"
#include "core/data/warning.h"
#include "io/files/raw_precision.h"

namespace raycone {

struct ReadPointsOptions {
  std::optional<std::array<int, 3>> columns;  // one-based columns of x, y, z in text
  std::optional<RawPrecision> raw;            // no format: coordinates, one after the other
};

// Where points lie on a surface. Both empty, or one each per point.
struct SurfacePlaces {
  std::span<const Vec3> normals{};        // unit vectors; 0 where the point is not on the surface
  std::span<const std::int64_t> faces{};  // numbers of triangles; -1 there
};

// A stream of points: memory does not grow with their number for text.
class PointReader {
 public:
  virtual ~PointReader() = default;

  // Replaces `batch` by the next points, at most `max`, and returns false at the end. Blocks only while it has none:
  // on a pipe it returns what has arrived. Throws InputError naming the line (or byte) of anything that is not a finite
  // point.
  virtual bool next(std::vector<Vec3>& batch, std::size_t max) = 0;

  // Of the batch that next() gave last, where its points are drawn from a surface; valid until the next one.
  [[nodiscard]] virtual SurfacePlaces places() { return {}; }

  // Whether a further next() would have to wait for input now: the moment to flush what has been answered. Reads ahead
  // to find out, as part of a point is no question. Throws InputError.
  [[nodiscard]] virtual bool would_block() = 0;

  // Whether there are columns to choose from, as in text.
  [[nodiscard]] virtual bool has_columns() const { return false; }

  // What may not be meant, known from the first point on: `columns`, where a header leaves open which they are.
  [[nodiscard]] virtual std::vector<Warning> warnings() const { return {}; }

  // Number of points in total, where it is known before they are read: of NPY, NPZ, PLY, and raw numbers in a file.
  [[nodiscard]] virtual std::optional<std::uint64_t> size() const = 0;

  // Whether so many are there. Of NPY that comes packed or through a pipe, size() is only what its head says.
  [[nodiscard]] virtual bool has_certain_size() const { return size().has_value(); }
};

// Opens `path`, or standard input (text) for "-", either packed by gzip or Zstandard, too. Throws InputError.
[[nodiscard]] std::unique_ptr<PointReader> open_points(const std::string& path, const ReadPointsOptions& options = {});

}  // namespace raycone
