#include "core/surface/surface.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/cells/cell_triangles.h"
#include "core/cells/edge_points.h"
#include "core/cells/plane_tolerance.h"
#include "core/cells/surface_cells.h"
#include "core/cells/triangle_normals.h"
#include "core/certificate/fault_places.h"
#include "core/contour/cell_polygons.h"
#include "core/contour/contour.h"
#include "core/contour/face_points.h"
#include "core/contour/vertex_places.h"
#include "core/data/coordinate_precision.h"
#include "core/distance/distance.h"
#include "core/machine/floating_point.h"
#include "core/machine/threads.h"
#include "core/merging/checked_merge.h"
#include "core/sharpening/checked_sharpen.h"
#include "core/sharpening/corner_gaps.h"
#include "core/surface/face_sources.h"
#include "core/surface/simplify_surface.h"
#include "core/surface/surface_beside_nodes.h"
#include "core/surface/surface_in_scale.h"
#include "core/surface/thicken.h"

namespace raycone {
namespace {

constexpr double kMostOfFirst = 0x1p-5;  // voxels; of margins at first, as wider ones, to kMostMargin, may follow

// One attempt at a surface after the other.
class SurfaceMaker {
 public:
  explicit SurfaceMaker(const SurfaceInput& input)
      : mesh_(input.mesh),
        evaluators_(input.evaluators),
        inside_(input.inside),
        options_(input.options),
        rule_(evaluators_, options_.rule),
        normals_(mesh_),
        cells_(inside_),
        triangles_(options_.thickness > 0.0 ? CellTriangles() : CellTriangles(mesh_, cells_)),
        creases_(options_.thickness > 0.0 ? CellCreases() : CellCreases(mesh_, normals_, triangles_, cells_)),
        distance_(mesh_),
        settler_(mesh_, normals_, distance_, farthest_source(inside_.lattice(), options_.thickness)),
        tolerance_(plane_tolerance(mesh_, inside_.lattice())) {}

  FinishedSurface make() {
    enter("finding points on the mesh");
    constexpr std::array kWidened{1.0, 0x1p6, 0x1p12};
    const double least = surface_margin(inside_.lattice(), options_.precision);
    Attempt last;
    for (const double factor : kWidened) {
      const double margin = std::min(factor * least, kMostMargin);
      find_points(margin);
      if (may_use_polygons()) {
        Attempt first = attempt(points_of_sections(margin), margin, {.cells = ContourCells::kPolygons});
        if (first.cuts_nodes_off && factor == 1.0) {
          if (std::optional<FinishedSurface> other = beside_nodes(margin, first.faces / 2))
            first.made = std::move(other);
        }
        if (first.made) return *std::move(first.made);
      }
      FacePoints sharp(in_cells(margin));
      for (int round = 0; round < kRounds; ++round) {
        if (may_use_polygons()) {
          last = attempt(sharp, margin, {.cells = ContourCells::kPolygons});
          if (last.made) return *std::move(last.made);
        }
        last = attempt(sharp, margin, {});
        if (last.is_sharpened && !last.made) last = attempt(sharp, margin, {.sharpens = false});
        if (last.made) return *std::move(last.made);
        const std::vector<bool> dropped = involved(sharp, last);
        if (std::ranges::find(dropped, true) == dropped.end()) break;  // another round would be the same
        sharp = sharp.without(dropped);
      }
      if (margin == kMostMargin) break;  // and so would another margin
    }
    throw SurfaceFailure(described(last.faults.value_or(SurfaceFaults())));
  }

 private:
  static constexpr double kMostMargin = 0x1p-4;
  static constexpr double kOff = 4.0;  // margins that points of a plane may be off it, if not plane_tolerance()
  static constexpr int kRounds = 4;

  struct AttemptOptions {
    ContourCells cells = ContourCells::kTetrahedra;
    bool sharpens = true;
  };

  struct Attempt {
    std::optional<FinishedSurface> made;
    bool is_sharpened = false;
    bool cuts_nodes_off = false;            // see CheckedMerge; of a surface of planes
    std::size_t faces = 0;                  // after merging, if that succeeded
    std::optional<SurfaceFaults> faults{};  // of the surface before merging, where they have been looked for
    TriangleMesh failed{};                  // that surface, where it has any
  };

  void find_points(double margin) {
    points_ = options_.thickness > 0.0 ? thick_edge_points(rule_, distance_, options_.thickness, cells_, margin)
                                       : edge_points(mesh_, rule_, cells_, triangles_, margin);
  }

