#include "app/fields/make_surface.h"

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "app/options/field_options.h"
#include "app/process/memory_limit.h"
#include "core/distance/distance.h"
#include "core/filling/mesh_as_surface.h"
#include "core/surface/surface_measures.h"
#include "core/surface/thicken.h"
#include "io/files/ascii.h"
#include "io/files/file_error.h"

namespace raycone {
namespace {

// What is inside must be something that a surface can go around.
void check_inside(const MeshToClose& input, const NodeSet& inside, const SurfaceOptions& options) {
  const std::string rule = name_of(options.rule);
  const bool may_turn = input.orient != Orient::kAuto;
  if (inside.empty()) {
    const bool thickens = options.thickness > 0.0;
    throw InputError(
        input.name + ": no sample is inside by the rule " + rule + (thickens ? ", or within --thicken: " : ": ") +
        (may_turn ? "reversed faces (--orient auto), or " : "") + "parts thinner than a voxel (--resolution N, " +
        (thickens ? "a larger --thicken" : "raycone surface --thicken T") + ")?");
  }
  if (inside.reaches_border()) {
    throw InputError(input.name + ": what is inside by the rule " + rule +
                     " reaches the border of the lattice, expected a larger " +
                     (input.like_grid ? "grid" : "box (--padding P)") +
                     (may_turn ? ", faces that agree (--orient auto), or another rule" : ", or another rule"));
  }
}

// What `make` returns. Where it finds that numbers do not do, throws LimitError, which names `name`.
template <class Make>
auto with_surface_errors(const std::string& name, const SurfaceOptions& options, const Make& make) {
  try {
    return make();
  } catch (const LatticeTooFine& error) {
    const char* const other_format = options.precision == CoordinatePrecision::kSingle ? ", or write PLY" : "";
    throw LimitError(name + ": " + error.what() + "; see --resolution and --normalize" + other_format);
  } catch (const LatticeOutOfRange& error) {
    throw LimitError(name + ": " + error.what() + "; see --scale");
  } catch (const std::length_error&) {
    throw LimitError(name +
                     ": the surface would have more than 2147483632 faces or edges of the lattice; see --resolution");
  }
}

SurfaceReport report_of(const SurfaceMesh& surface, const SurfaceMeasures& measures, const DroppedArea& dropped) {
  return {surface.mesh.vertices.size(), surface.mesh.triangles.size(),
          measures.components,          measures.max_distance,
          measures.hole_area,           dropped.area};
}

std::vector<Warning> warnings_about(const FinishedSurface& closed, const SurfaceOptions& options) {
  std::vector<Warning> warnings;
  if (!closed.merged) {
    warnings.push_back({"not-merged",
                        "faces of one plane are not merged: each try made faces that intersect, or that "
                        "have samples on the wrong side"});
  }
  if (closed.bound_too_small) {
    warnings.push_back({"not-simplified",
                        "--simplify left all faces: the distance is within what rounding of vertices may move, "
                        "some billionths of a voxel, or more far from the origin, in single precision, and where "
                        "the mesh's coordinates are rounded"});
  } else if (!closed.simplified) {
    warnings.push_back({"not-simplified", "--simplify left all faces: " + std::to_string(options.rounds) +
                                              " tries made faces that intersect, expected a smaller distance"});
  }
  return warnings;
}

// What is dropped, though it is a part of the solid.
std::optional<Warning> warning_about(const ThinParts& thin) {
  constexpr double kNothing = 1e-9;  // slivers, which rounding may leave of any mesh
  if (!(thin.of_all > (thin.lost > 0 ? 0.0 : kNothing))) return std::nullopt;
  std::string text =
      with_digits(100.0 * thin.of_all, 3) + " % of the mesh's area is of parts too thin for the lattice, and left out";
  if (thin.lost > 0) text += ", " + std::to_string(thin.lost) + (thin.lost == 1 ? " part" : " parts") + " as a whole";
  return Warning{"thin-parts", text + "; see --resolution, and --thicken of half a voxel's diagonal or more"};
}

Accuracy for_points(double tolerance, double points) {
  return {.tolerance = tolerance, .samples = points, .points = points};
}

EvaluatorOptions options_for(const Accuracy& accuracy, const std::vector<ExteriorEdge>& edges) {
  return {.accuracy = accuracy, .edges = &edges};
}

// Of an open mesh, for points: one that finds where surfaces close holes, and a rough one, which is sooner.
struct PointEvaluators {
  WindingNumberEvaluator fine, rough;

