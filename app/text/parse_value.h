// Values of options and environment variables as numbers. The whole text must be the number: what overflows, is not
// finite or has something behind it is none. Always the C locale's notation.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace raycone {

[[nodiscard]] std::optional<double> number_from(std::string_view text);
[[nodiscard]] std::optional<std::int64_t> integer_from(std::string_view text);

// Comma-separated lists; nothing where any item is not a number.
[[nodiscard]] std::optional<std::vector<double>> numbers_from(std::string_view text);
[[nodiscard]] std::optional<std::vector<std::int64_t>> integers_from(std::string_view text);
[[nodiscard]] std::vector<std::string_view> items_of(std::string_view list);

// Bytes: a positive number, optionally followed by K, M, G or T (powers of 1024).
[[nodiscard]] std::optional<std::uint64_t> byte_count_from(std::string_view text);

}  // namespace raycone
