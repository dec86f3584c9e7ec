#include "core/surface/surface_in_scale.h"

#include <cmath>
#include <cstdlib>

#include "core/evaluation/winding_number.h"
#include "core/exact/scale.h"

namespace raycone {
namespace {

int exponent_of(const Lattice& lattice) { return std::ilogb(largest_coordinate(lattice)); }

struct ScaledInput {
  TriangleMesh mesh;
  NodeSet inside;
  SurfaceOptions options;

  // Of each number `in_scale` makes another one. Whether none has lost a bit.
  bool scale(const PowerOfTwo& in_scale) {
    const PowerOfTwo back(-in_scale.exponent());
    bool is_exact = true;
    const auto scale_number = [&](double& number) {
      const double scaled = in_scale(number);
      is_exact = is_exact && (back(scaled) == number || !std::isfinite(number));  // as unused vertices may be
      number = scaled;
    };
    const auto scale_vector = [&](Vec3& v) {
      for (int axis = 0; axis < 3; ++axis) scale_number(v[axis]);
    };
    Lattice lattice = inside.lattice();
    scale_vector(lattice.origin);
    scale_vector(lattice.spacing);
    inside = inside.on(lattice);
    for (Vec3& v : mesh.vertices) scale_vector(v);
    scale_number(options.thickness);
    scale_number(options.simplify);
    return is_exact;
  }
};

}  // namespace

bool is_out_of_scale(const Lattice& lattice, const SurfaceOptions& options) {
  constexpr int kFar = 64;  // powers of two from 1
  return options.precision == CoordinatePrecision::kDouble && std::abs(exponent_of(lattice)) > kFar;
}

bool is_far_too_large(const Lattice& lattice) {
  constexpr int kMost = 126;  // power of two
  return exponent_of(lattice) > kMost;
}

std::optional<FinishedSurface> made_in_scale(
    const SurfaceInput& input, const std::function<std::optional<FinishedSurface>(const SurfaceInput&)>& make) {
  const int exponent = exponent_of(input.inside.lattice());
  const PowerOfTwo back(exponent), in_scale(-exponent);
  ScaledInput scaled{input.mesh, input.inside, input.options};
  if (!scaled.scale(in_scale)) return std::nullopt;
  const auto in_this = [&](const WindingNumberEvaluator& evaluator) {
    return WindingNumberEvaluator(scaled.mesh, {.accuracy = evaluator.asked_accuracy()});
  };
  const WindingNumberEvaluator fine = in_this(input.evaluators.fine);
  std::optional<WindingNumberEvaluator> rough;
  if (&input.evaluators.rough != &input.evaluators.fine) rough = in_this(input.evaluators.rough);
  std::optional<FinishedSurface> finished =
      make({scaled.mesh, FineAndRough(fine, rough ? *rough : fine), scaled.inside, scaled.options});
  if (!finished) return std::nullopt;
  for (Vec3& v : finished->surface.mesh.vertices) {
    const Vec3 made = v;
    v = back(v);
    if (in_scale(v) != made) return std::nullopt;
  }
  return finished;
}

}  // namespace raycone
