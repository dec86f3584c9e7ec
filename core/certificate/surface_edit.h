// What differs between two states of a surface, whose vertices and faces have the same numbers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

struct SurfaceEdit {
  struct Place {
    Vec3 before, after;
  };
  struct Corners {
    Triangle before, after;
  };
  // Numbers of faces, each once: all that have other corners, or a corner that is elsewhere. They may be the same.
  std::vector<std::uint32_t> faces;
  std::vector<Corners> corners;  // of each of them
  // Numbers of vertices, each once, that are elsewhere; and where they were and are.
  std::vector<std::uint32_t> vertices;
  std::vector<Place> places;

  // Whether both states are the same.
  [[nodiscard]] bool changes_nothing() const {
    return vertices.empty() && std::ranges::all_of(corners, [](const Corners& c) { return c.before == c.after; });
  }

  // Turns the state before into the one after.
  void apply(TriangleMesh& mesh) const {
    for (std::size_t n = 0; n < faces.size(); ++n) mesh.triangles[faces[n]] = corners[n].after;
    for (std::size_t n = 0; n < vertices.size(); ++n) mesh.vertices[vertices[n]] = places[n].after;
  }
};

}  // namespace raycone
