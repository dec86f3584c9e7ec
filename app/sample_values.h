// What is known of the samples of a slab or batch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/diagnostics.h"

namespace raycone {

// Bytes per sample that SampleValues takes.
constexpr std::size_t bytes_per_sample(bool with_diagnostics) {
  return sizeof(double) + (with_diagnostics ? 2 * sizeof(std::int64_t) + sizeof(std::uint8_t) + sizeof(double) : 0);
}

// Room for values, and for diagnostics where they are wanted.
class SampleValues {
 public:
  explicit SampleValues(bool with_diagnostics) {
    if (with_diagnostics) diagnostics_.emplace();
  }
  SampleValues(const SampleValues&) = delete;  // diagnostics_ refers to its vectors
  SampleValues& operator=(const SampleValues&) = delete;

  // What was obtained from here before is no longer valid.
  void resize(std::size_t count) {
    values_.resize(count);
    if (!diagnostics_) return;
    crossings_.resize(count);
    degenerate_.resize(count);
    on_surface_.resize(count);
    error_bound_.resize(count);
    *diagnostics_ = {crossings_, degenerate_, on_surface_, error_bound_};
  }

  [[nodiscard]] std::span<double> values() { return values_; }
  // Null where they are not wanted.
  [[nodiscard]] const Diagnostics* diagnostics() const { return diagnostics_ ? &*diagnostics_ : nullptr; }

 private:
  std::vector<double> values_;
  std::vector<std::int64_t> crossings_;
  std::vector<std::int64_t> degenerate_;
  std::vector<std::uint8_t> on_surface_;
  std::vector<double> error_bound_;
  std::optional<Diagnostics> diagnostics_;
};

}  // namespace raycone
