#include "core/orientation/nesting.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <numeric>
#include <optional>
#include <utility>

#include "core/crossings/crossings.h"
#include "core/crossings/projected_grid.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

bool holds_box(const Box& outer, const Box& inner) {
  for (int axis = 0; axis < 3; ++axis) {
    if (inner.lower[axis] < outer.lower[axis] || inner.upper[axis] > outer.upper[axis]) return false;
  }
  return true;
}

Box box_of(const ClosedSurface& surface, const std::vector<Vec3>& vertices) {
  Box box{vertices[surface.faces.front()[0]], vertices[surface.faces.front()[0]]};
  for (const Triangle& t : surface.faces) {
    for (const std::uint32_t v : t) {
      for (int axis = 0; axis < 3; ++axis) {
        box.lower[axis] = std::min(box.lower[axis], vertices[v][axis]);
        box.upper[axis] = std::max(box.upper[axis], vertices[v][axis]);
      }
    }
  }
  return box;
}

// For each box those that hold it: a sweep along x.
std::vector<std::vector<std::uint32_t>> boxes_around(const std::vector<Box>& boxes) {
  std::vector<std::uint32_t> order(boxes.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return boxes[a].lower.x < boxes[b].lower.x; });
  std::vector<std::vector<std::uint32_t>> around(boxes.size());
  std::vector<std::uint32_t> met;
  for (const std::uint32_t i : order) {
    std::erase_if(met, [&](std::uint32_t j) { return boxes[j].upper.x < boxes[i].lower.x; });
    for (const std::uint32_t j : met) {
      if (holds_box(boxes[j], boxes[i])) around[i].push_back(j);
      if (holds_box(boxes[i], boxes[j])) around[j].push_back(i);
    }
    met.push_back(i);
  }
  return around;
}

// Rays through the surfaces that may be around others.
class SurfaceRays {
 public:
  SurfaceRays(const std::vector<ClosedSurface>& surfaces, const std::vector<std::vector<std::uint32_t>>& around,
              const std::vector<Vec3>& vertices) {
    std::vector<bool> wanted(surfaces.size(), false);
    for (const auto& outer : around) {
      for (const std::uint32_t j : outer) wanted[j] = true;
    }
    mesh_.vertices = vertices;
    for (std::uint32_t j = 0; j < surfaces.size(); ++j) {
      if (!wanted[j]) continue;
      mesh_.triangles.insert(mesh_.triangles.end(), surfaces[j].faces.begin(), surfaces[j].faces.end());
      surface_.insert(surface_.end(), surfaces[j].faces.size(), j);
    }
    if (!mesh_.triangles.empty()) grid_.emplace(mesh_);
  }

  // Where a point lies.
  struct Place {
    std::int64_t winding = 0;
    bool on_surface = false;
  };
  // places[i] of `surfaces[i]`, all of which are wanted.
  void find(const Vec3& q, std::span<const std::uint32_t> surfaces, std::span<Place> places) const {
    const Row row{q.y, q.z, {&q.x, 1}, 0.0};
    grid_->for_each_candidate(q, [&](std::uint32_t triangle) {
      const auto it = std::find(surfaces.begin(), surfaces.end(), surface_[triangle]);
      if (it == surfaces.end()) return;
      const Triangle& t = mesh_.triangles[triangle];
      const TriangleCrossing crossing =
          triangle_crossing(mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]], row, nullptr);
      Place& place = places[static_cast<std::size_t>(it - surfaces.begin())];
      if (crossing.crossed > 0) place.winding += crossing.sigma;
      if (crossing.on_begin < crossing.on_end) place.on_surface = true;
    });
  }

 private:
  TriangleMesh mesh_;
  std::vector<std::uint32_t> surface_;  // per triangle
  std::optional<ProjectedGrid> grid_;
};

std::vector<std::uint32_t> vertices_of(const ClosedSurface& surface) {
  std::vector<std::uint32_t> all;
  all.reserve(3 * surface.faces.size());
  for (const Triangle& t : surface.faces) all.insert(all.end(), t.begin(), t.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

// Those of `outer` within which all vertices of the surface lie that are not on them. In blocks, so that one that does
// not hold the first vertices costs no more.
std::vector<std::uint32_t> holders(const ClosedSurface& surface, std::vector<std::uint32_t> outer,
                                   const std::vector<Vec3>& vertices, const SurfaceRays& rays) {
  const std::vector<std::uint32_t> used = vertices_of(surface);
  std::vector<std::uint32_t> holding;  // by at least one vertex
  constexpr std::size_t kSmallBlock = 16, kGrain = 256;
  for (std::size_t done = 0, block = kSmallBlock; done < used.size() && !outer.empty(); done += block, block *= 4) {
    const std::size_t count = std::min(block, used.size() - done);
    std::vector<std::atomic<bool>> misses(outer.size()), hits(outer.size());
    parallel_for(count, kGrain, [&](std::size_t begin, std::size_t end) {
      std::vector<SurfaceRays::Place> places;
      for (std::size_t i = begin; i < end; ++i) {
        places.assign(outer.size(), {});
        rays.find(vertices[used[done + i]], outer, places);
        for (std::size_t j = 0; j < outer.size(); ++j) {
          if (places[j].on_surface) continue;
          (places[j].winding == 0 ? misses : hits)[j].store(true, std::memory_order_relaxed);
        }
      }
    });
    std::vector<std::uint32_t> left;
    for (std::size_t j = 0; j < outer.size(); ++j) {
      if (misses[j]) continue;
      left.push_back(outer[j]);
      if (hits[j]) holding.push_back(outer[j]);
    }
    outer = std::move(left);
  }
  std::erase_if(outer, [&](std::uint32_t j) { return std::ranges::count(holding, j) == 0; });
  return outer;
}

}  // namespace

std::vector<std::vector<std::uint32_t>> surfaces_around(const std::vector<ClosedSurface>& surfaces,
                                                        const std::vector<Vec3>& vertices) {
  std::vector<Box> boxes;
  for (const ClosedSurface& surface : surfaces) boxes.push_back(box_of(surface, vertices));
  std::vector<std::vector<std::uint32_t>> around = boxes_around(boxes);
  const SurfaceRays rays(surfaces, around, vertices);
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (around[i].empty()) continue;
    around[i] = holders(surfaces[i], std::move(around[i]), vertices, rays);
    std::sort(around[i].begin(), around[i].end());
  }
  return around;
}

}  // namespace raycone
