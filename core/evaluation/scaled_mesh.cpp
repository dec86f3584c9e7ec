#include "core/evaluation/scaled_mesh.h"

#include <algorithm>
#include <new>
#include <utility>

#include "core/boundary/cone.h"
#include "core/boundary/solid_angles.h"

namespace raycone {
namespace {

TriangleMesh in_scale(TriangleMesh mesh, const PowerOfTwo& scale) {
  for (Vec3& p : mesh.vertices) p = scale(p);
  return mesh;
}

// The engine that is asked for.
std::unique_ptr<const WindingNumberEngine> direct_engine(const TriangleMesh& mesh, const Boundary& boundary,
                                                         bool in_scale, const EvaluatorOptions& options) {
  if (boundary.exterior_edges() == 0) return nullptr;
  const bool cheapest = options.summation != Summation::kCone && options.summation != Summation::kTriangles;
  const bool triangles_are_cheaper =
      in_scale && SolidAngles::are_cheaper(mesh.triangles.size(), boundary.exterior_edges());
  if (options.summation == Summation::kTriangles || (cheapest && triangles_are_cheaper)) {
    auto triangles = std::make_unique<const SolidAngles>(mesh, boundary, options.level);
    if (!cheapest || !triangles->has_repeated_faces()) return triangles;
  }
  return std::make_unique<const Cone>(boundary, options.level);
}

}  // namespace

ScaledMesh::ScaledMesh(TriangleMesh mesh, const PowerOfTwo& scale, const EvaluatorOptions& options)
    : scale_(scale),
      inverse_(-scale.exponent()),
      options_(options),
      mesh_(in_scale(std::move(mesh), scale)),
      is_in_scale_(scale.exponent() != 0 || largest_exponent(mesh_) <= 0),
      boundary_(options.edges ? Boundary(mesh_, *options.edges) : Boundary(mesh_)),
      direct_(direct_engine(mesh_, boundary_, is_in_scale_, options)),
      choice_(options, {boundary_, mesh_.triangles.size(), counts_crossings(), is_in_scale_}),
      grid_choice_(mesh_.triangles.size()) {
  options_.edges = nullptr;
  if (options.ray_engine == RayEngine::kPasses) grid_choice_.rule_out();
}

TriangleMesh ScaledMesh::unscaled_mesh() const { return in_scale(mesh_, inverse_); }

const Box& ScaledMesh::box() const {
  return box_.get([this] { return bounding_box(mesh_); });
}

const RayCaster& ScaledMesh::rays() const {
  return rays_.get([this] { return RayCaster(mesh_); });
}

const ProjectedGrid& ScaledMesh::grid() const {
  return grid_.get([this] { return ProjectedGrid(mesh_); });
}

const SlabOrder& ScaledMesh::slab_order(int axis) const {
  return slab_orders_[static_cast<std::size_t>(axis - 1)].get([&] { return SlabOrder(mesh_, axis); });
}

const Caps& ScaledMesh::caps() const {
  constexpr double kNarrow = 0x1p-7;  // of the mesh's size: a voxel or some
  return caps_.get(
      [this] { return counts_crossings() ? make_caps(boundary_, kNarrow * longest_side(box())) : Caps(); });
}

const ChangeBound& ScaledMesh::change_bound() const {
  return change_bound_.get([this] { return ChangeBound(caps(), options_.level); });
}

const Blocks& ScaledMesh::blocks() const {
  return blocks_.get([this] {
    SolidFaces faces = solid_faces(counts_crossings() ? caps().mesh : mesh_);
    const auto near = counts_crossings() ? LatticeBlocks::Near::kBoundary : LatticeBlocks::Near::kTriangles;
    return Blocks{!faces.has_repeated_faces,
                  LatticeBlocks(std::move(faces.triangles), choice_.tolerance(), options_.level, near)};
  });
}

namespace {

// Larger than the mesh's, as points that are drawn for it often are.
Box box_for_points(const Box& box) {
  constexpr double kMargin = 0x1p-4;
  return widened(box, kMargin * longest_side(box));
}

}  // namespace

// Where the estimate says that it takes less time.
std::unique_ptr<const BlocksOfPoints> ScaledMesh::make_blocks_of_points() const {
  if (!choice_.blocks_of_points_may_pay() || !blocks().are_sound) return nullptr;
  std::unique_ptr<const BlocksOfPoints> result(new BlocksOfPoints{
      CapCrossings(caps().mesh), PointBlocks(blocks().sums, box_for_points(box()), options_.accuracy.points)});
  const double direct = choice_.direct_cost();
  const double other = has_far_field() ? std::min(direct, far_field()->cost()) : direct;
  return choice_.blocks_of_points_pay(result->sums.cost(), other) ? std::move(result) : nullptr;
}

const BlocksOfPoints* ScaledMesh::blocks_of_points() const {
  return blocks_of_points_.get([this] { return make_blocks_of_points(); }).get();
}

// The far field, where it is asked for and estimated to be cheaper.
std::unique_ptr<const FarField> ScaledMesh::make_far_field() const {
  if (!choice_.may_have_far_field()) return nullptr;
  std::unique_ptr<const FarField> far;
  const TriangleMesh* const sources = counts_crossings() ? &caps().mesh : nullptr;
  if (options_.accuracy.sides_only && choice_.has_rough_sums()) {  // they need the tree, too
    if (!blocks().are_sound) return nullptr;
    const LatticeBlocks& sums = blocks().sums;
    far = std::make_unique<const FarField>(mesh_, sources, sums.tree(), sums.tree_tolerance(), options_.level);
  } else {
    far = std::make_unique<const FarField>(mesh_, sources, choice_.tolerance_of_far_field(), options_.level);
  }
  return !far->has_repeated_faces() && choice_.far_field_pays(far->cost()) ? std::move(far) : nullptr;
}

const FarField* ScaledMesh::far_field() const {
  return far_.get([this] { return make_far_field(); }).get();
}

const FarField* ScaledMesh::far_field_without_waiting() const {
  if (!far_.if_built() && far_is_taken_.test_and_set()) return nullptr;
  return far_field();
}

bool ScaledMesh::has_far_field() const { return choice_.far_field_may_pay() && far_field() != nullptr; }

// Where nobody knows how many samples certificates leave, they are counted until there is a tree: so many take about as
// long as that.
// This may be asked within loops, where the tree is made by one thread: others do without it meanwhile.
const FarField* ScaledMesh::far_field_for(std::size_t samples) const {
  constexpr std::uint64_t kEnough = 4'000;
  if (options_.summation == Summation::kFarField) return far_field();
  if (!options_.accuracy.sides_only) return has_far_field() ? far_field() : nullptr;
  if (!far_.if_built() && samples_.load(std::memory_order_relaxed) < kEnough) {
    samples_.fetch_add(samples, std::memory_order_relaxed);
    return nullptr;
  }
  return far_field_without_waiting();
}

bool ScaledMesh::build_grid() const {
  try {
    (void)grid();
    return true;
  } catch (const std::bad_alloc&) {
    grid_choice_.rule_out();
    return false;
  }
}

void ScaledMesh::prepare_points(double points) const {
  if (!options_.accuracy.sides_only) (void)has_far_field();
  (void)blocks_of_points();
  if (options_.ray_engine == RayEngine::kEmbree) {
    (void)rays();
  } else if (!grid_.if_built() && grid_choice_.pays_for(points)) {
    (void)build_grid();
  }
}

QueryCrossing ScaledMesh::crossing(std::uint32_t triangle, const Vec3& q) const {
  const auto [a, b, c] = corners_of(mesh_, mesh_.triangles[triangle]);
  return triangle_crossing(a, b, c, q);
}

void ScaledMesh::set_values(SampleTile& samples, std::span<const std::int64_t> crossings, std::span<double> values,
                            Settling settling, std::span<const std::int64_t> of_closed) const {
  if (!direct_) {
    std::copy(crossings.begin(), crossings.end(), values.begin());
    return;
  }
  const FarField* const far = far_field_for(values.size());
  if (!far) {
    set_direct_values(samples, crossings, values, settling);
    return;
  }
  if (of_closed.empty() || !far->counts_crossings()) {
    far->winding_numbers(samples, crossings, values);
  } else {
    far->winding_numbers_of_closed(samples, of_closed, values);
  }
  if (settling == Settling::kDone) set_again_near_half_integers(samples, crossings, values, far->doubt());
}

void ScaledMesh::set_values(PointBlocks::Sums& sums, SampleTile& samples, std::span<const std::int64_t> crossings,
                            std::span<double> values, Settling settling) const {
  sums.evaluate(samples, values);
  if (counts_crossings()) {
    const std::array<std::int64_t, kTile> caps = blocks_of_points()->caps.of(samples);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] += static_cast<double>(crossings[i] - caps[i]);
  }
  if (settling == Settling::kDone) set_again_near_half_integers(samples, crossings, values, choice_.doubt_of_blocks());
}

