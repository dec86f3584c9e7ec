#include "core/merging/patch_planes.h"

#include <algorithm>

#include "core/cells/unit_normal.h"

namespace raycone {

// Faces of one source mostly follow each other, but bricks have thousands of sources.
PatchPlanes::SourcePlanes& PatchPlanes::planes_of(std::int32_t source) {
  if (sources_ > 0 && source_planes_[last_source_].source == source) return source_planes_[last_source_];
  if (2 * sources_ >= source_planes_.size()) grow();
  const std::size_t mask = source_planes_.size() - 1;
  std::size_t place = static_cast<std::uint32_t>(source) * std::size_t{0x9E3779B1} >> 7U & mask;
  while (source_planes_[place].source != source && source_planes_[place].source != kNoSource)
    place = (place + 1) & mask;
  last_source_ = place;
  SourcePlanes& planes = source_planes_[place];
  if (planes.source == kNoSource) {
    planes.source = source;
    ++sources_;
  }
  return planes;
}

void PatchPlanes::grow() {
  constexpr std::size_t kLeast = 256;
  std::vector<SourcePlanes> before(std::max(kLeast, 2 * source_planes_.size()));
  before.swap(source_planes_);
  sources_ = 0;
  for (const SourcePlanes& planes : before) {
    if (planes.source != kNoSource) planes_of(planes.source) = planes;
  }
}

std::uint32_t PatchPlanes::add(const PatchPlane& plane) {
  planes_.push_back(plane);
  return static_cast<std::uint32_t>(planes_.size() - 1);
}

std::uint32_t PatchPlanes::of_source(std::int32_t source, const Vec3& front) {
  auto& [known, own, turned] = planes_of(source);
  if (own == kNoPlane) {
    const Triangle& t = input_.triangles[static_cast<std::size_t>(source)];
    const Vec3& a = input_.vertices[t[0]];
    own = add({a, unit_normal(a, input_.vertices[t[1]], input_.vertices[t[2]]), true});
  }
  const auto [point, normal, is_of_source] = planes_[own];
  if (!(dot(normal, front) < 0.0)) return own;
  if (turned == kNoPlane) turned = add({point, -1.0 * normal, true});
  return turned;
}

}  // namespace raycone
