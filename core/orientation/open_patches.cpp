#include "core/orientation/open_patches.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "core/machine/threads.h"
#include "core/orientation/canonical_face.h"
#include "core/orientation/crossing_votes.h"
#include "core/orientation/dipole_tree.h"
#include "core/orientation/ray_sums.h"
#include "core/orientation/sign_problem.h"
#include "core/orientation/surface_field.h"
#include "core/orientation/surface_samples.h"

namespace raycone {
namespace {

// Up to so many surfaces, each acts on every sample for itself. Beyond, only the largest do; others act on what is
// near, and from afar as dipoles of a tree.
constexpr std::size_t kFewSurfaces = 1500;
constexpr std::size_t kLargestSurfaces = 48;

// A face is large if it has several of so many parts of the area: each of them gets a sample then.
constexpr double kParts = 1024.0;

// Turned so that its first face runs around its corners by rising coordinates; by exact ones, as all of it may be in
// one place once it is moved.
struct TurningSurface {
  const std::vector<Triangle>* faces;
  std::size_t number;   // among the surfaces given
  CanonicalFace first;  // its sign: that of the orientation given
  std::vector<SurfaceSample> samples;
  double weight = 0.0;  // of its samples
};

}  // namespace

class OpenSurfaceTurner::Search {
 public:
  Search(const std::vector<OpenSurface>& surfaces, const NumberedVertices& vertices)
      : numbered_(vertices), vertices_(vertices.at) {
    set_order(surfaces);
    if (surfaces_.size() <= kFewSurfaces) divide_large_faces();
    for (const TurningSurface& surface : surfaces_) {
      first_sample_.push_back(samples_.size());
      samples_.insert(samples_.end(), surface.samples.begin(), surface.samples.end());
    }
    first_sample_.push_back(samples_.size());
  }

  // Per surface, in the order given.
  std::vector<int> turn(const std::vector<Triangle>& closed) {
    set_closed(closed);
    const std::vector<int> best = surfaces_.size() <= kFewSurfaces ? turn_few() : turn_many();
    std::vector<int> result(surfaces_.size());
    for (std::size_t i = 0; i < surfaces_.size(); ++i) result[surfaces_[i].number] = best[i] * surfaces_[i].first.sign;
    return result;
  }

 private:
  // Large ones first.
  void set_order(const std::vector<OpenSurface>& surfaces) {
    constexpr std::size_t kSamples = 4096, kMost = 64;
    const std::size_t each = std::clamp(kSamples / surfaces.size(), surfaces.size() <= kFewSurfaces ? 2UL : 1UL, kMost);
    surfaces_.resize(surfaces.size());
    parallel_for_each(surfaces.size(), 16, [&](std::size_t i) {
      const std::vector<Triangle>& faces = surfaces[i].faces;
      TurningSurface& turning = surfaces_[i];
      turning = {&faces, i, first_canonical_face(faces, numbered_.exact), sample_surface(faces, numbered_, each), 0.0};
      for (SurfaceSample& sample : turning.samples) {
        sample.side *= turning.first.sign;
        sample.face.sign *= turning.first.sign;
        turning.weight += sample.weight;
      }
    });
    std::sort(surfaces_.begin(), surfaces_.end(), [](const TurningSurface& a, const TurningSurface& b) {
      return a.weight != b.weight ? a.weight > b.weight : a.first < b.first;
    });
  }

  // What others do to a large face differs from place to place.
  void divide_large_faces() {
    double area = 0.0;
    for (const TurningSurface& surface : surfaces_) area += surface.weight;
    for (TurningSurface& surface : surfaces_) surface.samples = divided(surface.samples, area / kParts);
  }

