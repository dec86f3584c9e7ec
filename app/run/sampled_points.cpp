#include "app/run/sampled_points.h"

#include <algorithm>
#include <utility>

#include "app/run/lattice_choice.h"
#include "core/sampling/point_sampler.h"
#include "io/files/file_error.h"

namespace raycone {
namespace {

class SampledPoints final : public PointReader {
 public:
  explicit SampledPoints(PointSampler sampler) : sampler_(std::move(sampler)) {}

  bool next(std::vector<Vec3>& batch, std::size_t max) override {
    batch.resize(static_cast<std::size_t>(std::min<std::uint64_t>(max, sampler_.size() - drawn_)));
    sampler_.draw(drawn_, batch);
    drawn_ += batch.size();
    return !batch.empty();
  }
  [[nodiscard]] bool would_block() const override { return false; }
  [[nodiscard]] std::optional<std::uint64_t> size() const override { return sampler_.size(); }

 private:
  PointSampler sampler_;
  std::uint64_t drawn_ = 0;
};

}  // namespace

std::unique_ptr<PointReader> draw_points(const std::string& name, const TriangleMesh& mesh,
                                         const SampleRequest& request) {
  const Box box = widened(request.bounds.value_or(bounding_box(mesh)), request.padding.width);
  PointSampler sampler(mesh, box, request.groups, request.seed);
  const bool near = std::ranges::any_of(
      request.groups, [](const SampleGroup& group) { return std::holds_alternative<NearSamples>(group); });
  if (near && !sampler.has_area())
    throw InputError(name + ": no triangle has an area, expected a surface to draw from");
  if (!sampler.is_finite()) throw LimitError("box or noise is too large for double precision; see --scale");
  return std::make_unique<SampledPoints>(std::move(sampler));
}

}  // namespace raycone
