#include "app/picture/clip.h"

#include <algorithm>
#include <cmath>

namespace raycone {
namespace {

PicturePoint between(const PictureSegment& segment, double t) {
  return {segment.a.x + t * (segment.b.x - segment.a.x), segment.a.y + t * (segment.b.y - segment.a.y)};
}

// Narrows [t0, t1] to where least <= start + t * step <= most.
void narrow(double start, double step, double least, double most, double& t0, double& t1) {
  if (step == 0.0) {
    if (start < least || start > most) t1 = t0 - 1.0;
    return;
  }
  const double a = (least - start) / step;
  const double b = (most - start) / step;
  t0 = std::max(t0, std::min(a, b));
  t1 = std::min(t1, std::max(a, b));
}

}  // namespace

std::optional<PictureSegment> clip(const PictureSegment& segment, std::int64_t width, std::int64_t height,
                                   double margin) {
  const double dx = segment.b.x - segment.a.x;
  const double dy = segment.b.y - segment.a.y;
  if (!std::isfinite(dx) || !std::isfinite(dy)) return std::nullopt;
  double t0 = 0.0;
  double t1 = 1.0;
  narrow(segment.a.x, dx, -margin, static_cast<double>(width) + margin, t0, t1);
  narrow(segment.a.y, dy, -margin, static_cast<double>(height) + margin, t0, t1);
  if (!(t0 <= t1)) return std::nullopt;
  return PictureSegment{between(segment, t0), between(segment, t1)};
}

IndexRange pixels_within(double from, double to, std::int64_t count) {
  const auto most = static_cast<double>(count);
  return {static_cast<std::int64_t>(std::clamp(std::floor(from), 0.0, most)),
          static_cast<std::int64_t>(std::clamp(std::floor(to) + 1.0, 0.0, most))};
}

std::pair<double, double> x_extent(const PictureSegment& segment, double top, double bottom) {
  double t0 = 0.0;
  double t1 = 1.0;
  narrow(segment.a.y, segment.b.y - segment.a.y, top, bottom, t0, t1);
  return std::minmax(between(segment, t0).x, between(segment, std::max(t0, t1)).x);
}

}  // namespace raycone