  // Their samples are at the same places, however they are turned.
  void set_closed(const std::vector<Triangle>& closed) {
    constexpr std::size_t kOfClosed = 256;
    closed_ = &closed;
    samples_.resize(first_sample_.back());
    weight_.clear();
    std::vector<SurfaceSample> of_closed = sample_surface(closed, numbered_, kOfClosed);
    double area = 0.0;
    for (const SurfaceSample& sample : of_closed) area += sample.weight;
    of_closed = divided(of_closed, area / kParts);
    samples_.insert(samples_.end(), of_closed.begin(), of_closed.end());
    for (const SurfaceSample& sample : samples_) weight_.push_back(sample.weight);
    constant_.assign(samples_.size(), -0.5);
    if (closed.empty()) return;
    std::vector<Vec3> points;
    for (const SurfaceSample& sample : samples_) points.push_back(sample.at);
    // There is no boundary: crossings are all. On the faces themselves it is the mean of both sides.
    const std::vector<RaySum> sums = ray_sums(closed, vertices_, points);
    for (std::size_t k = 0; k < sums.size(); ++k) {
      constant_[k] += static_cast<double>(sums[k].winding) + (k < first_sample_.back() ? 0.0 : 0.5 * samples_[k].side);
    }
  }

  [[nodiscard]] bool is_own(std::size_t surface, std::size_t sample) const {
    return sample >= first_sample_[surface] && sample < first_sample_[surface + 1];
  }

  // What a surface does at samples.
  [[nodiscard]] std::vector<SignProblem::Effect> effects(std::size_t surface,
                                                         std::span<const std::uint32_t> samples) const {
    const SurfaceField field(*surfaces_[surface].faces, vertices_, surfaces_[surface].first.sign);
    std::vector<FieldPoint> points;
    for (const std::uint32_t k : samples) points.push_back({samples_[k].at, is_own(surface, k) ? samples_[k].side : 0});
    const std::vector<double> w = field.winding_numbers(points);
    std::vector<SignProblem::Effect> result;
    for (std::size_t i = 0; i < samples.size(); ++i) result.push_back({samples[i], static_cast<float>(w[i])});
    return result;
  }

  [[nodiscard]] std::vector<std::uint32_t> all_samples() const {
    std::vector<std::uint32_t> all(samples_.size());
    for (std::uint32_t k = 0; k < all.size(); ++k) all[k] = k;
    return all;
  }

  // With what each surface does at its samples; at most a thousand surfaces at once are in memory beside the problem.
  [[nodiscard]] SignProblem problem(const std::vector<std::vector<std::uint32_t>>& samples_of) const {
    constexpr std::size_t kAtOnce = 1024;
    SignProblem result(weight_);
    for (std::size_t first = 0; first < surfaces_.size(); first += kAtOnce) {
      const std::size_t count = std::min(kAtOnce, surfaces_.size() - first);
      std::vector<std::vector<SignProblem::Effect>> of_surface(count);
      parallel_for_each(count, [&](std::size_t i) { of_surface[i] = effects(first + i, samples_of[first + i]); });
      for (const auto& its : of_surface) result.add_surface(its);
    }
    return result;
  }

  [[nodiscard]] std::vector<int> turn_few() {
    if (!few_) few_ = problem(std::vector<std::vector<std::uint32_t>>(surfaces_.size(), all_samples()));
    std::vector<int> best(surfaces_.size(), 1);
    double least = few_->improve(constant_, best);
    std::vector<int> other = few_->one_after_the_other(constant_);
    if (few_->improve(constant_, other) < least) best = other;
    return best;
  }

  // Starts from what rays say. In each round, surfaces that are far count as they are turned then.
  [[nodiscard]] std::vector<int> turn_many() const {
    DipoleTree tree = far_tree();
    SignProblem near = problem(near_samples(tree));
    std::vector<int> best = voted();
    std::vector<double> rest = with_far(tree, best);
    double least = near.sum(rest, best);
    constexpr int kMaxRounds = 12;
    for (int round = 0; round < kMaxRounds; ++round) {
      std::vector<int> sign = best;
      near.improve(rest, sign);
      rest = with_far(tree, sign);
      const double sum = near.sum(rest, sign);
      if (!(sum < least)) break;
      least = sum;
      best = std::move(sign);
    }
    return best;
  }