  // Merged only: by a lattice that is moved by a part of a voxel, which `most` faces or more would not be worth.
  [[nodiscard]] std::optional<FinishedSurface> beside_nodes(double margin, std::size_t most) {
    SurfaceOptions merge_only = options_;
    merge_only.simplify = 0.0;
    const auto merged_surface = [&](const Lattice& moved) -> std::optional<SurfaceMesh> {
      const NodeSet nodes = nodes_inside(evaluators_.rough, options_.rule, moved);
      if (nodes.empty() || nodes.reaches_border()) return std::nullopt;
      SurfaceMaker maker({mesh_, evaluators_, nodes, merge_only});
      maker.find_points(margin);
      Attempt made = maker.attempt(maker.points_of_sections(margin), margin, {.cells = ContourCells::kPolygons});
      if (!made.made || !made.made->merged) return std::nullopt;
      return std::move(made.made->surface);
    };
    std::vector<Vec3> points(points_.size());
    std::ranges::transform(points_, points.begin(), &EdgePoint::position);
    const SurfaceBounds limits = bounds(margin);
    std::optional<SurfaceMesh> surface =
        surface_beside_nodes(mesh_, inside_, points,
                             {kNearCorner * margin * inside_.lattice().least_spacing(),
                              most_merging(limits.margin, limits.merge_tolerance()), most, options_.precision},
                             merged_surface);
    if (!surface) return std::nullopt;
    FinishedSurface made{*std::move(surface)};
    if (options_.simplify > 0.0) simplify(made, margin);
    return made;
  }

  [[nodiscard]] SurfaceInCells in_cells(double margin) const {
    return {cells_, points_, creases_, tolerance_, margin};
  }

  // What thickens has points off the mesh.
  [[nodiscard]] bool may_use_polygons() const { return !(options_.thickness > 0.0); }

  // Several points of a face help where the surface is polygons then. Cones of tetrahedra would only have more
  // triangles.
  [[nodiscard]] FacePoints points_of_sections(double margin) const {
    const SurfaceInCells surface = in_cells(margin);
    FacePoints sharp(surface, PointsOfFaces::kSections);
    sharp.keep_sections_at(polygons_at_sections(surface, sharp), surface);
    return sharp;
  }

  void enter(const char* stage) const {
    if (options_.at_stage) options_.at_stage(stage);
  }

  // The merged surface is checked as a whole. The one before is checked only if undoing does not soon mend what that
  // has, or nothing is merged.
  Attempt attempt(const FacePoints& sharp, double margin, const AttemptOptions& how) {
    enter("joining them by triangles");
    auto [surface, tetrahedra, first_apex, fewer] = contour(in_cells(margin), sharp, how.cells);
    round_to(options_.precision, surface.mesh.vertices);
    Attempt result;
    const ContourPoints made_of{points_, sharp.positions(), std::span(surface.mesh.vertices).subspan(first_apex),
                                options_.precision};
    const std::uint64_t places = misplaced_vertices(made_of, cells_, sharp, tetrahedra, margin);
    // Sharpening looks at sources, and moves faces into planes of others. Merging keeps them, so that it changes no
    // area of theirs.
    settler_.settle(surface);
    if (how.sharpens && places == 0 && options_.thickness == 0.0) result.is_sharpened = sharpen(surface, margin, fewer);
    if (result.is_sharpened) settler_.settle(surface);
    if ((places > 0 || !options_.merge_planes) && !is_right(surface, places, result)) return result;
    FinishedSurface made{std::move(surface)};
    if (options_.merge_planes) made.merged = merge(made.surface, margin, how.cells, result);
    if (options_.merge_planes && !made.merged && how.cells == ContourCells::kPolygons) return result;
    if (result.faults && !result.faults->none()) return result;
    if (!made.merged && !is_right(made.surface, places, result)) return result;
    if (options_.simplify > 0.0) simplify(made, margin);
    result.made = std::move(made);
    return result;
  }

  // Of the surface before merging; looked for once.
  bool is_right(const SurfaceMesh& surface, std::uint64_t places, Attempt& attempt) const {
    if (attempt.faults) return attempt.faults->none();
    enter("checking");
    attempt.faults = faults_of(surface.mesh, inside_);
    attempt.faults->places = places;
    if (!attempt.faults->none()) attempt.failed = surface.mesh;
    return attempt.faults->none();
  }

  bool merge(SurfaceMesh& surface, double margin, ContourCells kind, Attempt& attempt) const {
    enter("merging the triangles of a plane");
    const SurfaceBounds limits = bounds(margin);
    const auto is_right_unmerged = [&] { return is_right(surface, 0, attempt); };
    CheckedMerge result = checked_merge(
        surface, mesh_, inside_,
        {margin, limits.merge_tolerance(), options_.precision, kind == ContourCells::kPolygons}, is_right_unmerged);
    const double off = std::max(kOff * limits.margin, tolerance_);
    attempt.cuts_nodes_off = result.cuts_nodes_off && is_of_planes(surface, mesh_, off);
    if (result.surface) surface = *std::move(result.surface);
    attempt.faces = surface.sources.size();
    return result.surface.has_value();
  }

  // Sharp edges that the lattice does not see. What they become is checked, for they leave their cells.
  [[nodiscard]] bool sharpen(SurfaceMesh& surface, double margin, std::uint64_t fewer) const {
    constexpr double kReach = 2.0;  // voxels
    const Lattice& lattice = inside_.lattice();
    const SharpenLimits limits{std::max(kOff * margin * lattice.largest_spacing(), tolerance_),
                               kReach * lattice.least_spacing(), options_.precision, fewer};
    const SharpenInput input{mesh_, normals_, distance_};
    const bool is_pulled = checked_sharpen(surface, input, inside_, limits);
    return fill_corner_gaps(surface, input, lattice, limits) || is_pulled;
  }

