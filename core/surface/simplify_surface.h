// The last step of a surface: fewer triangles within the bound that was asked for.
#pragma once

#include "core/cells/node_set.h"
#include "core/surface/face_sources.h"
#include "core/surface/surface.h"

namespace raycone {

// Runs checked_simplify() with pulls of at most `most` (world units), so that the surface moves by at most
// `options.simplify`. Sets `made.simplified` and `made.bound_too_small` (where `most` is not positive). Faces get their
// sources anew by `settler`. Needs DefaultFloatingPoint.
void simplify_surface(FinishedSurface& made, const NodeSet& inside, double most, const SurfaceOptions& options,
                      const SourceSettler& settler);

}  // namespace raycone