  // The largest surfaces are near everywhere. Others are as small as it takes for few to be near a sample.
  [[nodiscard]] DipoleTree far_tree() const {
    constexpr std::size_t kTried = 256, kMostNear = 96;
    constexpr double kLeastReach = 0x1p-40;  // of the size of a mesh in scale
    std::vector<SurfaceDipole> dipoles(surfaces_.size());
    parallel_for_each(surfaces_.size(), 64, [&](std::size_t i) {
      dipoles[i] = dipole_of(*surfaces_[i].faces, vertices_, surfaces_[i].first.sign);
      if (i < kLargestSurfaces) dipoles[i].area = {};
    });
    // Samples may lie on the centres of many surfaces: to them all is far at last.
    for (double reach = 1.0;; reach = reach > kLeastReach ? reach / 2 : 0.0) {
      DipoleTree tree(dipoles, reach);
      if (reach == 0.0) return tree;
      std::size_t near = 0;
      const std::size_t step = samples_.size() / kTried + 1;
      for (std::size_t k = 0; k < samples_.size(); k += step) {
        tree.for_each_near(samples_[k].at, [&](std::uint32_t) { ++near; });
      }
      if (near <= kMostNear * (samples_.size() / step + 1)) return tree;
    }
  }

  // For each surface the samples that it is near.
  [[nodiscard]] std::vector<std::vector<std::uint32_t>> near_samples(const DipoleTree& tree) const {
    std::vector<std::vector<std::uint32_t>> near_surfaces(samples_.size());
    parallel_for_each(samples_.size(), 256, [&](std::size_t k) {
      tree.for_each_near(samples_[k].at, [&](std::uint32_t surface) {
        if (surface >= kLargestSurfaces && !is_own(surface, k)) near_surfaces[k].push_back(surface);
      });
    });
    std::vector<std::vector<std::uint32_t>> result(surfaces_.size(), std::vector<std::uint32_t>());
    for (std::size_t i = 0; i < kLargestSurfaces; ++i) result[i] = all_samples();
    for (std::size_t i = kLargestSurfaces; i < surfaces_.size(); ++i) {
      for (std::size_t k = first_sample_[i]; k < first_sample_[i + 1]; ++k)
        result[i].push_back(static_cast<std::uint32_t>(k));
    }
    for (std::uint32_t k = 0; k < samples_.size(); ++k) {
      for (const std::uint32_t surface : near_surfaces[k]) result[surface].push_back(k);
    }
    return result;
  }

  // constant_ and what surfaces do from afar; what one does to its own samples is not far.
  [[nodiscard]] std::vector<double> with_far(DipoleTree& tree, const std::vector<int>& sign) const {
    tree.set_signs(sign);
    std::vector<double> rest = constant_;
    parallel_for_each(samples_.size(), 256, [&](std::size_t k) { rest[k] += tree.far_sum(samples_[k].at); });
    for (std::uint32_t i = kLargestSurfaces; i < surfaces_.size(); ++i) {
      for (std::size_t k = first_sample_[i]; k < first_sample_[i + 1]; ++k) {
        rest[k] -= sign[i] * tree.far_part(i, samples_[k].at);
      }
    }
    return rest;
  }

  [[nodiscard]] std::vector<int> voted() const {
    std::vector<Triangle> all(*closed_);
    for (const TurningSurface& surface : surfaces_) all.insert(all.end(), surface.faces->begin(), surface.faces->end());
    const std::vector<double> votes = crossing_votes(all, vertices_, samples_);
    std::vector<int> sign;
    for (std::size_t i = 0; i < surfaces_.size(); ++i) {
      double sum = 0.0;
      for (std::size_t k = first_sample_[i]; k < first_sample_[i + 1]; ++k) sum += weight_[k] * votes[k];
      sign.push_back(sum < 0.0 ? -1 : 1);
    }
    return sign;
  }

  const NumberedVertices& numbered_;
  const std::vector<Vec3>& vertices_;  // its positions
  const std::vector<Triangle>* closed_ = nullptr;
  std::vector<TurningSurface> surfaces_;
  std::vector<SurfaceSample> samples_;  // by surface, then those of the closed faces
  std::vector<std::size_t> first_sample_;
  std::vector<double> weight_;
  std::vector<double> constant_;    // per sample: of the closed faces, less 1/2
  std::optional<SignProblem> few_;  // of all surfaces
};

OpenSurfaceTurner::OpenSurfaceTurner(const std::vector<OpenSurface>& surfaces, const NumberedVertices& vertices)
    : search_(std::make_unique<Search>(surfaces, vertices)) {}

OpenSurfaceTurner::~OpenSurfaceTurner() = default;

std::vector<int> OpenSurfaceTurner::turn(const std::vector<Triangle>& closed) { return search_->turn(closed); }

}  // namespace raycone
