#include "app/fields/fields.h"

#include <algorithm>

#include "core/machine/threads.h"

namespace raycone {
namespace {

// Samples per task of loops that do next to nothing for each.
constexpr std::size_t kGrain = std::size_t{1} << 14;

FieldDescription describe_field(Field field, const Rule& rule, double band_width) {
  FieldDescription description;
  switch (field) {
    case Field::kWinding:
      break;
    case Field::kInside:
      description = {"inside", "inside", "inside", FieldKind::kFlag, holds(rule, 0.0) ? 1.0 : 0.0, {}};
      break;
    case Field::kDensity:
      description = {"density", "density", "density", FieldKind::kDensity, 0.0, {}};
      break;
    case Field::kDistance:
      description = {"sdf", "sdf", "surface", FieldKind::kDistance, band_width, {}};
      break;
    case Field::kSolid:
      description = {"solid", "solid", "solid", FieldKind::kDistance, band_width, {}};
      break;
    case Field::kGradient:
      description = {"gradient", "gradient_x,gradient_y,gradient_z", "gradient", FieldKind::kVector, 0.0, {}};
      break;
    case Field::kLabel:
      description = {"label", "label", "label", FieldKind::kLabel, 0.0, {}};
      break;
  }
  description.rule = name_of(rule);
  description.threshold = rule.threshold;
  description.threshold_of_magnitude = rule.kind == RuleKind::kAbs;
  return description;
}

std::vector<FieldDescription> describe_diagnostics(const Rule& rule) {
  std::vector<FieldDescription> descriptions;
  constexpr std::array kKinds{FieldKind::kCount, FieldKind::kCount, FieldKind::kFlag, FieldKind::kBound};
  for (std::size_t n = 0; n < kDiagnosticNames.size(); ++n) {
    const char* const name = kDiagnosticNames[n];
    descriptions.push_back({name, name, name, kKinds[n], 0.0, name_of(rule)});
  }
  return descriptions;
}

// Also where nothing at all is asked of winding numbers: pictures show sides then.
bool has_sides(const FieldOptions& options) { return options.has_rule() || options.rule_only(); }

// Empty numbers stay so.
template <typename Number>
void reorder(std::vector<Number>& numbers, const WorldOrder::Walk& walk, const LatticeBlock& indices) {
  if (numbers.empty()) return;
  std::vector<Number> result(numbers.size());
  const auto [nx, ny, nz] = indices.counts;
  const auto rows = static_cast<std::size_t>(ny * nz);
  parallel_for(rows, kGrain / static_cast<std::size_t>(nx) + 1,
               [&, nx = nx, ny = ny](std::size_t begin, std::size_t end) {
                 for (auto row = static_cast<std::int64_t>(begin); row < static_cast<std::int64_t>(end); ++row) {
                   const std::int64_t from = walk.start + row / ny * walk.strides[2] + row % ny * walk.strides[1];
                   for (std::int64_t i = 0; i < nx; ++i) {
                     result[static_cast<std::size_t>(row * nx + i)] =
                         numbers[static_cast<std::size_t>(from + i * walk.strides[0])];
                   }
                 }
               });
  numbers.swap(result);
}

}  // namespace

std::vector<FieldDescription> describe_fields(const FieldOptions& options, double band_width) {
  std::vector<FieldDescription> descriptions;
  for (const Field field : options.fields) descriptions.push_back(describe_field(field, options.rule, band_width));
  if (!options.diagnostics) return descriptions;
  const std::vector<FieldDescription> diagnostics = describe_diagnostics(options.rule);
  descriptions.insert(descriptions.end(), diagnostics.begin(), diagnostics.end());
  return descriptions;
}

bool may_use_blocks(const FieldOptions& options) {
  return options.fields == std::vector{Field::kDistance} && !options.diagnostics;
}

FieldSamples::FieldSamples(const FieldOptions& options) : options_(options) {
  if (options.diagnostics) diagnostics_.emplace();
}

template <typename Visit>
void FieldSamples::visit_numbers(const Visit& visit) {
  visit(sides_, has_sides(options_));
  visit(density_, options_.has(Field::kDensity));
  visit(distances_, options_.has(Field::kDistance) && !uses_blocks_);
  visit(solid_distances_, options_.has(Field::kSolid));
  visit(gradients_, options_.has(Field::kGradient));
  visit(labels_, options_.has(Field::kLabel));
  visit(crossings_, options_.diagnostics);
  visit(degenerate_, options_.diagnostics);
  visit(on_surface_, options_.diagnostics);
  visit(error_bound_, options_.diagnostics);
}

std::size_t FieldSamples::bytes_per_sample(const FieldOptions& options) {
  std::size_t bytes = sizeof(double);  // the winding number, or what takes its place
  FieldSamples(options).visit_numbers(
      [&](const auto& numbers, bool are_wanted) { bytes += are_wanted ? sizeof numbers[0] : 0; });
  return bytes;
}

FieldValues FieldSamples::values_of(Field field) const {
  switch (field) {
    case Field::kWinding:
      break;
    case Field::kInside:
      return std::span(sides_);
    case Field::kDensity:
      return std::span(density_);
    case Field::kDistance:
      return std::span(distances_);
    case Field::kSolid:
      return std::span(solid_distances_);
    case Field::kGradient:
      return std::span<const Vec3>(gradients_);
    case Field::kLabel:
      return std::span<const std::int32_t>(labels_);
  }
  return std::span(winding_numbers_);
}

void FieldSamples::resize(std::size_t count, From from) {
  winding_numbers_.resize(from == From::kWindingNumbers ? count : 0);
  visit_numbers([&](auto& numbers, bool are_wanted) { numbers.resize(are_wanted ? count : 0); });
  find_fields();
}

void FieldSamples::find_fields() {
  fields_.clear();
  for (const Field field : options_.fields) fields_.push_back(values_of(field));
  if (!diagnostics_) return;
  *diagnostics_ = {crossings_, degenerate_, on_surface_, error_bound_};
  fields_.insert(fields_.end(), {std::span<const std::int64_t>(crossings_), std::span<const std::int64_t>(degenerate_),
                                 std::span<const std::uint8_t>(on_surface_), std::span<const double>(error_bound_)});
}

void FieldSamples::to_index_order(const WorldOrder& order, const LatticeBlock& indices) {
  const WorldOrder::Walk walk = order.walk(indices);
  reorder(winding_numbers_, walk, indices);
  visit_numbers([&](auto& numbers, bool /*are_wanted*/) { reorder(numbers, walk, indices); });
  find_fields();  // where they are now
}

std::vector<double> FieldSamples::shown() const {
  return options_.rule_only() ? std::vector<double>(sides_.begin(), sides_.end()) : winding_numbers_;
}

void FieldSamples::derive() {
  const std::size_t count = std::max(winding_numbers_.size(), sides_.size());
  const bool sides = options_.has_rule() && !winding_numbers_.empty();
  parallel_for(count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; sides && n < end; ++n) sides_[n] = holds(options_.rule, winding_numbers_[n]) ? 1 : 0;
    for (std::size_t n = begin; !density_.empty() && n < end; ++n) {
      density_[n] = std::clamp(winding_numbers_[n], 0.0, 1.0);
    }
    for (std::vector<double>* const distances : {&distances_, &solid_distances_}) {
      if (distances->empty()) continue;
      double* const numbers = distances->data();  // which lets the compiler take several at once
      for (std::size_t n = begin; n < end; ++n) numbers[n] = sides_[n] != 0 ? -numbers[n] : numbers[n];
    }
  });
}

}  // namespace raycone