void ScaledMesh::set_direct_values(SampleTile& samples, std::span<const std::int64_t> crossings,
                                   std::span<double> values, Settling settling) const {
  direct_->winding_numbers(samples, crossings, values);
  const std::size_t terms = direct_->counts_crossings() ? boundary_.exterior_edges() : mesh_.triangles.size();
  direct_terms_.fetch_add(values.size() * terms, std::memory_order_relaxed);
  if (settling == Settling::kLeft) return;
  std::array<Boundary::ToSettle, kTile> doubtful;
  std::size_t count = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (distance_to_half_integer(values[i]) > direct_->doubt()) continue;
    doubtful[count++] = {i, std::floor(values[i]) + 0.5};
  }
  if (count > 0) boundary_.settle(samples, {doubtful.data(), count}, values);
}

void ScaledMesh::bound_errors(SampleTile& samples, std::span<const double> values,
                              std::span<const std::int64_t> crossings, std::span<double> bounds) const {
  if (is_closed()) {
    std::ranges::fill(bounds, 0.0);
  } else {
    boundary_.bound_errors(samples, values, crossings, bounds);
  }
}

void ScaledMesh::set_again_near_half_integers(const SampleTile& samples, std::span<const std::int64_t> crossings,
                                              std::span<double> values, double doubt) const {
  std::array<std::size_t, kTile> indices;
  std::array<std::int64_t, kTile> crossings_here;
  std::array<double, kTile> values_here;
  SampleTile here;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (distance_to_half_integer(values[i]) > doubt) continue;
    indices[here.count] = i;
    crossings_here[here.count] = crossings[i];
    here.add(samples.query(i));
  }
  if (here.count == 0) return;
  set_direct_values(here, {crossings_here.data(), here.count}, {values_here.data(), here.count});
  for (std::size_t i = 0; i < here.count; ++i) values[indices[i]] = values_here[i];
}

ScaledMeshes::ScaledMeshes(TriangleMesh mesh, const EvaluatorOptions& options)
    : ScaledMeshes(unit_scale(mesh), std::move(mesh), options) {}

ScaledMeshes::ScaledMeshes(const PowerOfTwo& scale, TriangleMesh&& mesh, const EvaluatorOptions& options)
    : scaled_(std::move(mesh), scale, options) {}

const ScaledMesh& ScaledMeshes::unscaled() const {
  return unscaled_.get([this] {
    EvaluatorOptions options = scaled_.options();
    options.accuracy.tolerance = 0.0;  // few queries need this, and its coordinates may be of any size
    return ScaledMesh(scaled_.unscaled_mesh(), PowerOfTwo(0), options);
  });
}

}  // namespace raycone
