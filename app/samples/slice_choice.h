// From a box and the options of a slice to the pixels of its picture. The rules are those of docs/formats.md, "Slices".
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/options/slice_command.h"
#include "app/picture/plane_view.h"
#include "core/data/box.h"
#include "core/data/lattice.h"
#include "core/data/warning.h"

namespace raycone {

struct Slice {
  PlaneView view;
  std::optional<Lattice> lattice;  // of the pixels' centres, where the plane is across an axis; row 0 is its last
  std::string plane;               // "z = 1.5", for readers
  std::string short_plane;         // the same in fewer letters
  bool is_flat = false;            // whether the box has no width or no height in the plane
};

// What the user should know is appended to `warnings`. Throws UsageError where no such picture of the box is possible,
// LimitError where double cannot hold it.
[[nodiscard]] Slice choose_slice(const Box& mesh_box, const SliceRequest& request, std::vector<Warning>& warnings);

}  // namespace raycone
