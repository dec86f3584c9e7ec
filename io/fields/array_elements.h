// Numbers of fields as elements of NumPy's arrays.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <string>

#include "core/data/lattice.h"
#include "io/fields/field_writer.h"

namespace raycone {

// How the numbers of one field are stored: real ones and vectors in `precision`, bounds as doubles, counts as
// int64, labels as int32, flags as bool; -0 as 0. Throws OutputError, which names `output`, where a distance is beyond
// the range of 16 or 32 bits. What is returned is valid until the next call.
class ArrayElements {
 public:
  virtual ~ArrayElements() = default;
  [[nodiscard]] virtual const char* descriptor() const = 0;  // as NumPy writes the type
  [[nodiscard]] virtual std::size_t size() const = 0;        // bytes

  // One number after the other.
  [[nodiscard]] virtual std::span<const char> in_order(const FieldValues& values) = 0;
  // Those of the samples [x_begin, x_end) along x of a block, counted from its first, x slowest and z fastest.
  [[nodiscard]] virtual std::span<const char> planes(const LatticeBlock& block, const FieldValues& values,
                                                     std::size_t x_begin, std::size_t x_end) = 0;
};

[[nodiscard]] std::unique_ptr<ArrayElements> make_array_elements(const FieldDescription& field, Precision precision,
                                                                 const std::string& output);

inline constexpr double kLargestFloat = std::numeric_limits<float>::max();

// Throws OutputError, which names `output`, where a number's magnitude is beyond `largest`, kLargestHalf or
// kLargestFloat; infinity checks nothing. `option`: that chooses the type of numbers.
void check_distances(std::span<const double> numbers, double largest, const char* option, const std::string& output);

}  // namespace raycone
