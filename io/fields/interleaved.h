// Fields at points as rows of a table.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <type_traits>
#include <variant>
#include <vector>

#include "io/fields/field_writer.h"

namespace raycone {

// A row per sample: the numbers of each field, as element(its index, number).
template <typename Element, typename Convert>
[[nodiscard]] std::vector<Element> interleaved(std::span<const FieldValues> fields, std::size_t samples,
                                               const Convert& element) {
  const auto has_vectors = [](const FieldValues& field) {
    return std::holds_alternative<std::span<const Vec3>>(field);
  };
  const auto vectors = static_cast<std::size_t>(std::ranges::count_if(fields, has_vectors));
  const std::size_t width = fields.size() + 2 * vectors;
  std::vector<Element> elements(width * samples);
  std::size_t column = 0;
  for (std::size_t f = 0; f < fields.size(); ++f) {
    const auto store = [&](const auto& numbers) {
      for (std::size_t n = 0; n < samples; ++n) {
        Element* const at = &elements[n * width + column];
        if constexpr (std::is_same_v<std::decay_t<decltype(numbers[n])>, Vec3>) {
          for (int axis = 0; axis < 3; ++axis) at[axis] = element(f, numbers[n][axis]);
        } else {
          *at = element(f, numbers[n]);
        }
      }
    };
    std::visit(store, fields[f]);
    column += has_vectors(fields[f]) ? 3 : 1;
  }
  return elements;
}

}  // namespace raycone
