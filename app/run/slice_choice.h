// From a box and the options of a slice to the pixels of its picture. The rules are those of docs/formats.md, "Slices".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "app/picture/plane_view.h"
#include "app/run/lattice_choice.h"
#include "core/data/lattice.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// Of the box, before padding, from its lower to its upper end.
struct Percentage {
  double value = 50.0;
};

struct AxisPlane {
  int axis = 2;
  std::variant<Percentage, double> at;  // or world units
};

struct ObliquePlane {
  std::optional<Vec3> origin;  // a point of the plane; else the middle of the box
  Vec3 normal;                 // towards the viewer, not zero
  std::optional<Vec3> up;      // else z, or y for a plane across z
};

struct SliceRequest {
  std::optional<Box> bounds;  // in place of the mesh's box
  std::variant<WorldPadding, VoxelPadding> padding;
  std::variant<AxisPlane, ObliquePlane> plane;
  std::int64_t size = 1024;  // pixels along the longer side
};

struct Slice {
  PlaneView view;
  std::optional<Lattice> lattice;  // of the pixels' centres, where the plane is across an axis; row 0 is its last
  std::string place;               // "z = 1.5", for readers
};

// What the user should know is appended to `warnings`. Throws UsageError where the box has no such picture, LimitError
// where double cannot hold it.
[[nodiscard]] Slice choose_slice(const Box& mesh_box, const SliceRequest& request, std::vector<std::string>& warnings);

}  // namespace raycone
