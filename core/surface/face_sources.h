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
  // All must outlive this. `distance`: from `input`. `off`: how far corners of a face may be from the plane of its
  // source, world units.
  SourceSettler(const TriangleMesh& input, const TriangleNormals& normals, const DistanceEvaluator& distance,
                double off);

  // Gives a face another source where its own cannot be its source: where the face is turned by more than 15 degrees
  // against the triangle's plane, or has a corner farther than `off` from it. The face gets the triangle that is
  // nearest to its middle, of several the first. Where that one cannot be its source either, and a face without a
  // source is beside it and in line with it, it gets none. At first a face has the source of one of its corners; where
  // a lattice edge meets the mesh on an edge, that may be the triangle on the other side. Faces without a source keep
  // none. The same for any number of threads. Precondition: sources are triangles of `input`, or kHole.
  void settle(SurfaceMesh& surface) const;

  // Takes the source from faces with a corner farther from the mesh than `most`, world units: since vertices have gone,
  // they reach into what closes a hole. The same for any number of threads.
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
