#include "io/points/column_names.h"

#include <algorithm>
#include <span>

#include "io/files/ascii.h"

namespace raycone {
namespace {

// Words that may stand beside x, y or z in a name, and such as do so where no column has the former.
constexpr std::array<std::string_view, 14> kPointWords{
    "point", "points", "pos", "position", "coord", "coordinate", "coords", "um", "mm", "cm", "m", "km", "in", "ft"};
constexpr std::array<std::string_view, 5> kOtherWords{"p", "location", "vertex", "center", "centre"};

using Words = std::span<const std::string_view>;

bool is_one_of(Words words, std::string_view word) {
  return std::ranges::any_of(words, [&](std::string_view known) { return is_word(word, known); });
}

constexpr std::size_t kNoAxis = 3;

std::size_t axis_of_letter(std::string_view name) {
  return name.size() == 1 ? std::min(std::string_view("xyz").find(lower_case(name.front())), kNoAxis) : kNoAxis;
}

// Of "X", "y [mm]", "z(m)"; and of "//X", as CloudCompare begins a header.
std::size_t axis_with_unit(std::string_view name) {
  if (name.starts_with("//")) name.remove_prefix(2);
  const std::size_t unit = name.find_first_of("[(");
  if (unit != std::string_view::npos && (name.ends_with(']') || name.ends_with(')'))) name = name.substr(0, unit);
  while (name.ends_with(' ')) name.remove_suffix(1);
  return axis_of_letter(name);
}

// Of "POINT_X", "pos.y", "z_mm".
std::size_t axis_with_words(std::string_view name, Words words) {
  std::size_t axis = kNoAxis;
  while (!name.empty()) {
    const std::size_t end = std::min(name.find_first_of("_. "), name.size());
    const std::string_view word = name.substr(0, end);
    name.remove_prefix(std::min(end + 1, name.size()));
    if (word.empty() || is_one_of(words, word)) continue;
    if (axis != kNoAxis) return kNoAxis;
    axis = axis_of_letter(word);
    if (axis == kNoAxis) return kNoAxis;
  }
  return axis;
}

// The columns of the axes, and how many each has.
struct AxisColumns {
  Columns last{};
  std::array<int, 3> count{};
};

template <class AxisOf>
AxisColumns columns_by(const AxisOf& axis_of, const std::vector<std::string_view>& names) {
  AxisColumns columns;
  for (std::size_t column = 0; column < names.size(); ++column) {
    const std::size_t axis = axis_of(names[column]);
    if (axis == kNoAxis) continue;
    columns.last[axis] = column;
    ++columns.count[axis];
  }
  return columns;
}

}  // namespace

std::optional<Columns> named_columns(const std::vector<std::string_view>& names) {
  static constexpr std::array<std::array<std::string_view, 3>, 4> kNames{
      {{"x", "y", "z"}, {"X", "Y", "Z"}, {"Points:0", "Points:1", "Points:2"}, {"Points_0", "Points_1", "Points_2"}}};
  for (const auto& wanted : kNames) {
    Columns columns{};
    std::size_t found = 0;
    for (; found < 3; ++found) {
      const auto name = std::find(names.begin(), names.end(), wanted[found]);
      if (name == names.end()) break;
      columns[found] = static_cast<std::size_t>(name - names.begin());
    }
    if (found == 3) return columns;
  }
  AxisColumns columns = columns_by(axis_with_unit, names);
  for (const Words words : {Words(kPointWords), Words(kOtherWords)}) {
    if (columns.count != std::array{0, 0, 0}) break;
    columns = columns_by([&](std::string_view name) { return axis_with_words(name, words); }, names);
  }
  return columns.count == std::array{1, 1, 1} ? std::optional(columns.last) : std::nullopt;
}

bool names_axis_elsewhere(const std::vector<std::string_view>& names) {
  for (std::size_t column = 0; column < std::min(names.size(), kNoAxis); ++column) {
    const std::size_t axis = axis_with_unit(names[column]);
    if (axis != kNoAxis && axis != column) return true;
  }
  return false;
}

}  // namespace raycone
