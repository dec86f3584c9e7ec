#include "app/command_line/sample_options.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "app/command_line/lattice_options.h"
#include "app/text/parse_value.h"

namespace raycone {
namespace {

constexpr double kMaxSamples = 0x1p48;

std::optional<std::uint64_t> count_from(std::string_view text) {
  const std::optional<double> count = number_from(text);  // 1e6, too; all doubles up to the most are precise
  if (!count || *count < 1 || *count > kMaxSamples || std::trunc(*count) != *count) return std::nullopt;
  return static_cast<std::uint64_t>(*count);
}

// "uniform=N", "surface=N" or "near=N:SIGMA"
std::optional<SampleGroup> group_from(std::string_view text) {
  constexpr std::string_view kUniform = "uniform=", kSurface = "surface=", kNear = "near=";
  if (text.starts_with(kUniform)) {
    const std::optional<std::uint64_t> count = count_from(text.substr(kUniform.size()));
    return count ? std::optional<SampleGroup>(UniformSamples{*count}) : std::nullopt;
  }
  if (text.starts_with(kSurface)) {
    const std::optional<std::uint64_t> count = count_from(text.substr(kSurface.size()));
    return count ? std::optional<SampleGroup>(SurfaceSamples{*count}) : std::nullopt;
  }
  const std::size_t colon = text.find(':');
  if (!text.starts_with(kNear) || colon == std::string_view::npos) return std::nullopt;
  const std::optional<std::uint64_t> count = count_from(text.substr(kNear.size(), colon - kNear.size()));
  const std::optional<double> sigma = number_from(text.substr(colon + 1));
  if (!count || !sigma || *sigma < 0.0) return std::nullopt;
  return NearSamples{*count, *sigma};
}

WorldPadding parse_world_padding(const Values& values) {
  const auto padding = parse_padding(values.text("--padding"));
  if (const auto* const world = std::get_if<WorldPadding>(&padding)) return *world;
  invalid("--padding", values.text("--padding"),
          "a distance or a part of the longest side such as 5%, as there are no voxels");
}

}  // namespace

OptionGroup sample_group() {
  return {"Sampling",
          {{"--sample", "uniform=N|near=N:SIGMA|surface=N[,...]",
            "Draw N points in the box, about SIGMA box diagonals off the surface, or on it"},
           {"--seed", "S", "Seed of the random points (default: 1)"},
           {"--bounds", "X0,Y0,Z0,X1,Y1,Z1", "Box to draw points in (default: the bounding box of the mesh)"},
           {"--padding", "P|Q%", "Widen the box by P, or Q % of its longest side, on every side"}}};
}

std::optional<SampleRequest> parse_sample(const Values& values) {
  if (!values.given("--sample")) {
    for (const char* const name : {"--seed", "--bounds", "--padding"}) {
      if (values.given(name)) invalid(name, values.text(name), "--sample with it");
    }
    return std::nullopt;
  }
  SampleRequest request;
  const std::string text = values.text("--sample");
  for (const std::string_view item : items_of(text)) {
    const std::optional<SampleGroup> group = group_from(item);
    if (!group) {
      invalid("--sample", text,
              "uniform=N, near=N:SIGMA, surface=N or several, with commas between; N from 1 to 2^48 = 281474976710656");
    }
    request.groups.push_back(*group);
  }
  constexpr std::int64_t kMaxSeed = std::numeric_limits<std::int64_t>::max();
  if (values.given("--seed")) request.seed = static_cast<std::uint64_t>(values.integer("--seed", 0, kMaxSeed));
  if (values.given("--bounds")) request.bounds = parse_bounds(values.text("--bounds"));
  if (values.given("--padding")) request.padding = parse_world_padding(values);
  return request;
}

}  // namespace raycone
