#include "core/boundary/winding_number_engine.h"

namespace raycone {

namespace {

// No factor that double precision is trusted with has an argument that is off by more, in turns, its part of the
// product's rounding included; those of a triangle not by more than three times this (docs/method.md, "Rules").
constexpr double kDoubtPerEdge = 0x1p-41;
constexpr double kMostFactors = 9.0;  // per triangle: three caps, of three factors each
// Beside that, half of kMostDoubt is for what is left out: no tolerance is more (ScaledMesh::tolerance()).
static_assert(kDoubtPerEdge * kMostFactors * kMaxTriangles <= Boundary::kMostDoubt / 2);

}  // namespace

double doubt_of_factors(double edge_factors) { return kDoubtPerEdge * edge_factors; }

CompleteEngine::CompleteEngine(const Boundary& boundary, double edge_factors)
    : boundary_(boundary), doubt_(doubt_of_factors(edge_factors)) {}

}  // namespace raycone
