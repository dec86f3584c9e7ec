#include "app/command_line/idle_options.h"

#include <algorithm>
#include <string>
#include <variant>

#include "app/process/usage_error.h"

namespace raycone {
namespace {

void refuse_flag(const Values& values, const std::string& name, const std::string& because) {
  if (values.given(name)) throw UsageError(name + ": has no effect " + because);
}

// Says the value that the option was given, too.
void refuse_option(const Values& values, const std::string& name, const std::string& because) {
  if (values.given(name)) throw UsageError(name + ' ' + values.text(name) + ": has no effect " + because);
}

constexpr const char* kNoDigits = "on inside and label, which are no real numbers, expected another field";

constexpr const char* kOnCsv = "on CSV, which holds all digits, expected another format";

bool draws_in_box(const SampleRequest& request) {
  return std::ranges::any_of(request.groups,
                             [](const SampleGroup& group) { return std::holds_alternative<UniformSamples>(group); });
}

void refuse_idle_dtype(const Values& values, const FieldEncoding& encoding, bool has_numbers) {
  if (is_text(encoding.format)) refuse_option(values, "--dtype", kOnCsv);
  if (!has_numbers) refuse_option(values, "--dtype", kNoDigits);
}

void refuse_idle_pack_bits(const Values& values, const FieldEncoding& encoding, const FieldOptions& field) {
  if (encoding.format != FieldFormat::kNpz) refuse_flag(values, "--pack-bits", "on this format, expected npz");
  if (!field.has(Field::kInside)) refuse_flag(values, "--pack-bits", "without --field inside");
}

}  // namespace

void refuse_idle_rule(const Values& values, const FieldOptions& field, const char* expected) {
  if (field.has_rule()) return;
  refuse_option(values, "--rule", std::string("on winding, density and gradient, expected --field ") + expected);
}

void refuse_idle_parts(const Values& values, const FieldOptions& field) {
  if (field.labels_only()) refuse_flag(values, "--diagnostics", "on labels, expected another field with them");
  if (field.has(Field::kLabel)) return;
  refuse_option(values, "--parts", "without labels, expected --field label");
  refuse_flag(values, "--priority", "without labels, expected --field label");
}

void refuse_idle_depfile(const Values& values, const OutputFiles& output) {
  if (output.path == "-") refuse_option(values, "--depfile", "on standard output, expected -o FILE");
}

void refuse_idle_options(const Values& values, const LatticeCommand& command) {
  refuse_idle_dtype(values, command.encoding, command.field.has_numbers());
  refuse_idle_pack_bits(values, command.encoding, command.field);
  refuse_idle_rule(values, command.field, "inside, sdf, solid or label");
  refuse_idle_parts(values, command.field);
  refuse_idle_depfile(values, command.output);
  if (!command.field.has_distance()) {
    refuse_option(values, "--band", "without a distance, expected --field sdf or solid");
  }
  if (is_text(command.encoding.format)) refuse_flag(values, "--double", kOnCsv);
  for (const char* const name : {"--double", "--half"}) {
    if (!command.field.has_numbers()) refuse_flag(values, name, kNoDigits);
  }
}

void refuse_idle_options(const Values& values, const PointsCommand& command) {
  const bool stores_points = command.sample.has_value();
  refuse_idle_dtype(values, command.encoding, command.field.has_numbers() || stores_points);
  refuse_idle_pack_bits(values, command.encoding, command.field);
  refuse_idle_rule(values, command.field, "inside, sdf or label");
  refuse_idle_parts(values, command.field);
  refuse_idle_depfile(values, command.output);
  refuse_option(values, "--band", "on distances at points, which are not cut off");
  if (!command.sample || draws_in_box(*command.sample)) return;
  for (const char* const name : {"--bounds", "--padding"}) {
    refuse_option(values, name, "on points on or near the surface, expected --sample uniform=N");
  }
}

void refuse_options_of_outputs(const Values& values) {
  const std::string because = "with --format none, which writes no files";
  for (const char* const name : {"--double", "--half", "--full-names", "--pack-bits", "--compress"})
    refuse_flag(values, name, because);
  for (const char* const name : {"--grid-name", "--dtype"}) refuse_option(values, name, because);
}

}  // namespace raycone