  [[nodiscard]] SurfaceBounds bounds(double margin) const {
    return {margin * inside_.lattice().largest_spacing(), tolerance_, options_.simplify};
  }

  void simplify(FinishedSurface& made, double margin) const {
    simplify_surface(made, inside_, bounds(margin).farthest_pull(), options_, settler_);
  }

  // The face points of cells with faces that intersect. Where faults are of other kinds, all of them. `attempt`: of
  // tetrahedra, and not sharpened, so that vertices have the numbers that contour() gave them.
  [[nodiscard]] std::vector<bool> involved(const FacePoints& sharp, const Attempt& attempt) const {
    const std::size_t count = sharp.positions().size(), first = points_.size();
    std::vector<bool> dropped(count, attempt.faults->intersections.pairs == 0);
    const TriangleMesh& failed = attempt.failed;
    const std::vector<bool> near = faulty_vertices(failed.vertices.size(), failed.triangles, *attempt.faults);
    for (const Triangle& t : failed.triangles) {
      if (!near[t[0]] && !near[t[1]] && !near[t[2]]) continue;
      for (const std::uint32_t corner : t) {
        if (corner >= first && corner < first + count) dropped[corner - first] = true;
      }
    }
    return dropped;
  }

  const TriangleMesh& mesh_;
  FineAndRough evaluators_;
  const NodeSet& inside_;
  const SurfaceOptions& options_;
  RuleAlong rule_;
  TriangleNormals normals_;
  SurfaceCells cells_;
  CellTriangles triangles_;
  CellCreases creases_;
  DistanceEvaluator distance_;
  SourceSettler settler_;

  double tolerance_;
  std::vector<EdgePoint> points_;
};

}  // namespace

// Fewer roundings are enough where more would be too much; but they keep less apart what must not meet.
double surface_margin(const Lattice& lattice, CoordinatePrecision precision) {
  constexpr double kLeast = 0x1p-30, kRoundings = 0x1p8, kFewest = 0x1p5;
  const double rounding = std::max(relative_rounding(precision) * largest_coordinate(lattice), 0x1p-1074);
  const double voxels = rounding / lattice.least_spacing();
  return std::max(kLeast, (kRoundings * voxels <= kMostOfFirst ? kRoundings : kFewest) * voxels);
}

FinishedSurface closed_surface(const SurfaceInput& input) {
  const DefaultFloatingPoint guard;
  constexpr double kLargestFloat = 0x1p127, kLeastVoxel = 0x1p-80, kLeastCoordinate = 0x1p-1000;
  const Lattice& lattice = input.inside.lattice();
  const double largest = largest_coordinate(lattice);
  const double margin = surface_margin(lattice, input.options.precision);
  const bool is_single = input.options.precision == CoordinatePrecision::kSingle;
  const std::string precision = is_single ? "single precision" : "double precision";
  const bool fits_float = largest < kLargestFloat && lattice.least_spacing() > kLeastVoxel;
  const bool is_tiny = largest < kLeastCoordinate && !(margin <= kMostOfFirst);
  if (is_tiny || (is_single && !fits_float)) {
    throw LatticeOutOfRange("the lattice is beyond what " + precision + " can hold");
  }
  if (!(margin <= kMostOfFirst))
    throw LatticeTooFine("voxels are too small for " + precision + " beside the largest coordinate");
  if (is_out_of_scale(lattice, input.options)) {
    std::optional<FinishedSurface> surface =
        made_in_scale(input, [](const SurfaceInput& scaled) { return SurfaceMaker(scaled).make(); });
    if (surface) return *std::move(surface);
    if (is_far_too_large(lattice)) {
      throw LatticeOutOfRange("the mesh has coordinates too small beside the lattice for " + precision);
    }
  }
  return SurfaceMaker(input).make();
}

// Most of it is due to cells with nodes of both kinds: there are about eight triangles in each before they are merged.
// Measured on eleven meshes (scans, CAD parts, open ones, nearly a soup) at 64, 128 and 256 samples: from one number of
// samples to the next, 950 to 1500 bytes more per cell (2000 of the soup); and on three meshes of 70 000 to 1.09e6
// triangles, which are many more than cells, 500 to 600 per triangle. All that a process is said to need is 0.9 to 1.3
// times its peak then, of closed meshes and CAD models; 0.5 to 0.8 where most of the surface closes holes, whose faces
// are not merged. But allocators map more than they use, so what is let pass may still run into the limit.
double surface_bytes(const NodeSet& inside, std::size_t triangles) {
  constexpr double kPerCell = 1700.0, kPerTriangle = 600.0, kAtLeast = 4e6, kNodeSets = 3.0, kWord = 8.0;
  const double words = static_cast<double>(inside.words_per_row()) * static_cast<double>(inside.count(1)) *
                       static_cast<double>(inside.count(2));
  return kAtLeast + kNodeSets * kWord * words + kPerCell * static_cast<double>(mixed_cells(inside)) +
         kPerTriangle * static_cast<double>(triangles);
}

}  // namespace raycone
