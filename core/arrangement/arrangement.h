// The faces of a mesh, cut where they meet.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/exact/exact_points.h"

namespace raycone {

// Triangles that make the same winding numbers as a mesh, and meet each other in nothing but common corners and edges
// (Zhou, Grinspun, Zorin and Jacobson, "Mesh arrangements for solid geometry", ACM TOG 35(4), 2016). Their corners are
// vertices of the mesh and points in which its faces meet. Faces that meet beyond what they share are triangulated
// anew; faces without area, and parts of faces that cancel, are left out. Coordinates are exact: nothing here is
// rounded.
class Arrangement {
 public:
  // None where more than `most_pairs` pairs of faces meet beyond what they share, or where cutting them takes too long,
  // as it may where very many faces meet one. Uses the threads that ThreadLimit allows; the same for any number of
  // them. Preconditions: `mesh` is welded, its used vertices are below 2^1020 in magnitude, and it outlives the result.
  // Needs DefaultFloatingPoint.
  [[nodiscard]] static std::optional<Arrangement> of(const TriangleMesh& mesh, std::size_t most_pairs);

  // Corners by number: first the vertices of the mesh, then the points made.
  [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }
  // A face of the mesh that the triangle is part of.
  [[nodiscard]] std::uint32_t source(std::size_t triangle) const { return sources_[triangle]; }
  // How many faces the triangle is part of, those that face the other way subtracted. Positive.
  [[nodiscard]] std::int32_t multiplicity(std::size_t triangle) const { return multiplicities_[triangle]; }

  [[nodiscard]] std::size_t corners() const { return mesh_->vertices.size() + made_.size(); }
  [[nodiscard]] Vec3 rounded(std::uint32_t corner) const;  // to the nearest doubles
  // A corner as one of points(). Adds it there if need be, so not thread-safe.
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
