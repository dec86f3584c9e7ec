// Which columns of a table its header names as coordinates.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace raycone {

using Columns = std::array<std::size_t, 3>;  // of x, y and z, from 0

// Plain names win: "x", "X" or "Points:0". Else units beside a letter do not matter ("y [mm]"), nor do words such as
// "point" and "pos" ("POINT_X"), and nothing is returned where an axis has no column, or several.
[[nodiscard]] std::optional<Columns> named_columns(const std::vector<std::string_view>& names);

// Whether one of the first three is the letter of another axis than that of its place, as x is in "id,x,y".
[[nodiscard]] bool names_axis_elsewhere(const std::vector<std::string_view>& names);

}  // namespace raycone
