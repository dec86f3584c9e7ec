#include "core/surface/simplify_surface.h"

#include "core/cells/surface_mesh.h"
#include "core/merging/checked_simplify.h"

namespace raycone {

void simplify_surface(FinishedSurface& made, const NodeSet& inside, double most, const SurfaceOptions& options,
                      const SourceSettler& settler) {
  const bool had_holes = has_holes(made.surface);
  made.bound_too_small = !(most > 0.0);
  if (!made.bound_too_small && options.at_stage) options.at_stage("simplifying");
  made.simplified = !made.bound_too_small && checked_simplify(made.surface, inside, most, options.rounds);
  if (!made.simplified) return;
  settler.settle(made.surface);
  if (had_holes) settler.forget_far_sources(made.surface, options.thickness + options.simplify);
}

}  // namespace raycone
