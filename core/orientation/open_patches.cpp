#include "core/orientation/open_patches.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/evaluation/winding_number.h"
#include "core/orientation/canonical_face.h"
#include "core/orientation/surface_samples.h"

namespace raycone {
namespace {

// Of a surface of its own vertices: where the winding number is evaluated, no other vertex counts.
TriangleMesh mesh_of(const std::vector<Triangle>& faces, const std::vector<Vec3>& vertices, bool reversed) {
  std::vector<std::uint32_t> used;
  for (const Triangle& t : faces) used.insert(used.end(), t.begin(), t.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  TriangleMesh mesh;
  for (const std::uint32_t v : used) mesh.vertices.push_back(vertices[v]);
  for (const Triangle& t : faces) {
    Triangle local;
    for (std::size_t i = 0; i < 3; ++i) {
      local[i] = static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), t[i]) - used.begin());
    }
    if (reversed) std::swap(local[1], local[2]);
    mesh.triangles.push_back(local);
  }
  return mesh;
}

// The sum over samples of weight (rest + sum over surfaces of turn * winding - 1/2)^2, to be made small.
class TurnProblem {
 public:
  TurnProblem(std::vector<std::vector<double>> windings, std::vector<double> constant, std::vector<double> weight)
      : windings_(std::move(windings)), constant_(std::move(constant)), weight_(std::move(weight)) {}

  // From no surface at all: each in turn gets the better sign.
  [[nodiscard]] std::vector<int> one_after_the_other() const {
    std::vector<double> rest = constant_;
    std::vector<int> turn(windings_.size(), 1);
    for (std::size_t p = 0; p < windings_.size(); ++p) {
      turn[p] = slope(p, rest) > 0.0 ? -1 : 1;
      add(p, turn[p], rest);
    }
    return turn;
  }

  // Turns surfaces as long as that makes the sum smaller. Returns the sum.
  double improve(std::vector<int>& turn) const {
    std::vector<double> rest = constant_;
    for (std::size_t p = 0; p < turn.size(); ++p) add(p, turn[p], rest);
    constexpr int kMaxPasses = 100;
    bool turned = true;
    for (int pass = 0; turned && pass < kMaxPasses; ++pass) {
      turned = false;
      for (std::size_t p = 0; p < turn.size(); ++p) {
        // The sum changes by 4 (own - turn slope).
        const double gain = turn[p] * slope(p, rest) - own(p);
        if (!(gain > kLeastGain)) continue;
        add(p, -2 * turn[p], rest);
        turn[p] = -turn[p];
        turned = true;
      }
    }
    double sum = 0.0;
    for (std::size_t k = 0; k < rest.size(); ++k) sum += weight_[k] * rest[k] * rest[k];
    return sum;
  }

 private:
  static constexpr double kLeastGain = 1e-9;  // of weights whose sum is 1: rounding gains nothing

  [[nodiscard]] double slope(std::size_t p, const std::vector<double>& rest) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < rest.size(); ++k) sum += weight_[k] * rest[k] * windings_[p][k];
    return sum;
  }
  [[nodiscard]] double own(std::size_t p) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < weight_.size(); ++k) sum += weight_[k] * windings_[p][k] * windings_[p][k];
    return sum;
  }
  void add(std::size_t p, double factor, std::vector<double>& rest) const {
    for (std::size_t k = 0; k < rest.size(); ++k) rest[k] += factor * windings_[p][k];
  }

  std::vector<std::vector<double>> windings_;  // per surface and sample: of the surface as it is
  std::vector<double> constant_;               // per sample: of what does not turn, less 1/2
  std::vector<double> weight_;
};

// A surface that may turn, in the orientation in which its first face runs around its corners by rising coordinates.
struct TurningSurface {
  std::size_t number;  // among all surfaces
  int sign;            // of the given orientation
  CanonicalFace first;
  std::vector<SurfaceSample> samples;
  double weight = 0.0;  // of its samples
};

std::size_t samples_per_surface(std::size_t surfaces) {
  constexpr std::size_t kSamples = 4096, kMost = 256, kLeast = 4;
  return std::clamp(kSamples / surfaces, kLeast, kMost);
}

// Large ones first.
std::vector<TurningSurface> in_order(const std::vector<OpenSurface>& surfaces, const std::vector<Vec3>& vertices) {
  std::vector<TurningSurface> ordered;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const CanonicalFace first = first_canonical_face(surfaces[i].faces, vertices);
    TurningSurface turning{i, first.sign, first, {}, 0.0};
    turning.samples = sample_surface(surfaces[i].faces, vertices, samples_per_surface(surfaces.size()));
    for (SurfaceSample& sample : turning.samples) {
      sample.side *= first.sign;
      turning.weight += sample.weight;
    }
    ordered.push_back(std::move(turning));
  }
  std::sort(ordered.begin(), ordered.end(), [](const TurningSurface& a, const TurningSurface& b) {
    return a.weight != b.weight ? a.weight > b.weight : a.first < b.first;
  });
  return ordered;
}

std::vector<double> winding_numbers(const std::vector<Triangle>& faces, const std::vector<Vec3>& vertices,
                                    bool reversed, const std::vector<Vec3>& points) {
  std::vector<double> values(points.size(), 0.0);
  if (faces.empty()) return values;
  WindingNumberEvaluator(mesh_of(faces, vertices, reversed)).evaluate(points, values);
  return values;
}

}  // namespace

std::vector<int> turn_open_surfaces(const std::vector<OpenSurface>& surfaces, const std::vector<Triangle>& closed,
                                    const std::vector<Vec3>& vertices) {
  const std::vector<TurningSurface> ordered = in_order(surfaces, vertices);
  const std::vector<SurfaceSample> of_closed = sample_surface(closed, vertices, samples_per_surface(1));
  std::vector<Vec3> points;
  std::vector<double> weight;
  const auto add_samples = [&](const std::vector<SurfaceSample>& samples) {
    for (const SurfaceSample& sample : samples) {
      points.push_back(sample.at);
      weight.push_back(sample.weight);
    }
  };
  for (const TurningSurface& surface : ordered) add_samples(surface.samples);
  const std::size_t first_of_closed = points.size();
  add_samples(of_closed);
  const double total = std::accumulate(weight.begin(), weight.end(), 0.0);
  for (double& w : weight) w /= total;

  // On its own samples a surface counts with the mean of both sides: half a turn off the value at the perturbed point.
  std::vector<double> constant = winding_numbers(closed, vertices, false, points);
  for (std::size_t k = 0; k < of_closed.size(); ++k) constant[first_of_closed + k] += 0.5 * of_closed[k].side;
  for (double& c : constant) c -= 0.5;
  std::vector<std::vector<double>> windings;
  std::size_t own = 0;
  for (const TurningSurface& surface : ordered) {
    std::vector<double> w = winding_numbers(surfaces[surface.number].faces, vertices, surface.sign < 0, points);
    for (const SurfaceSample& sample : surface.samples) w[own++] += 0.5 * sample.side;
    windings.push_back(std::move(w));
  }

  const TurnProblem problem(std::move(windings), std::move(constant), std::move(weight));
  std::vector<int> best(ordered.size(), 1);
  double least = problem.improve(best);
  std::vector<int> other = problem.one_after_the_other();
  if (const double sum = problem.improve(other); sum < least) best = other;
  std::vector<int> turn(surfaces.size());
  for (std::size_t i = 0; i < ordered.size(); ++i) turn[ordered[i].number] = best[i] * ordered[i].sign;
  return turn;
}

}  // namespace raycone
