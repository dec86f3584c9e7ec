// The closed components of a mesh, and which way their fronts face.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/mesh/components.h"
#include "core/mesh/exterior_edges.h"

namespace raycone {

// Six times a signed volume, cubed world units: positive where fronts face outward.
struct VolumeSum {
  double sum = 0.0;
  double terms = 0.0;  // sum of the absolute values of all products
  std::uint64_t faces = 0;

  VolumeSum& operator+=(const VolumeSum& other) {
    sum += other.sum;
    terms += other.terms;
    faces += other.faces;
    return *this;
  }
  // -1, 1, or 0 where rounding may have changed it (sure_volume_sign()).
  [[nodiscard]] int sure_sign() const;
};

// The sign of the volume of each closed component, exact. Where floating point cannot vouch for one, this takes some
// microseconds for each face that has no opposite. Needs DefaultFloatingPoint. Uses the threads that ThreadLimit
// allows.
class ClosedComponents {
 public:
  // `edges`: the exterior_edges() of `mesh`; `opposite`: its opposite_faces(). `mesh` and `components` stay as they are
  // while this lives.
  ClosedComponents(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges, const Components& components,
                   const std::vector<std::uint32_t>& opposite);

  [[nodiscard]] std::uint32_t count_negative() const;
  [[nodiscard]] bool is_closed(std::uint32_t component) const { return !is_open_[component]; }
  [[nodiscard]] bool is_negative(std::uint32_t component) const { return signs_[component] < 0; }

  // Whether the mesh as a whole has a negative volume. Precondition: no component is open.
  [[nodiscard]] bool whole_is_negative() const;

 private:
  [[nodiscard]] std::uint32_t component_of(const Triangle& t) const { return components_.of_vertex[t[0]]; }
  void add_volumes();
  void set_signs(const std::vector<std::uint32_t>& opposite);
  void set_signs_exactly(const std::vector<bool>& in_doubt, const std::vector<std::uint32_t>& opposite);

  const TriangleMesh& mesh_;
  const Components& components_;
  std::vector<bool> is_open_;
  std::vector<VolumeSum> volumes_;  // of the closed ones
  std::vector<int> signs_;          // likewise; 0 for others
};

}  // namespace raycone
