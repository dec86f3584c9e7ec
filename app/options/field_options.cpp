#include "app/options/field_options.h"

#include <algorithm>
#include <utility>

#include "app/text/parse_value.h"
#include "io/files/ascii.h"

namespace raycone {

bool FieldOptions::has(Field field) const { return std::ranges::count(fields, field) > 0; }

std::optional<Field> field_from_name(std::string_view name) {
  if (name == "winding") return Field::kWinding;
  if (name == "inside") return Field::kInside;
  if (name == "density") return Field::kDensity;
  if (name == "sdf") return Field::kDistance;
  if (name == "solid") return Field::kSolid;
  if (name == "gradient") return Field::kGradient;
  if (name == "label") return Field::kLabel;
  return std::nullopt;
}

bool FieldOptions::labels_only() const { return fields == std::vector{Field::kLabel}; }

bool FieldOptions::has_numbers() const {
  return std::ranges::any_of(fields, [](Field one) { return one != Field::kInside && one != Field::kLabel; });
}

bool FieldOptions::has_rule() const { return has(Field::kInside) || has_distance() || has(Field::kLabel); }

bool FieldOptions::rule_only() const { return !has(Field::kWinding) && !has(Field::kDensity) && !diagnostics; }

std::optional<Rule> rule_from_name(std::string_view name) {
  if (name == "nonzero") return Rule{RuleKind::kNonzero, 0.5};
  if (name == "positive") return Rule{RuleKind::kPositive, 0.5};
  if (name == "odd") return Rule{RuleKind::kOdd, 0.5};
  for (const auto& [prefix, kind] :
       {std::pair("threshold=", RuleKind::kThreshold), std::pair("abs=", RuleKind::kAbs)}) {
    if (!name.starts_with(prefix)) continue;
    const std::optional<double> threshold = number_from(name.substr(std::string_view(prefix).size()));
    return threshold ? std::optional(Rule{kind, *threshold}) : std::nullopt;
  }
  return std::nullopt;
}

std::string name_of(const Rule& rule) {
  switch (rule.kind) {
    case RuleKind::kNonzero:
      return "nonzero";
    case RuleKind::kPositive:
      return "positive";
    case RuleKind::kOdd:
      return "odd";
    case RuleKind::kThreshold:
    case RuleKind::kAbs:
      break;
  }
  return (rule.kind == RuleKind::kAbs ? "abs=" : "threshold=") + shortest_text(rule.threshold);
}

}  // namespace raycone
