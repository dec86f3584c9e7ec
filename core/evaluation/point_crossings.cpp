#include "core/evaluation/point_crossings.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "core/machine/threads.h"

namespace raycone {
namespace {

void decide(const ScaledMesh& mesh, std::uint32_t triangle, const NumberedRay& ray, PointCrossings& crossings) {
  const QueryCrossing crossing = mesh.crossing(triangle, ray.origin);
  const auto add = [](auto& sum, auto term) {
    if (term != 0) std::atomic_ref(sum).fetch_add(term, std::memory_order_relaxed);
  };
  add(crossings.n[ray.number], crossing.sigma);
  add(crossings.ties[ray.number], static_cast<std::uint64_t>(crossing.ties));
  if (crossing.on_surface) std::atomic_ref(crossings.on_surface[ray.number]).store(1, std::memory_order_relaxed);
}

// Of the triangles [begin, end), up to the first one at which more effort than `most` has been taken; how much has.
PassEffort pass_over(const ScaledMesh& mesh, std::size_t begin, std::size_t end, const BinnedRays& rays,
                     std::uint64_t most, PointCrossings& crossings) {
  PassEffort effort;
  const TriangleMesh& all = mesh.mesh();
  for (std::size_t t = begin; t < end && effort.sum() <= most; ++t) {
    const auto [a, b, c] = corners_of(all, all.triangles[t]);
    effort.looks += rays.for_each_met(box_of(a, b, c), [&](const NumberedRay& ray) {
      decide(mesh, static_cast<std::uint32_t>(t), ray, crossings);
      ++effort.decisions;
    });
    ++effort.triangles;
  }
  return effort;
}

// How much effort a pass may take until it is given up. At each time that is what is due for the triangles so far, and
// an eighth of the whole: what would take far too long is given up soon. Thread-safe.
class Patience {
 public:
  Patience(std::uint64_t most, std::size_t triangles)
      : most_(static_cast<double>(most)), triangles_(static_cast<double>(triangles)) {}

  // What may be taken for so many triangles more; 0: the pass has been given up.
  [[nodiscard]] std::uint64_t for_more(std::size_t triangles) {
    constexpr double kAtOnce = 0.125;
    const auto begun = static_cast<double>(begun_.fetch_add(triangles, std::memory_order_relaxed) + triangles);
    const double due = most_ * std::min(kAtOnce + begun / triangles_, 1.0);
    const double left = due - static_cast<double>(effort_.load(std::memory_order_relaxed));
    if (!(left >= 1.0)) lost_.store(true, std::memory_order_relaxed);
    return is_lost() ? 0 : static_cast<std::uint64_t>(std::min(left, 0x1p63));
  }

  // Effort that was taken, of what was allowed.
  void count(std::uint64_t effort, std::uint64_t allowed) {
    effort_.fetch_add(effort, std::memory_order_relaxed);
    if (effort > allowed) lost_.store(true, std::memory_order_relaxed);
  }

  [[nodiscard]] bool is_lost() const { return lost_.load(std::memory_order_relaxed); }

 private:
  double most_, triangles_;
  std::atomic<std::size_t> begun_ = 0;
  std::atomic<std::uint64_t> effort_ = 0;
  std::atomic<bool> lost_ = false;
};

// Nothing where the pass was given up.
std::optional<PointCrossings> try_to_pass(const ScaledMesh& mesh, const BinnedRays& rays, std::size_t count) {
  constexpr std::size_t kTrianglesPerTask = 1024;
  const std::size_t triangles = mesh.mesh().triangles.size();
  PointCrossings crossings(count);
  Patience patience(mesh.grid_choice().effort_left(), triangles);
  parallel_for(triangles, kTrianglesPerTask, [&](std::size_t begin, std::size_t end) {
    const std::uint64_t allowed = patience.for_more(end - begin);
    if (allowed == 0) return;
    const PassEffort effort = pass_over(mesh, begin, end, rays, allowed, crossings);
    patience.count(effort.sum(), allowed);
    mesh.grid_choice().count_effort(effort);
  });
  return patience.is_lost() ? std::nullopt : std::optional(std::move(crossings));
}

}  // namespace

bool takes_passes(const ScaledMesh& mesh) {
  return mesh.options().ray_engine != RayEngine::kEmbree && !mesh.grid_if_built();
}

std::optional<PointCrossings> crossings_by_pass(const ScaledMesh& mesh, std::vector<NumberedRay> rays,
                                                std::size_t count) {
  std::erase_if(rays, [&](const NumberedRay& ray) { return !ray.meets(mesh.box()); });
  if (rays.empty()) return PointCrossings(count);
  mesh.grid_choice().count_rays(rays.size());
  const BinnedRays binned(std::move(rays));
  std::optional<PointCrossings> crossings = try_to_pass(mesh, binned, count);
  if (!crossings && !mesh.build_grid()) crossings = try_to_pass(mesh, binned, count);
  return crossings;
}

}  // namespace raycone
