#include "core/far/far_field.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/boundary/solid_angles.h"

namespace raycone {
namespace {

// Measured with soups of 100 000 triangles and CAD models on lattices of 50^3, for tolerances of 1e-4 to 1e-10.
constexpr SourceTree::Detail kDetail{64, kMultipoleOrder};

// In units of an exterior edge.
struct Costs {
  double triangle, expansion;
};

// Of such a tree: what 50^3 lattices and 20 000 to 10^6 points of two soups and four CAD models took with AVX-512. The
// degree hardly depends on the tolerance: nodes are taken as soon as the highest one serves.
constexpr Costs kAtPoint{1.7, 28.0}, kOnLattice{1.8, 50.0};

// Place number n, n >= 1, of a sequence that fills a unit cube evenly, however many there are: multiples of the powers
// of 1 / 1.2207..., without whole parts (Roberts 2018). Coordinates in [0, 1).
Vec3 even_place(std::size_t n) {
  const double count = static_cast<double>(n);
  const Vec3 turns = count * Vec3{0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
  return turns - Vec3{std::floor(turns.x), std::floor(turns.y), std::floor(turns.z)};
}

}  // namespace

bool far_field_may_pay(double samples, double sources, double direct) {
  constexpr double kPreparation = 4500;  // of a source, in units of an exterior edge at a sample
  const double small_part = std::clamp(sources / 40'000, 0.04, 0.25);
  return kPreparation < small_part * samples * direct;
}

FarField::FarField(const TriangleMesh* caps, SimdLevel level)
    : kernel_(far_kernel(level)),
      has_caps_(caps != nullptr),
      cap_crossings_(caps ? CapCrossings(*caps) : CapCrossings()) {}

FarField::FarField(const TriangleMesh& mesh, const TriangleMesh* caps, double tolerance, SimdLevel level)
    : FarField(caps, level) {
  SolidFaces faces = solid_faces(caps ? *caps : mesh);
  faces_repeat_ = faces.has_repeated_faces;
  doubt_ = doubt(tolerance, static_cast<double>(faces.triangles.size()));
  tree_ = &own_tree_.emplace(std::move(faces.triangles), tolerance, level, kDetail);
  set_costs(bounding_box(mesh), tolerance);
}

FarField::FarField(const TriangleMesh& mesh, const TriangleMesh* caps, const SourceTree& tree, double tolerance,
                   SimdLevel level)
    : FarField(caps, level) {
  tree_ = &tree;
  doubt_ = doubt(tolerance, static_cast<double>(tree.triangles().size()));
  set_costs(bounding_box(mesh), tolerance);
}

double FarField::doubt(double tolerance, double sources) { return tolerance + doubt_of_factors(3 * sources); }

void FarField::set_costs(const Box& box, double tolerance) {
  const double digits = std::max(2.0, -std::log10(tolerance));  // with which degrees grow in trees of blocks
  const bool is_own = own_tree_.has_value();
  const Costs at_point = is_own ? kAtPoint : Costs{2.5, 2.0 + 0.7 * digits};
  const Costs on_lattice = is_own ? kOnLattice : Costs{2.5, 3.0 + 2.0 * digits};
  SampleTile places;
  for (std::size_t n = 1; n <= kTile; ++n) {
    const Vec3 part = even_place(n);
    Vec3 place;
    for (int axis = 0; axis < 3; ++axis) {
      place[axis] = box.lower[axis] + part[axis] * (box.upper[axis] - box.lower[axis]);
    }
    places.add(place);
  }
  FarTile result;
  kernel_.sum(*tree_, places, result);
  const double near = static_cast<double>(result.near_terms) / static_cast<double>(kTile);
  const double far = static_cast<double>(result.far_terms) / static_cast<double>(kTile);
  cost_ = at_point.triangle * near + at_point.expansion * far;
  cost_on_lattice_ = on_lattice.triangle * near + on_lattice.expansion * far;
}

void FarField::winding_numbers(SampleTile& samples, std::span<const std::int64_t> crossings,
                               std::span<double> w) const {
  std::array<std::int64_t, kTile> whole{};
  if (has_caps_) {
    const std::array<std::int64_t, kTile> of_caps = cap_crossings_.of(samples);
    for (std::size_t i = 0; i < samples.count; ++i) whole[i] = crossings[i] - of_caps[i];
  }
  winding_numbers_of_closed(samples, whole, w);
}

void FarField::winding_numbers_of_closed(SampleTile& samples, std::span<const std::int64_t> whole,
                                         std::span<double> w) const {
  samples.fill_up();
  FarTile result;
  kernel_.sum(*tree_, samples, result);
  for (std::size_t i = 0; i < samples.count; ++i) {
    w[i] = static_cast<double>(whole[i] + result.near.turns(i)) + (result.near.argument[i] + result.far[i]);
  }
  near_terms_.fetch_add(result.near_terms, std::memory_order_relaxed);
  far_terms_.fetch_add(result.far_terms, std::memory_order_relaxed);
}

}  // namespace raycone
