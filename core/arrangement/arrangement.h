// The faces of a mesh, cut where they meet.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/exact/exact_points.h"

namespace raycone {

// Triangles between vertices of a mesh and points in which its faces meet, which meet each other in nothing but common
// corners and edges, and make the same winding numbers as the mesh (Zhou, Grinspun, Zorin and Jacobson, "Mesh
// arrangements for solid geometry", ACM TOG 35(4), 2016). Faces of the mesh that meet beyond what they share are
// triangulated anew; faces without area, and parts of faces that cancel, are left out. Coordinates are exact: nothing
// here is rounded.
class Arrangement {
 public:
  // None where more than `most_pairs` pairs of faces meet beyond what they share, or cutting them takes too long, as it
  // may where very many meet one. The same for any number of threads, of which pairs are looked for by those that
  // ThreadLimit allows. Preconditions: `mesh` is welded, and its used vertices are below 2^1020; it stays. Needs
  // DefaultFloatingPoint.
  [[nodiscard]] static std::optional<Arrangement> of(const TriangleMesh& mesh, std::size_t most_pairs);

  // Corners below the number of the mesh's vertices are these.
  [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }
  // A face of the mesh that the triangle is part of.
  [[nodiscard]] std::uint32_t source(std::size_t triangle) const { return sources_[triangle]; }
  // How many faces the triangle is part of, those that face the other way subtracted. Positive.
  [[nodiscard]] std::int32_t multiplicity(std::size_t triangle) const { return multiplicities_[triangle]; }

  [[nodiscard]] std::size_t corners() const { return mesh_->vertices.size() + made_.size(); }
  [[nodiscard]] Vec3 rounded(std::uint32_t corner) const;  // to the nearest doubles
  // A corner as a point with exact coordinates, and all such points.
  [[nodiscard]] ExactPoints::Number point(std::uint32_t corner);
  [[nodiscard]] ExactPoints& points() { return points_; }

 private:
  class Builder;
  explicit Arrangement(const TriangleMesh& mesh) : mesh_(&mesh), points_(mesh) {}

  const TriangleMesh* mesh_;
  ExactPoints points_;
  std::vector<ExactPoints::Number> made_;  // points that are no vertices
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> sources_;
  std::vector<std::int32_t> multiplicities_;
};

}  // namespace raycone
