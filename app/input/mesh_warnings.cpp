#include "app/input/mesh_warnings.h"

#include <algorithm>
#include <cstdio>
#include <string>

#include "app/options/field_options.h"
#include "core/evaluation/winding_number.h"
#include "io/files/ascii.h"

namespace raycone {
namespace {

std::string counted_as(std::uint64_t count, const char* one, const char* several) {
  return std::to_string(count) + " " + (count == 1 ? one : several);
}

// What --orient auto would do, where it has not been done.
std::string help(Orient orient, const char* what) {
  return orient == Orient::kAuto ? "" : std::string("; --orient auto ") + what;
}

Warning reversed_warning(const MeshDefects& defects, Orient orient) {
  if (defects.negative_volume) {
    return {"reversed", "the mesh is closed, but its volume is negative" + help(orient, "turns it outward")};
  }
  const bool one = defects.reversed_components == 1;
  return {"reversed", counted_as(defects.reversed_components, "closed component that no other surrounds has",
                                 "closed components that no other surrounds have") +
                          " a negative volume" + help(orient, one ? "turns it outward" : "turns them outward")};
}

const char* hint_at_turning(Orient orient) {
  return orient == Orient::kAuto ? "" : ", --orient auto where faces are reversed";
}

}  // namespace

std::vector<Warning> warnings_about(const MeshDefects& defects, Orient orient) {
  std::vector<Warning> warnings;
  if (defects.negative_volume || defects.reversed_components > 0) warnings.push_back(reversed_warning(defects, orient));
  if (const std::uint64_t edges = defects.inconsistent_edges) {
    warnings.push_back({"inconsistent", counted_as(edges, "edge", "edges") +
                                            " between two faces that run along it in the same direction" +
                                            help(orient, "turns faces to agree")});
  }
  if (const std::uint64_t pairs = defects.cancelling_pairs) {
    warnings.push_back({"opposite-duplicates",
                        counted_as(pairs, "pair", "pairs") +
                            " of faces with the same corners and opposite orientations, which "
                            "cancel" +
                            help(orient, "keeps one of each, which is right unless they are walls between cells")});
  }
  return warnings;
}

std::uint64_t triangles_with_corners(const TriangleMesh& mesh) {
  return static_cast<std::uint64_t>(std::ranges::count_if(mesh.triangles, [&](const Triangle& t) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    return a != b && b != c && c != a;
  }));
}

std::vector<Warning> warnings_about(const OrientationCounts& counts) {
  std::vector<Warning> warnings;
  if (const std::uint64_t edges = counts.cut_edges) {
    warnings.push_back({"unorientable", counted_as(edges, "edge was", "edges were") +
                                            " cut, because no orientation makes all faces agree"});
  }
  if (const std::uint64_t edges = counts.wall_edges) {
    warnings.push_back(
        {"walls", counted_as(edges, "edge", "edges") +
                      " where faces stored in both orientations meet a surface that is closed without "
                      "them; --orient auto keeps one of each two, which bends the winding number "
                      "nearby; --orient keep is right for walls between cells, --orient auto for all else"});
  }
  return warnings;
}

Warning weld_collapsed(std::uint64_t faces, double distance) {
  return {"weld-collapsed", counted_as(faces, "face loses its area", "faces lose their area") + " to --weld " +
                                with_digits(distance, 6) + ", which made corners one; a smaller distance keeps " +
                                (faces == 1 ? "it" : "them")};
}

bool may_have_inside(const Box& box) {
  for (int axis = 0; axis < 3; ++axis) {
    if (box.lower[axis] == box.upper[axis]) return false;
  }
  return true;
}

bool should_have_inside(const Box& box, const PlacedLattice& lattice) {
  if (!may_have_inside(box)) return false;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 place;
    for (int axis = 0; axis < 3; ++axis) place[axis] = (corner >> axis & 1) != 0 ? box.upper[axis] : box.lower[axis];
    const Vec3 indices = indices_of(lattice, place);
    for (int axis = 0; axis < 3; ++axis) {
      const auto first = static_cast<double>(lattice.grid.index_min[static_cast<std::size_t>(axis)]);
      const auto last = static_cast<double>(lattice.grid.index_max(axis));
      if (!(indices[axis] >= first - 1 && indices[axis] <= last + 1)) return false;
    }
  }
  return true;
}

std::optional<Warning> tolerance_not_kept(double tolerance, double bound) {
  if (!(tolerance >= kLeastTolerance) || bound <= tolerance) return std::nullopt;
  constexpr double kUpwards = 1.005;  // to three digits
  char text[200];
  std::snprintf(text, sizeof text,
                "values are expected within %.3g of the true ones, not within %.3g, because sums round; --diagnostics "
                "bounds each value",
                kUpwards * bound, tolerance);
  return Warning{"tolerance", text};
}

Warning nothing_inside(const Rule& rule, Orient orient, const Box& box, const PlacedLattice& lattice) {
  constexpr double kFew = 4.0;  // so few voxels along a mesh are hardly meant
  const std::string nothing = "no sample is inside by the rule " + name_of(rule);
  const char* const by_turning = hint_at_turning(orient);
  const double length = longest_side(box), spacing = lattice.grid.least_spacing();
  if (length < kFew * spacing) {
    return {"empty", nothing + ": the mesh is " + with_digits(length, 3) + " long, and samples are " +
                         with_digits(spacing, 3) + " apart; --scale helps where units differ, else a finer lattice" +
                         by_turning};
  }
  return {"empty", nothing + "; a finer lattice helps where the mesh is thin" + by_turning};
}

Warning no_point_inside(const Rule& rule, Orient orient) {
  return {"empty", "no point is inside by the rule " + name_of(rule) + "; more points help where the mesh is thin" +
                       hint_at_turning(orient)};
}

}  // namespace raycone
