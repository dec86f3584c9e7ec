#include "app/run/make_surface.h"

#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "app/options/field_options.h"
#include "app/process/limits.h"
#include "core/distance/distance.h"
#include "core/surface/surface_measures.h"
#include "core/surface/thicken.h"
#include "io/files/file_error.h"

namespace raycone {
namespace {

// What is inside must be something that a surface can go around.
void check_inside(const std::string& name, const NodeSet& inside, const Rule& rule) {
  if (inside.empty()) {
    throw InputError(name + ": no sample is inside by the rule " + name_of(rule) +
                     ": reversed faces (--orient auto), or parts thinner than a voxel (--resolution N, "
                     "raycone surface --thicken T)?");
  }
  if (inside.reaches_border()) {
    throw InputError(name + ": what is inside by the rule " + name_of(rule) +
                     " reaches the border of the lattice, expected a larger box (--padding P), faces that agree "
                     "(--orient auto), or another rule");
  }
}

FinishedSurface surface_of(const std::string& name, const TriangleMesh& mesh, const FineAndRough& evaluators,
                           const NodeSet& inside, const SurfaceOptions& options) {
  try {
    return closed_surface(mesh, evaluators, inside, options);
  } catch (const LatticeTooFine& error) {
    const char* const other_format = options.single_precision ? ", or write PLY" : "";
    throw LimitError(name + ": " + error.what() + "; see --resolution and --normalize" + other_format);
  } catch (const LatticeOutOfRange& error) {
    throw LimitError(name + ": " + error.what() + "; see --scale");
  } catch (const std::length_error&) {
    throw LimitError(name +
                     ": the surface would have more than 2147483632 faces or edges of the lattice; see --resolution");
  }
}

SurfaceReport report_of(const SurfaceMesh& surface, const SurfaceMeasures& measures) {
  return {surface.mesh.vertices.size(), surface.mesh.triangles.size(), measures.components, measures.max_distance,
          measures.hole_area,           measures.dropped_area};
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
  if (!(thin.of_all > 0.0)) return std::nullopt;
  char percent[32];
  std::snprintf(percent, sizeof percent, "%.3g", 100.0 * thin.of_all);
  std::string text = std::string(percent) + " % of the mesh's area is of parts too thin for the lattice, and left out";
  if (thin.lost > 0) text += ", " + std::to_string(thin.lost) + (thin.lost == 1 ? " part" : " parts") + " as a whole";
  return Warning{"thin-parts", text + "; see --resolution, and --thicken of half a voxel's diagonal or more"};
}

Accuracy for_points(double tolerance, double points) {
  return {.tolerance = tolerance, .samples = points, .points = points};
}

EvaluatorOptions options_for(const Accuracy& accuracy, const std::vector<ExteriorEdge>& edges) {
  return {.accuracy = accuracy, .edges = &edges};
}

}  // namespace

MadeSurface make_surface(const std::string& name, const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges,
                         const Lattice& lattice, const SurfaceOptions& options, std::uint64_t memory,
                         std::atomic<std::uint64_t>* done) {
  check_memory(name, node_set_bytes(lattice), memory);
  const Accuracy for_sides{.tolerance = tolerance_for_sides(options.rule),
                           .samples = static_cast<double>(whole(lattice).size()),
                           .sides_only = true};
  std::optional<WindingNumberEvaluator> fine, rough(std::in_place, mesh, options_for(for_sides, edges));
  NodeSet inside = nodes_inside(*rough, options.rule, lattice, done);
  if (options.thickness > 0.0) insert_near(inside, DistanceEvaluator(mesh), options.thickness);
  check_inside(name, inside, options.rule);
  check_memory(name, surface_bytes(inside, mesh.triangles.size()), memory);
  if (!edges.empty()) {                   // the values of a closed mesh are exact anyway
    constexpr double kTolerance = 1e-10;  // moves points in holes by less than a millionth of a voxel, as a rule
    constexpr double kPerCell = 4.0;      // points that either is asked for, where there are few holes
    const double points = kPerCell * static_cast<double>(mixed_cells(inside));
    fine.emplace(mesh, options_for(for_points(kTolerance, points), edges));
    rough.emplace(mesh, options_for(for_points(for_sides.tolerance, points), edges));
  }
  FinishedSurface closed = surface_of(name, mesh, fine ? FineAndRough(*fine, *rough) : *rough, inside, options);
  fine.reset();
  MadeSurface made{std::move(closed.surface), {}, warnings_about(closed, options)};
  if (options.at_stage) options.at_stage("measuring");
  DroppedSamples dropped(made.surface, inside, options.thickness);
  const SurfaceMeasures measures = measure_surface(made.surface, mesh, dropped);
  made.report = report_of(made.surface, measures);
  if (measures.drops) {
    const ThinParts thin = thin_parts(mesh, {*rough, options.rule}, dropped);
    if (const std::optional<Warning> warning = warning_about(thin)) made.warnings.push_back(*warning);
  }
  return made;
}

}  // namespace raycone
