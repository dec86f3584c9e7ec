#include "app/command_line/field_options.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/command_line/common_options.h"
#include "app/process/usage_error.h"
#include "app/text/parse_value.h"

namespace raycone {
namespace {

constexpr const char* kRules = "threshold=T, abs=T, nonzero, positive or odd";

// Infinite for "all".
double parse_band(const Values& values) {
  if (values.text("--band") == "all") return std::numeric_limits<double>::infinity();
  return values.positive("--band");
}

std::vector<Field> parse_fields(const Values& values) {
  std::vector<Field> fields;
  const std::string text = values.text("--field");
  for (const std::string_view name : items_of(text)) {
    const std::optional<Field> field = field_from_name(name);
    if (!field) invalid("--field", text, "one or more of winding, inside, density, sdf, solid, gradient, label");
    if (std::ranges::count(fields, *field) > 0) invalid("--field", text, "each field once");
    fields.push_back(*field);
  }
  return fields;
}

PartsBy parse_parts_by(const Values& values) {
  return values.choice<PartsBy>(
      "--parts", {{"file", PartsBy::kFile}, {"group", PartsBy::kGroup}, {"component", PartsBy::kComponent}});
}

RayEngine parse_engine(const Values& values) {
  return values.choice<RayEngine>(
      "--engine", {{"auto", RayEngine::kScan}, {"scan", RayEngine::kScan}, {"embree", RayEngine::kEmbree}});
}

SimdLevel parse_simd(const Values& values) {
  const auto level = values.choice<SimdLevel>("--simd", {{"auto", SimdLevel::kBest},
                                                         {"sse4", SimdLevel::kSse4},
                                                         {"avx2", SimdLevel::kAvx2},
                                                         {"avx512", SimdLevel::kAvx512}});
  if (!is_available(level)) invalid("--simd", values.text("--simd"), "a level that this processor has");
  return level;
}

}  // namespace

OptionGroup field_group() {
  return {"Field",
          {{"--field", "winding|inside|density|sdf|solid|gradient|label[,...]",
            "winding: winding number (default); inside: mask; density: winding number clamped to 0..1; sdf: signed "
            "distance to the faces; solid: signed distance to the surface that raycone surface makes; gradient: of the "
            "winding number; label: number of the part that a sample is in",
            true},
           parts_option(),
           priority_option(),
           rule_option(),
           {"--band", "B",
            "Cut sdf and solid off at B voxels (default: 3); the lattice grows by B + 1 voxels on every side. all: "
            "nowhere"},
           tolerance_option(),
           {"--diagnostics", "", "Add crossings, degenerate, on_surface and error_bound; slow for open meshes"},
           {"--verify", "N",
            "Compute N samples again, by definition in 113 bits: 2.7 us per triangle and sample, 9 us with a gradient"},
           {"--engine", "auto|scan|embree", "How to find crossings; for tests, as values do not depend on it"},
           {"--simd", "auto|sse4|avx2|avx512", "Instructions to use; for tests, as values do not depend on them"}}};
}

OptionSpec rule_option() {
  return {"--rule", "threshold=T|abs=T|nonzero|positive|odd", "What counts as inside (default: threshold=0.5)"};
}

OptionSpec parts_option() {
  return {"--parts", "file|group|component",
          "What a part is, for label: a MESH (default; not in a batch), a group in a mesh, or a connected component"};
}

OptionSpec priority_option() {
  return {"--priority", "", "Where parts overlap, label is the first of them, not the last"};
}

OptionGroup points_field_group() {
  OptionGroup group = field_group();
  std::erase_if(group.options, [](const OptionSpec& option) { return option.names == "--band"; });
  OptionSpec& field = group.options.front();
  field.value = "winding|inside|density|sdf|gradient|label[,...]";
  field.description =
      "winding: winding number (default; with --sample winding,inside,sdf); inside: mask; density: winding number "
      "clamped to 0..1; sdf: signed distance to the faces; gradient: of the winding number; label: number of the part "
      "that a point is in";
  return group;
}

void refuse_solid() {
  throw UsageError(
      "--field solid: is the distance to a surface between samples of a lattice, expected raycone lattice, "
      "or --field sdf");
}

OptionSpec tolerance_option() {
  return {"--tolerance", "T",
          "Leave out at most T of a winding number (default: 1e-10); 0: nothing. Rounding comes on top"};
}

double parse_tolerance(const Values& values) {
  const std::string text = values.text("--tolerance");
  const std::optional<double> tolerance = number_from(text);
  if (!tolerance || *tolerance < 0.0) invalid("--tolerance", text, "0 or a positive number of turns");
  return *tolerance;
}

Rule parse_rule(const Values& values) {
  const std::optional<Rule> rule = rule_from_name(values.text("--rule"));
  if (!rule) invalid("--rule", values.text("--rule"), kRules);
  return *rule;
}

MeshOptions parse_meshes(const Values& values, const FieldOptions& field) {
  MeshOptions mesh = parse_mesh(values);
  if (values.given("--parts")) mesh.parts.by = parse_parts_by(values);
  if (values.given("--priority")) mesh.parts.priority = PartPriority::kFirst;
  if (!mesh.further.empty() && !field.has(Field::kLabel)) {
    throw UsageError("unexpected operand " + mesh.further.front() + ", expected one mesh, or --field label");
  }
  const auto is_no_name = [](const std::string& path) { return path.empty() || path == "@"; };
  if (field.has(Field::kLabel) && (is_no_name(mesh.path) || std::ranges::any_of(mesh.further, is_no_name))) {
    throw UsageError("MESH: expected a file, not an empty name");
  }
  return mesh;
}

FieldOptions parse_field(const Values& values) {
  FieldOptions options;
  if (values.given("--field")) options.fields = parse_fields(values);
  if (values.given("--rule")) options.rule = parse_rule(values);
  if (values.given("--band")) options.band = parse_band(values);
  if (values.given("--engine")) options.engine = parse_engine(values);
  if (values.given("--simd")) options.simd = parse_simd(values);
  if (values.given("--tolerance")) options.tolerance = parse_tolerance(values);
  options.diagnostics = values.given("--diagnostics");
  constexpr std::int64_t kMaxVerified = 1'000'000'000;
  if (values.given("--verify")) {
    options.verify = static_cast<std::uint64_t>(values.integer("--verify", 1, kMaxVerified));
  }
  return options;
}

}  // namespace raycone
