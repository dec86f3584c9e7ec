// `raycone info`: what a mesh is, and what evaluation will cost.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/data/box.h"
#include "core/data/lattice.h"
#include "core/data/vec3.h"
#include "core/data/warning.h"
#include "core/mesh/mesh_statistics.h"
#include "core/orientation/orient.h"

namespace raycone {

// Pairs of faces that intersect.
struct IntersectionInfo {
  std::optional<std::uint64_t> pairs;  // nothing: there are some, but they were not counted
};

struct MeshInfo {
  std::string mesh;  // as named on the command line
  std::uint64_t faces = 0;
  std::uint64_t vertices = 0;
  std::uint64_t welded_vertices = 0;
  std::uint64_t skipped_faces = 0;  // of one or two corners
  std::string unit;                 // of the file's coordinates, where its format has one
  Box bounds;
  MeshStatistics statistics;                   // of the welded mesh
  std::uint64_t opposite_duplicate_faces = 0;  // pairs of faces that cancel
  std::optional<OrientationCounts> turned;     // what --orient auto did
  std::vector<Warning> warnings;
  std::optional<IntersectionInfo> intersections;  // where asked for
};

struct CostedLattice {
  Lattice lattice;
  double seconds;  // about, on one thread
  bool at_most;    // whether `seconds` is a bound, not an estimate
};

// The lattices whose costs the text tells.
struct CostedLattices {
  std::vector<CostedLattice> lattices;
  std::optional<std::string> no_more;  // why there are no others
};

// Rows of a name and a value.
class InfoTable {
 public:
  void row(const std::string& name, const std::string& value);
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

// "0.1", "(0, 1, 0.5)": nine digits.
[[nodiscard]] std::string printed_point(const Vec3& point);

// Aligned text for people. The costs printed are for `threads` threads.
[[nodiscard]] std::string info_text(const MeshInfo& info, const CostedLattices& costed, int threads);

}  // namespace raycone
