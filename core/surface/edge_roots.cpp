#include "core/surface/edge_roots.h"

#include <algorithm>

namespace raycone {
namespace {

// The next place to look at: by the secant, with the value of an end that stays halved (the Illinois rule; Dowell,
// Jarratt 1971); halfway where that does not get on.
double next_place(const Bracket& bracket, int round) {
  constexpr int kEveryRound = 3;
  const double middle = bracket.low + (bracket.high - bracket.low) / 2;
  if (round % kEveryRound == kEveryRound - 1) return middle;
  const double weight = bracket.low_value / (bracket.low_value - bracket.high_value);
  const double secant = bracket.low + weight * (bracket.high - bracket.low);
  return secant > bracket.low && secant < bracket.high ? secant : middle;
}

void narrow(Bracket& bracket, double at, double value) {
  constexpr double kHalf = 0.5;
  if (value >= 0.0) {
    bracket.low = at;
    bracket.low_value = value;
    bracket.stays = std::min(bracket.stays, 0) - 1;
    if (bracket.stays < -1) bracket.high_value *= kHalf;
  } else {
    bracket.high = at;
    bracket.high_value = value;
    bracket.stays = std::max(bracket.stays, 0) + 1;
    if (bracket.stays > 1) bracket.low_value *= kHalf;
  }
}

}  // namespace

std::vector<double> RuleAlong::at(const std::vector<Vec3>& points) const {
  std::vector<double> values(points.size());
  if (!points.empty()) evaluator_.evaluate(points, values);  // which prepares for points, many or none
  for (double& w : values) w = from_threshold(w);
  return values;
}

std::vector<double> RuleAlong::near(const std::vector<Vec3>& points) const {
  std::vector<double> values(points.size());
  if (!points.empty()) evaluator_.evaluate_unsettled(points, values);
  for (double& w : values) w = from_threshold(w);
  return values;
}

void find_roots(std::vector<Bracket>& brackets,
                const std::function<std::vector<double>(const std::vector<Vec3>&)>& values_at) {
  constexpr int kRounds = 90;          // a third of them halve the bracket
  constexpr double kNarrow = 0x1p-34;  // of an edge
  std::vector<Bracket*> waiting;
  std::vector<Vec3> points;
  for (Bracket& bracket : brackets) {
    waiting.push_back(&bracket);
    points.push_back(bracket.edge.point(bracket.low));
    points.push_back(bracket.edge.point(bracket.high));
  }
  // At a triangle the value may be that of its other side.
  const std::vector<double> ends = values_at(points);
  for (std::size_t i = 0; i < waiting.size(); ++i) {
    waiting[i]->low_value = std::max(ends[2 * i], 0.0);
    waiting[i]->high_value = std::min(ends[2 * i + 1], 0.0);
  }
  for (int round = 0; round < kRounds && !waiting.empty(); ++round) {
    std::vector<double> places;
    points.clear();
    for (const Bracket* const bracket : waiting) {
      places.push_back(next_place(*bracket, round));
      points.push_back(bracket->edge.point(places.back()));
    }
    const std::vector<double> values = values_at(points);
    for (std::size_t i = 0; i < waiting.size(); ++i) narrow(*waiting[i], places[i], values[i]);
    std::erase_if(waiting, [](const Bracket* bracket) { return bracket->high - bracket->low <= kNarrow; });
  }
}

}  // namespace raycone
