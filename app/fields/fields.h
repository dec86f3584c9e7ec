// The fields of a run: what files say of them, and room for their numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "app/options/field_options.h"
#include "core/data/diagnostics.h"
#include "core/data/distance_blocks.h"
#include "core/data/placed_lattice.h"
#include "io/fields/field_writer.h"

namespace raycone {

// What is written of each sample, in this order: the fields, then crossings, degenerate, on_surface and error_bound
// where diagnostics are wanted. `band_width`: where distances are cut off, in world units.
[[nodiscard]] std::vector<FieldDescription> describe_fields(const FieldOptions& options, double band_width);

// Whether samples of a lattice may have distances in blocks: where nothing is asked for but these.
[[nodiscard]] bool may_use_blocks(const FieldOptions& options);

// Numbers of some samples; those of fields that are not wanted are missing.
struct SampleNumbers {
  std::span<const double> winding{};  // empty where only the rule is asked for
  std::span<const std::uint8_t> inside{};
  std::span<const double> density{};
  std::span<const double> distance{};  // signed
  std::span<const double> solid{};     // likewise
  std::span<const Vec3> gradient{};
  std::span<const std::int32_t> label{};
};

// Room for all numbers of a slab or batch of samples.
class FieldSamples {
 public:
  explicit FieldSamples(const FieldOptions& options);
  FieldSamples(const FieldSamples&) = delete;  // fields_ and diagnostics_ refer to its vectors
  FieldSamples& operator=(const FieldSamples&) = delete;

  [[nodiscard]] static std::size_t bytes_per_sample(const FieldOptions& options);

  // From now on, there are distance_blocks() in place of distances(). Precondition: may_use_blocks().
  void use_blocks() { uses_blocks_ = true; }

  // What derive() begins with.
  enum class From { kWindingNumbers, kSides };

  // What was obtained from here before is no longer valid.
  void resize(std::size_t count, From from);

  // Empty where derive() begins with sides.
  [[nodiscard]] std::span<double> winding_numbers() { return winding_numbers_; }
  // Whether the rule holds for each sample, 1, or not, 0. Empty where there is none.
  [[nodiscard]] std::span<std::uint8_t> sides() { return sides_; }
  // Unsigned until derive(). Empty where they are not wanted.
  [[nodiscard]] std::span<double> distances() { return distances_; }
  // Null where distances() take their place. Unsigned, also after derive().
  [[nodiscard]] DistanceBlocks* distance_blocks() { return uses_blocks_ ? &blocks_ : nullptr; }
  // Those to the closed surface, likewise.
  [[nodiscard]] std::span<double> solid_distances() { return solid_distances_; }
  // Empty where they are not wanted.
  [[nodiscard]] std::span<Vec3> gradients() { return gradients_; }
  // Likewise. Nothing here sets them: they are about other meshes, the parts.
  [[nodiscard]] std::span<std::int32_t> labels() { return labels_; }
  // Null where they are not wanted.
  [[nodiscard]] const Diagnostics* diagnostics() const { return diagnostics_ ? &*diagnostics_ : nullptr; }

  // Computes the fields that follow from winding_numbers() or sides(), and the signs of distances. Threaded.
  void derive();

  // From the order of the world's axes to that of the indices of a block. What was obtained from here before is no
  // longer valid. Threaded.
  void to_index_order(const WorldOrder& order, const LatticeBlock& indices);

  // After derive().
  [[nodiscard]] SampleNumbers numbers() const {
    const bool inside = options_.has(Field::kInside);
    return {options_.rule_only() ? std::span<const double>() : winding_numbers_,
            inside ? sides_ : std::span<const std::uint8_t>(),
            density_,
            distances_,
            solid_distances_,
            gradients_};
  }

  // After derive(), for pictures: the winding numbers; where only the rule is asked for, 1 inside and 0 outside.
  [[nodiscard]] std::vector<double> shown() const;

  // As describe_fields() lists them.
  [[nodiscard]] std::span<const FieldValues> fields() const { return fields_; }

 private:
  // Calls visit(numbers, are_wanted) for all but winding numbers, which depend on what derive() begins with.
  template <typename Visit>
  void visit_numbers(const Visit& visit);
  [[nodiscard]] FieldValues values_of(Field field) const;
  void find_fields();

  FieldOptions options_;
  bool uses_blocks_ = false;
  DistanceBlocks blocks_;
  std::vector<double> winding_numbers_;
  std::vector<std::uint8_t> sides_;
  std::vector<double> density_;
  std::vector<double> distances_;
  std::vector<double> solid_distances_;
  std::vector<Vec3> gradients_;
  std::vector<std::int32_t> labels_;
  std::vector<std::int64_t> crossings_;
  std::vector<std::int64_t> degenerate_;
  std::vector<std::uint8_t> on_surface_;
  std::vector<double> error_bound_;
  std::optional<Diagnostics> diagnostics_;
  std::vector<FieldValues> fields_;
};

}  // namespace raycone
