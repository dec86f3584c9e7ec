// The last step of a surface: fewer triangles within the bound that was asked for.
#pragma once

#include "core/cells/node_set.h"
#include "core/surface/face_sources.h"
#include "core/surface/surface.h"

namespace raycone {

// checked_simplify() with pulls of `most` (world units) at most, so that the surface moves by `options.simplify`. Notes
// in `made` what came of it. Faces get their sources anew by `settler`. Needs DefaultFloatingPoint.
void simplify_surface(FinishedSurface& made, const NodeSet& inside, double most, const SurfaceOptions& options,
                      const SourceSettler& settler);

}  // namespace raycone