  PointEvaluators(const MeshToClose& input, const NodeSet& inside, const Rule& rule)
      : fine(input.mesh, options_for(for_points(kTolerance, points_in(inside)), input.edges)),
        rough(input.mesh, options_for(for_points(tolerance_for_sides(rule), points_in(inside)), input.edges)) {}

 private:
  static constexpr double kTolerance = 1e-10;  // moves points in holes by less than a millionth of a voxel, as a rule

  // How many either is asked for, where there are few holes.
  static double points_in(const NodeSet& inside) {
    constexpr double kPerCell = 4.0;
    return kPerCell * static_cast<double>(mixed_cells(inside));
  }
};

// The mesh itself where that does, else a contour, where `memory` does for one.
FinishedSurface finished_surface(const std::string& name, const SurfaceInput& made_of, std::uint64_t memory) {
  return with_surface_errors(name, made_of.options, [&] {
    std::optional<FinishedSurface> itself = mesh_as_surface(made_of);
    if (itself) return *std::move(itself);
    check_memory(name, surface_bytes(made_of.inside, made_of.mesh.triangles.size()), memory);
    return closed_surface(made_of);
  });
}

// Compares the surface with the mesh: sets its report, and warns of what it leaves out. `own`: of FinishedSurface.
void measure(const SurfaceInput& made_of, std::optional<OwnFaces> own, MadeSurface& made) {
  const auto& [mesh, evaluators, inside, options] = made_of;
  const Lattice& lattice = inside.lattice();
  const SurfaceFaces faces = own ? SurfaceFaces::kOfMesh : SurfaceFaces::kOfContour;
  const double farthest = farthest_kept(mesh, lattice, faces, options.precision);
  DroppedSamples samples(made.surface, inside, options.thickness, farthest + options.thickness + options.simplify,
                         own ? std::move(own->held) : std::vector<bool>());
  const DroppedArea dropped = dropped_area(mesh, samples);
  made.report = report_of(made.surface, measure_surface(made.surface, mesh, lattice), dropped);
  ThinParts thin;
  if (own) {
    thin = {.of_all = own->left_out_of_all, .lost = own->left_out};
  } else if (dropped.is_some) {
    thin = thin_parts(mesh, {evaluators.rough, options.rule}, samples);
  }
  if (const std::optional<Warning> warning = warning_about(thin)) made.warnings.push_back(*warning);
}

}  // namespace

MadeSurface make_surface(const MeshToClose& input, const Lattice& lattice, const SurfaceOptions& options,
                         std::uint64_t memory, std::atomic<std::uint64_t>* done) {
  check_memory(input.name, node_set_bytes(lattice), memory);
  MadeSurface made;
  const Accuracy for_sides{.tolerance = tolerance_for_sides(options.rule),
                           .samples = static_cast<double>(whole(lattice).size()),
                           .sides_only = true};
  std::optional<WindingNumberEvaluator> at_nodes(std::in_place, input.mesh, options_for(for_sides, input.edges));
  NodeSet inside = nodes_inside(*at_nodes, options.rule, lattice, done, &made.tally);
  made.terms = at_nodes->terms();
  if (options.thickness > 0.0) insert_near(inside, DistanceEvaluator(input.mesh), options.thickness);
  check_inside(input, inside, options);
  std::optional<PointEvaluators> at_points;
  if (!input.edges.empty()) {  // values of closed meshes are exact anyway
    at_nodes.reset();          // what it held is free for those that follow
    at_points.emplace(input, inside, options.rule);
  }
  const FineAndRough evaluators = at_points ? FineAndRough(at_points->fine, at_points->rough) : FineAndRough(*at_nodes);
  const SurfaceInput made_of{input.mesh, evaluators, inside, options};
  FinishedSurface finished = finished_surface(input.name, made_of, memory);
  made.surface = std::move(finished.surface);
  made.warnings = warnings_about(finished, options);
  if (options.at_stage) options.at_stage("measuring");
  measure(made_of, std::move(finished.own), made);
  if (at_points) made.terms += at_points->fine.terms(), made.terms += at_points->rough.terms();
  return made;
}

}  // namespace raycone
