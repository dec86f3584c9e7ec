// Which points of a mesh's triangles a surface passes by at a distance.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/cells/node_set.h"
#include "core/cells/surface_mesh.h"
#include "core/data/coordinate_precision.h"
#include "core/data/triangle_mesh.h"
#include "core/data/vec3.h"
#include "core/distance/distance.h"

namespace raycone {

// The centres of parts of triangles, all about as large, and the area that each stands for.
struct AreaSamples {
  std::vector<Vec3> points;
  std::vector<double> areas;  // in squares of a step
  std::vector<std::uint32_t> triangles;
};

// Adds the samples of a triangle, no farther apart than `step` (world units); some 32 000 at most.
void add_samples(AreaSamples& samples, const TriangleMesh& mesh, std::uint32_t triangle, double step);

// Whether the faces of a surface are the mesh's own, or a contour's.
enum class SurfaceFaces : std::uint8_t { kOfMesh, kOfContour };

// The distance from a surface beyond which a point of its mesh counts as dropped, world units. Where the surface has
// the mesh's own faces, it is more than they move where they are cut or merged; of a contour, as a rule, more than what
// it cuts off at edges. For a surface without thickness, not simplified. `precision`: of the surface's vertices.
[[nodiscard]] double farthest_kept(const TriangleMesh& mesh, const Lattice& lattice, SurfaceFaces faces,
                                   CoordinatePrecision precision);

// Finds the points that are dropped: those farther from the surface than `farthest`. Where the set has no thickness,
// also those off the surface that are of components of the mesh of which the surface has no face. Not thread-safe.
class DroppedSamples {
 public:
  // For the surface between `inside` and the other nodes, after the set was thickened by `thickness` (world units).
  // `surface` and `inside` must outlive this. `farthest`: farthest_kept(), plus the thickness, plus what the surface
  // may have moved by. `held`: of each triangle of the mesh, whether it is known that no point of it is dropped; empty:
  // not known of any.
  DroppedSamples(const SurfaceMesh& surface, const NodeSet& inside, double thickness, double farthest,
                 std::vector<bool> held);

  [[nodiscard]] const NodeSet& inside() const { return inside_; }
  [[nodiscard]] double thickness() const { return thickness_; }  // world units
  [[nodiscard]] double step() const { return step_; }            // between points: half a cell's diagonal, world units

  // Whether it is known that no point at all is dropped.
  [[nodiscard]] bool holds_all() const;

  using Visit = std::function<void(const AreaSamples& samples, const std::vector<bool>& dropped)>;
  // Calls visit(samples, is_dropped) for the samples of some triangles of the mesh at a time, in their order. One
  // sample stands for a triangle that is held. Builds a search structure for the surface when it is first needed;
  // faster the second time. The same for any number of threads. Precondition: it is the same mesh each time.
  void for_each(const TriangleMesh& mesh, const Visit& visit);

 private:
  struct Part;
  struct Group;
  [[nodiscard]] Part part_from(const TriangleMesh& mesh, std::size_t begin) const;
  void find_lost_components(const TriangleMesh& mesh);
  [[nodiscard]] bool is_held(std::size_t triangle) const { return !held_.empty() && held_[triangle]; }
  [[nodiscard]] bool is_of_lost(std::uint32_t triangle) const { return !is_of_lost_.empty() && is_of_lost_[triangle]; }
  void take_samples(const TriangleMesh& mesh, Part& part) const;
  [[nodiscard]] std::vector<Group> groups_of(std::span<Part> parts) const;
  [[nodiscard]] std::vector<double> distances_of(std::span<const Vec3> points, double limit);
  void decide(std::span<Part> parts);
  void remember(std::span<const Part> parts);

  const SurfaceMesh& surface_;
  const NodeSet& inside_;
  std::vector<bool> held_;
  double thickness_, step_, farthest_, on_surface_;
  std::vector<bool> is_of_lost_;               // of each triangle, whether no face is of its component
  std::optional<DistanceEvaluator> distance_;  // of the surface: many need it for no sample
  std::vector<bool> dropped_;                  // of each sample, in order, since it was decided
  bool is_decided_ = false;                    // of all samples
};

}  // namespace raycone
