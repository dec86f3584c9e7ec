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
  // Numbers of faces, each once: all that have other corners, or a corner that is elsewhere. A face may be named
  // without a change.
  std::vector<std::uint32_t> faces;
  std::vector<Corners> corners;  // of each of them
  // Numbers of vertices that are elsewhere, each once; and where each was and is.
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
