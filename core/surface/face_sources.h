// Which triangle of the mesh each face of a surface is of.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/cells/surface_mesh.h"
#include "core/cells/triangle_normals.h"
#include "core/data/lattice.h"
#include "core/data/triangle_mesh.h"
#include "core/distance/distance.h"

namespace raycone {

// How far a face may be from its source: a quarter of a voxel, and what the set has grown by.
[[nodiscard]] inline double farthest_source(const Lattice& lattice, double thickness) {
  return thickness + lattice.least_spacing() / 4;
}

class SourceSettler {
 public:
  // All must stay. `distance`: from `input`. `off`: how far from the plane of its source a face may be, world units.
  SourceSettler(const TriangleMesh& input, const TriangleNormals& normals, const DistanceEvaluator& distance,
                double off);

  // Gives faces another source whose own cannot be theirs: that are more than 15 degrees or `off` from its plane. They
  // get the triangle that is nearest to their middle, of several the first; or none, if that one cannot be theirs
  // either and a face without a source is beside them, in line with them. A face has the source of one of its corners
  // at first; where a lattice edge meets the mesh on an edge, that may be the triangle on the other side. Faces without
  // a source keep none. The same for any number of threads. Precondition: sources are triangles of `input`, or kHole.
  void settle(SurfaceMesh& surface) const;

  // Takes theirs from faces with a corner that is farther from the mesh than `most`, world units: since vertices have
  // gone, they reach into what closes a hole. The same for any number of threads.
  void forget_far_sources(SurfaceMesh& surface, double most) const;

 private:
  [[nodiscard]] bool may_be_of(const SurfaceMesh& surface, std::size_t number, std::uint32_t source) const;
  [[nodiscard]] std::vector<std::uint32_t> doubtful_faces(const SurfaceMesh& surface) const;

  const TriangleMesh& input_;
  const TriangleNormals& normals_;
  const DistanceEvaluator& distance_;
  double off_;
};

}  // namespace raycone
