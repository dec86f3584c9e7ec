// Collects the vertices and polygons of an indexed mesh as a reader meets them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/data/warning.h"
#include "io/mesh/mesh_error.h"
#include "io/mesh/read_mesh.h"

namespace raycone {

// `count` is not 0.
[[nodiscard]] inline Warning skipped_faces_warning(std::uint64_t count) {
  const std::string faces = std::to_string(count) + (count == 1 ? " face" : " faces");
  return {"skipped-faces", faces + " with fewer than three corners skipped"};
}

class MeshBuilder {
 public:
  // A vertex with a coordinate that is not finite, and where the file has it.
  struct NonFinite {
    std::size_t vertex;
    std::size_t offset;
  };

  // `source` must outlive this.
  explicit MeshBuilder(const NamedBytes& source) : name_(source.name) {}

  void reserve_vertices(std::size_t count) { parsed_.mesh.vertices.reserve(count); }
  void reserve_triangles(std::size_t count) { parsed_.mesh.triangles.reserve(count); }

  [[nodiscard]] std::size_t vertex_count() const { return parsed_.mesh.vertices.size(); }
  [[nodiscard]] std::size_t triangle_count() const { return parsed_.mesh.triangles.size(); }

  // `offset` is where the file has it: kept for vertices that are not finite, an error only once a face uses them.
  void add_vertex(const Vec3& vertex, std::size_t offset) {
    if (vertex_count() == kMaxVertices) fail_too_many_vertices(name_);
    if (!is_finite(vertex)) non_finite_.push_back({vertex_count(), offset});
    parsed_.mesh.vertices.push_back(vertex);
  }

  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) { parsed_.mesh.triangles.push_back({a, b, c}); }

  // A polygon, corner by corner, becomes a fan of triangles around its first corner; those of more than three corners
  // are noted, to be cut later where they are not convex.
  void begin_polygon() { corners_ = 0; }
  void add_corner(std::uint32_t vertex) {
    if (corners_ == 0) first_ = vertex;
    if (corners_ >= 2) add_triangle(first_, previous_, vertex);
    previous_ = vertex;
    ++corners_;
  }
  void end_polygon() {
    if (corners_ < 3) skip_face();
    if (corners_ > 3) parsed_.polygons.push_back({parsed_.mesh.triangles.size() - (corners_ - 2), corners_ - 2});
  }

  // Counts a face of fewer than three corners.
  void skip_face() { ++parsed_.skipped_faces; }

  void warn(Warning warning) { parsed_.warnings.push_back(std::move(warning)); }

  // The first vertex that is not finite.
  [[nodiscard]] std::optional<NonFinite> first_non_finite_vertex() const {
    return non_finite_.empty() ? std::nullopt : std::optional(non_finite_.front());
  }
  // Offset of the first of those that triangles use. Precondition: all indices are in range.
  [[nodiscard]] std::optional<std::size_t> non_finite_corner_offset() const {
    if (non_finite_.empty()) return std::nullopt;
    std::size_t first = vertex_count();
    for (const Triangle& triangle : parsed_.mesh.triangles)
      for (const std::uint32_t corner : triangle)
        if (corner < first && !is_finite(parsed_.mesh.vertices[corner])) first = corner;
    if (first == vertex_count()) return std::nullopt;
    const auto precedes = [](const NonFinite& entry, std::size_t vertex) { return entry.vertex < vertex; };
    return std::lower_bound(non_finite_.begin(), non_finite_.end(), first, precedes)->offset;
  }

  // The mesh, with a warning about skipped faces. Nothing may follow.
  [[nodiscard]] ParsedMesh finish() {
    if (const std::uint64_t skipped = parsed_.skipped_faces) warn(skipped_faces_warning(skipped));
    return std::move(parsed_);
  }

 private:
  const std::string& name_;
  ParsedMesh parsed_;
  std::vector<NonFinite> non_finite_;  // in increasing order
  std::uint32_t first_ = 0;
  std::uint32_t previous_ = 0;
  std::uint64_t corners_ = 0;
};

}  // namespace raycone
