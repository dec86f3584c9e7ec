// Fields at points as rows of a table.
#pragma once

#include <cstddef>
#include <span>
#include <variant>
#include <vector>

#include "io/fields/field_writer.h"

namespace raycone {

// A row per sample: the number of each field, as element(its index, number).
template <typename Element, typename Convert>
[[nodiscard]] std::vector<Element> interleaved(std::span<const FieldValues> fields, std::size_t samples,
                                               const Convert& element) {
  std::vector<Element> elements(fields.size() * samples);
  for (std::size_t f = 0; f < fields.size(); ++f) {
    const auto store = [&](const auto& numbers) {
      for (std::size_t n = 0; n < samples; ++n) elements[n * fields.size() + f] = element(f, numbers[n]);
    };
    std::visit(store, fields[f]);
  }
  return elements;
}

}  // namespace raycone
