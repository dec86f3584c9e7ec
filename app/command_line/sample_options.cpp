#include "app/command_line/sample_options.h"

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "app/command_line/lattice_options.h"
#include "app/text/parse_value.h"

namespace raycone {
namespace {

constexpr std::int64_t kMaxSamples = std::int64_t{1} << 48;

std::optional<std::uint64_t> count_from(std::string_view text) {
  const std::optional<std::int64_t> count = integer_from(text);
  if (!count || *count < 1 || *count > kMaxSamples) return std::nullopt;
  return static_cast<std::uint64_t>(*count);
}

// "uniform=N" or "near=N:SIGMA"
std::optional<SampleGroup> group_from(std::string_view text) {
  constexpr std::string_view kUniform = "uniform=", kNear = "near=";
  if (text.starts_with(kUniform)) {
    const std::optional<std::uint64_t> count = count_from(text.substr(kUniform.size()));
    return count ? std::optional<SampleGroup>(UniformSamples{*count}) : std::nullopt;
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
  invalid("--padding", values.text("--padding"), "a distance, as there are no voxels");
}

}  // namespace

OptionGroup sample_group() {
  return {"Sampling",
          {{"--sample", "uniform=N|near=N:SIGMA[,...]",
            "Draw N points in the box, or N about SIGMA box diagonals off the surface"},
           {"--seed", "S", "Seed of the random points (default: 1)"},
           {"--bounds", "X0,Y0,Z0,X1,Y1,Z1", "Box to draw points in (default: the bounding box of the mesh)"},
           {"--padding", "P", "Widen the box by P on every side"}}};
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
    if (item.starts_with("surface=")) not_available("--sample " + text);
    if (!group) invalid("--sample", text, "uniform=N, near=N:SIGMA or several of them, with commas between");
    request.groups.push_back(*group);
  }
  constexpr std::int64_t kMaxSeed = std::numeric_limits<std::int64_t>::max();
  if (values.given("--seed")) request.seed = static_cast<std::uint64_t>(values.integer("--seed", 0, kMaxSeed));
  if (values.given("--bounds")) request.bounds = parse_bounds(values.text("--bounds"));
  if (values.given("--padding")) request.padding = parse_world_padding(values);
  return request;
}

}  // namespace raycone
