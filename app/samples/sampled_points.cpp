#include "app/samples/sampled_points.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

#include "app/samples/lattice_choice.h"
#include "core/sampling/point_sampler.h"
#include "io/files/file_error.h"

namespace raycone {
namespace {

class SampledPoints final : public PointReader {
 public:
  SampledPoints(std::string name, PointSampler sampler, const SampleRequest& request, CoordinatePrecision precision)
      : name_(std::move(name)),
        sampler_(std::move(sampler)),
        precision_(precision),
        on_surface_(draws_on_surface(request)) {}

  bool next(std::vector<Vec3>& batch, std::size_t max) override {
    batch.resize(static_cast<std::size_t>(std::min<std::uint64_t>(max, sampler_.size() - drawn_)));
    faces_.resize(on_surface_ ? batch.size() : 0);
    if (on_surface_) {
      sampler_.draw(drawn_, batch, faces_);
    } else {
      sampler_.draw(drawn_, batch);
    }
    round_to(precision_, batch);
    if (precision_ == CoordinatePrecision::kSingle && !std::ranges::all_of(batch, is_finite))
      throw LimitError(name_ + ": points are too large for 32 bits; see --dtype and --scale");
    drawn_ += batch.size();
    return !batch.empty();
  }
  [[nodiscard]] SurfacePlaces places() override {
    normals_.resize(faces_.size());
    sampler_.set_normals(faces_, normals_);
    return {normals_, faces_};
  }
  [[nodiscard]] bool would_block() override { return false; }
  [[nodiscard]] std::optional<std::uint64_t> size() const override { return sampler_.size(); }

 private:
  std::string name_;  // of the mesh's file
  PointSampler sampler_;
  CoordinatePrecision precision_;
  bool on_surface_;
  std::vector<std::int64_t> faces_;
  std::vector<Vec3> normals_;
  std::uint64_t drawn_ = 0;
};

}  // namespace

bool draws_on_surface(const SampleRequest& request) {
  return std::ranges::any_of(request.groups,
                             [](const SampleGroup& group) { return std::holds_alternative<SurfaceSamples>(group); });
}

std::uint64_t points_around_mesh(const SampleRequest& request) {
  constexpr double kNear = 0.25;  // diagonals
  std::uint64_t points = 0;
  for (const SampleGroup& group : request.groups) {
    if (const auto* uniform = std::get_if<UniformSamples>(&group)) points += uniform->count;
    if (const auto* near = std::get_if<NearSamples>(&group); near && near->sigma <= kNear) points += near->count;
  }
  return points;
}

std::unique_ptr<PointReader> draw_points(const std::string& name, const TriangleMesh& mesh,
                                         const SampleRequest& request, CoordinatePrecision precision) {
  const Box box = widened(request.bounds.value_or(bounding_box(mesh)), request.padding);
  PointSampler sampler(mesh, box, request.groups, request.seed);
  if (!sampler.has_needed_area()) throw InputError(name + ": no triangle has an area, expected a surface to draw from");
  if (!sampler.is_finite())
    throw LimitError(name + ": box or noise is too large, expected points within double precision; see --scale");
  return std::make_unique<SampledPoints>(name, std::move(sampler), request, precision);
}

}  // namespace raycone
