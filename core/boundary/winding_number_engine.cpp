#include "core/boundary/winding_number_engine.h"

#include <cmath>
#include <limits>

#include "core/boundary/enclosure.h"

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

// |w - w2| + the bound of w2 = n - enclosure, rounded up.
double enclosed_error(const Boundary& boundary, const Vec3& q, double w, std::int64_t crossings) {
  constexpr long double u = std::numeric_limits<long double>::epsilon() / 2;
  const TurnsWithin<long double> enclosure = enclose_in_64_bits(boundary.groups(), q);
  const long double w2 = static_cast<long double>(crossings - enclosure.whole) - enclosure.rest;
  const long double bound = std::abs(w - w2) + enclosure.bound + u * std::abs(w2);
  return std::nextafter(static_cast<double>(bound * (1 + 8 * u)), std::numeric_limits<double>::infinity());
}

}  // namespace raycone
