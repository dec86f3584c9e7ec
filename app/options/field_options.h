// What is evaluated, and the names that users have for it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/data/rule.h"
#include "core/evaluation/winding_number.h"
#include "core/machine/simd.h"

namespace raycone {

enum class Field {
  kWinding,
  kInside,    // whether the rule holds
  kDensity,   // the winding number, clamped to [0, 1]
  kDistance,  // to the triangles, signed: negative inside
  kSolid,     // likewise, to the closed surface that `raycone surface` makes of the lattice
  kGradient,  // of the winding number, beside its jumps
  kLabel,     // which part the rule holds for
};

// "winding", "inside", "density", "sdf", "solid", "gradient" or "label".
[[nodiscard]] std::optional<Field> field_from_name(std::string_view name);

// As on the command line: "threshold=0.5", "abs=1", "nonzero", "positive" or "odd".
[[nodiscard]] std::optional<Rule> rule_from_name(std::string_view name);
[[nodiscard]] std::string name_of(const Rule& rule);

// Of what diagnostics add to each sample; their names in all formats.
inline constexpr std::array kDiagnosticNames{"crossings", "degenerate", "on_surface", "error_bound"};

struct FieldOptions {
  std::vector<Field> fields{Field::kWinding};  // at least one, none twice
  Rule rule;
  double band = 3.0;  // voxels; of distances on lattices; infinite: they are not cut off
  bool diagnostics = false;
  double tolerance = 1e-10;             // of winding numbers, turns; 0: direct sums
  std::uint64_t verify = 0;             // samples to be computed again by definition
  RayEngine engine = RayEngine::kScan;  // no value depends on these two
  SimdLevel simd = SimdLevel::kBest;

  [[nodiscard]] bool has(Field field) const;
  // Whether a field is cut off at the band.
  [[nodiscard]] bool has_distance() const { return has(Field::kDistance) || has(Field::kSolid); }

  // Whether the mesh as a whole is not asked about.
  [[nodiscard]] bool labels_only() const;

  // Whether a field is of real numbers, whose precision can be chosen.
  [[nodiscard]] bool has_numbers() const;

  // Whether a field depends on the rule.
  [[nodiscard]] bool has_rule() const;

  // Whether of winding numbers nothing is asked but whether the rule holds.
  [[nodiscard]] bool rule_only() const;
};

}  // namespace raycone
