#include "core/orientation/closed_components.h"

#include <emmintrin.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <utility>

#include "core/exact/volume_sign.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// Of the prism between a face and the plane x = from.x: the sum over a closed surface does not depend on the plane.
VolumeSum volume_beside(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& from) {
  const double x1 = a.x - from.x, x2 = b.x - from.x, x3 = c.x - from.x;
  // y and z together: this is most of what it costs to tell what is reversed
  const __m128d first = _mm_loadu_pd(&a.y), second = _mm_sub_pd(_mm_loadu_pd(&b.y), first),
                third = _mm_sub_pd(_mm_loadu_pd(&c.y), first);
  const __m128d products = _mm_mul_pd(second, _mm_shuffle_pd(third, third, 1));
  const double forth = _mm_cvtsd_f64(products), back = _mm_cvtsd_f64(_mm_unpackhi_pd(products, products));
  return {(x1 + x2 + x3) * (forth - back),
          (std::abs(x1) + std::abs(x2) + std::abs(x3)) * (std::abs(forth) + std::abs(back) + kVolumeUnderflow), 1};
}

// Of a closed mesh of one component, in any order: only its sure sign is used.
VolumeSum volume_of(const TriangleMesh& mesh) {
  constexpr std::size_t kGrain = std::size_t{1} << 14;
  constexpr std::size_t kAhead = 16;  // triangles: their vertices may be anywhere in memory
  const Vec3 from = mesh.vertices[mesh.triangles.front()[0]];
  VolumeSum whole;
  std::mutex adding;
  parallel_for(mesh.triangles.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    VolumeSum part;
    for (std::size_t i = begin; i < end; ++i) {
      if (i + kAhead < end) {
        for (const std::uint32_t v : mesh.triangles[i + kAhead]) __builtin_prefetch(&mesh.vertices[v]);
      }
      const Triangle& t = mesh.triangles[i];
      part += volume_beside(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]], from);
    }
    const std::lock_guard lock(adding);
    whole += part;
  });
  return whole;
}

}  // namespace

int VolumeSum::sure_sign() const { return sure_volume_sign(sum, terms, faces); }

ClosedComponents::ClosedComponents(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges,
                                   const Components& components, const std::vector<std::uint32_t>& opposite)
    : mesh_(mesh), components_(components), is_open_(components.count, false), signs_(components.count, 0) {
  for (const ExteriorEdge& edge : edges) is_open_[components_.of_vertex[edge.from]] = true;
  if (std::ranges::count(is_open_, false) == 0) return;
  add_volumes();
  set_signs(opposite);
}

std::uint32_t ClosedComponents::count_negative() const {
  return static_cast<std::uint32_t>(std::ranges::count(signs_, -1));
}

bool ClosedComponents::whole_is_negative() const {
  if (std::ranges::count(signs_, -1) == 0) return false;
  if (std::ranges::count(signs_, 1) == 0) return true;
  VolumeSum whole;
  for (const VolumeSum& volume : volumes_) whole += volume;
  if (const int sign = whole.sure_sign(); sign != 0) return sign < 0;
  return volume_sign(mesh_.triangles, mesh_.vertices) < 0;
}

// Each from a vertex of its own: a component far from the origin keeps its digits.
void ClosedComponents::add_volumes() {
  volumes_.resize(components_.count);
  if (components_.count == 1) {
    volumes_[0] = volume_of(mesh_);
    return;
  }
  std::vector<Vec3> from(components_.count);
  for (const Triangle& t : mesh_.triangles) {
    const std::uint32_t component = component_of(t);
    if (is_open_[component]) continue;
    const Vec3& a = mesh_.vertices[t[0]];
    VolumeSum& volume = volumes_[component];
    if (volume.faces == 0) from[component] = a;
    volume += volume_beside(a, mesh_.vertices[t[1]], mesh_.vertices[t[2]], from[component]);
  }
}

void ClosedComponents::set_signs(const std::vector<std::uint32_t>& opposite) {
  std::vector<bool> in_doubt(components_.count, false);
  for (std::uint32_t c = 0; c < components_.count; ++c) {
    signs_[c] = volumes_[c].sure_sign();
    in_doubt[c] = !is_open_[c] && signs_[c] == 0;
  }
  if (std::ranges::count(in_doubt, true) > 0) set_signs_exactly(in_doubt, opposite);
}

// Faces that cancel are left out: nearly all doubt is about double-sided surfaces, where they are all.
void ClosedComponents::set_signs_exactly(const std::vector<bool>& in_doubt,
                                         const std::vector<std::uint32_t>& opposite) {
  std::vector<std::pair<std::uint32_t, Triangle>> faces;  // with their components
  auto left_out = opposite.begin();
  for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
    const std::uint32_t component = component_of(mesh_.triangles[i]);
    const bool cancels = left_out != opposite.end() && *left_out == i;
    if (cancels) ++left_out;
    if (!cancels && in_doubt[component]) faces.emplace_back(component, mesh_.triangles[i]);
  }
  std::ranges::sort(faces);
  for (auto it = faces.begin(); it != faces.end();) {
    const std::uint32_t component = it->first;
    std::vector<Triangle> triangles;
    for (; it != faces.end() && it->first == component; ++it) triangles.push_back(it->second);
    signs_[component] = volume_sign(triangles, mesh_.vertices);
  }
}

}  // namespace raycone
