#include "core/arrangement/rule_border.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "core/arrangement/arranged_patches.h"
#include "core/arrangement/arrangement.h"
#include "core/arrangement/winding_in_front.h"
#include "core/data/coordinate_precision.h"

namespace raycone {
namespace {

// Whether a patch belongs to the border, and which way it has to face.
enum class Place : std::uint8_t { kNowhere, kAsItIs, kTurned };

std::optional<std::vector<Place>> places_of(const ArrangedPatches& patches, Arrangement& arrangement,
                                            const TriangleMesh& mesh, const Rule& rule) {
  const std::optional<std::vector<std::int64_t>> fronts = windings_in_front(patches.largest, arrangement, mesh);
  if (!fronts) return std::nullopt;
  std::vector<Place> places;
  for (std::size_t n = 0; n < patches.largest.size(); ++n) {
    const std::int64_t front = (*fronts)[n];
    const bool holds_in_front = holds(rule, static_cast<double>(front));
    const bool holds_behind = holds(rule, static_cast<double>(front + arrangement.multiplicity(patches.largest[n])));
    places.push_back(holds_in_front == holds_behind ? Place::kNowhere : holds_behind ? Place::kAsItIs : Place::kTurned);
  }
  return places;
}

// Makes triangles of corners that are rounded, of which equal ones are one vertex.
class RoundedMesh {
 public:
  RoundedMesh(const Arrangement& arrangement, CoordinatePrecision precision)
      : arrangement_(arrangement), precision_(precision), vertex_of_(arrangement.corners(), kNone) {}

  void add(const Triangle& corners, std::uint32_t source) {
    Triangle t{};
    std::ranges::transform(corners, t.begin(), [&](std::uint32_t corner) { return vertex_of(corner); });
    if (is_collapsed(t)) return;
    border_.mesh.triangles.push_back(t);
    border_.sources.push_back(source);
  }
  [[nodiscard]] RuleBorder take() { return std::move(border_); }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  std::uint32_t vertex_of(std::uint32_t corner) {
    if (vertex_of_[corner] != kNone) return vertex_of_[corner];
    const Vec3 p = rounded(corner) + Vec3{0.0, 0.0, 0.0};  // without signs of zeros
    const auto next = static_cast<std::uint32_t>(border_.mesh.vertices.size());
    const auto [at, is_new] = at_place_.try_emplace({p.x, p.y, p.z}, next);
    if (is_new) border_.mesh.vertices.push_back(p);
    return vertex_of_[corner] = at->second;
  }

  [[nodiscard]] Vec3 rounded(std::uint32_t corner) const {
    return rounded_to(precision_, arrangement_.rounded(corner));
  }

  const Arrangement& arrangement_;
  CoordinatePrecision precision_;
  std::vector<std::uint32_t> vertex_of_;
  std::map<std::tuple<double, double, double>, std::uint32_t> at_place_;
  RuleBorder border_;
};

}  // namespace

std::optional<RuleBorder> rule_border(const TriangleMesh& mesh, const RuleBorderOptions& options) {
  std::optional<Arrangement> arrangement = Arrangement::of(mesh, options.most_pairs);
  if (!arrangement) return std::nullopt;
  const std::optional<ArrangedPatches> patches = patches_of(*arrangement);
  if (!patches) return std::nullopt;
  const std::optional<std::vector<Place>> places = places_of(*patches, *arrangement, mesh, options.rule);
  if (!places) return std::nullopt;
  RoundedMesh border(*arrangement, options.precision);
  for (std::size_t n = 0; n < arrangement->triangles().size(); ++n) {
    const Triangle& t = arrangement->triangles()[n];
    const Place place = (*places)[patches->of_triangle[n]];
    if (place == Place::kAsItIs) border.add(t, arrangement->source(n));
    if (place == Place::kTurned) border.add({t[0], t[2], t[1]}, arrangement->source(n));
  }
  return border.take();
}

}  // namespace raycone
