#include "core/cells/line_roots.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

namespace raycone {
namespace {

// Closer together where they are near to the point; increasing. None without a direction.
std::vector<double> places_on(const Line& line, double first) {
  if (line.direction == Vec3{}) return {};
  std::vector<double> places{0.0};
  for (double place = first; place < line.reach; place *= 2.0) places.push_back(place);
  places.push_back(line.reach);
  const std::size_t count = line.has_back ? places.size() : 0;
  for (std::size_t n = 1; n < count; ++n) places.push_back(-places[n]);
  std::ranges::sort(places);
  return places;
}

bool is_inside(double value) { return value >= 0.0; }

// Of the two places next to each other, nearest to 0, between which the side changes, the second one. 0 for none.
std::size_t nearest_change(std::span<const double> places, std::span<const double> values) {
  std::size_t best = 0;
  for (std::size_t n = 1; n < places.size(); ++n) {
    const auto off = [&](std::size_t end) { return std::abs(places[end - 1] + places[end]); };
    if (is_inside(values[n - 1]) != is_inside(values[n]) && (best == 0 || off(n) < off(best))) best = n;
  }
  return best;
}

// At a jump `behind` the root, or half of the way to the inside end if that is less.
double place_of(const Bracket& bracket, double behind) {
  if (!bracket.at_jump) return bracket.root;
  const double length = norm(bracket.edge.outside - bracket.edge.inside);
  return bracket.root - std::min(behind / length, bracket.root / 2);
}

}  // namespace

Line line_through(const Vec3& point, const Vec3& direction, double reach) {
  const double size = norm(direction);
  return {point, size > 0.0 ? (1.0 / size) * direction : Vec3{}, reach};
}

std::vector<std::optional<Vec3>> nearest_roots(const std::vector<Line>& lines, double first, double behind,
                                               const RuleAlong& along) {
  std::vector<std::vector<double>> places;
  std::vector<Vec3> points;
  for (const Line& line : lines) {
    places.push_back(places_on(line, first));
    for (const double place : places.back()) points.push_back(line.point + place * line.direction);
  }
  const std::vector<double> values = along.roughly_near(points);
  std::vector<Bracket> brackets;
  std::vector<std::size_t> of_line;
  for (std::size_t n = 0, begin = 0; n < lines.size(); begin += places[n++].size()) {
    const std::size_t end = nearest_change(places[n], std::span(values).subspan(begin, places[n].size()));
    if (end == 0) continue;
    std::size_t in = begin + end, out = in - 1;
    if (!is_inside(values[in])) std::swap(in, out);
    brackets.push_back({{points[in], points[out], 0}, 0.0, 1.0});
    of_line.push_back(n);
  }
  find_roots(brackets, [&](const std::vector<Vec3>& there) { return along.near(there); });
  std::vector<std::optional<Vec3>> roots(lines.size());
  for (std::size_t n = 0; n < brackets.size(); ++n)
    roots[of_line[n]] = brackets[n].edge.point(place_of(brackets[n], behind));
  return roots;
}

}  // namespace raycone
