// What `raycone info` prints of one file or several.
#pragma once

#include <string>

#include "app/options/info_command.h"
#include "app/report/info.h"
#include "app/report/volume_info.h"

namespace raycone {

// Text: blocks with a blank line between them. JSON: the object, of several meshes an array of objects that name
// theirs. CSV: a header line and one row a mesh.
class InfoListing {
 public:
  struct Layout {
    InfoFormat format;
    bool several;             // meshes
    bool with_intersections;  // self-intersections are counted, and have a column
  };
  explicit InfoListing(const Layout& layout) : layout_(layout) {}

  // What to print for the next file, and at the end.
  [[nodiscard]] std::string entry(const MeshInfo& info, const CostedLattices& costed, int threads);
  // The same for a file of values, which has no row in a table.
  [[nodiscard]] std::string entry(const VolumeInfo& info);
  [[nodiscard]] std::string end();

 private:
  Layout layout_;
  bool begun_ = false;
};

}  // namespace raycone
