#include "core/cells/edge_roots.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <tuple>

#include "core/machine/threads.h"

namespace raycone {
namespace {

constexpr double kNarrow = 0x1p-34;  // of an edge

// The search in one bracket: by inverse quadratic interpolation through the last three places where that is sure to be
// of use, else by halving (Chandrupatla, Advances in Engineering Software 28, 1997).
class RootSearch {
 public:
  // Values at triangles may be those of their other side.
  RootSearch(Bracket& bracket, double low_value, double high_value)
      : bracket_(&bracket),
        last_{bracket.low, std::max(low_value, 0.0), true},
        across_{bracket.high, std::min(high_value, 0.0), false} {
    bracket.root = bracket.low + (bracket.high - bracket.low) / 2;
  }

  [[nodiscard]] Vec3 next() const { return bracket_->edge.point(next_place()); }

  // `value`: at next().
  void narrow(double value, int round) {
    const Place here{next_place(), value, value >= 0.0};
    const Place before = here.is_inside == last_.is_inside ? last_ : across_;
    if (here.is_inside != last_.is_inside) across_ = last_;
    last_ = here;
    (last_.is_inside ? bracket_->low : bracket_->high) = last_.at;
    (last_.is_inside ? bracket_->high : bracket_->low) = across_.at;
    part_ = round < kRoundsAtFirst ? part_by(before) : 0.5;
    const double part = last_.value / (last_.value - across_.value);  // NaN where both are 0
    bracket_->root = last_.at + (part >= 0.0 && part <= 1.0 ? part : 0.5) * (across_.at - last_.at);
    meet(before);
    bracket_->at_jump = !is_met_ && std::abs(last_.value - across_.value) > kJump;
  }

  [[nodiscard]] bool is_done() const { return is_met_ || bracket_->high - bracket_->low <= kNarrow; }

 private:
  static constexpr int kRoundsAtFirst = 40;
  // Across a bracket as narrow as it is in the end, w changes by less where no edge is nearer than 2^-26 of the way.
  // Rules that fold w make less of a turn: of 0.3 and 1.3 turns, `odd` makes -0.2 and 0.2.
  static constexpr double kJump = 0x1p-8;

  struct Place {
    double at, value;
    bool is_inside;
  };

  [[nodiscard]] double next_place() const { return last_.at + part_ * (across_.at - last_.at); }

  // Where the last step came much nearer to 0, and values fall to both sides of the place about as steeply, they are as
  // good as straight there. A root that is that near is found, though no place behind it tells.
  void meet(const Place& before) {
    constexpr double kMuchNearer = 0x1p-8, kAlike = 4.0, kNear = 0x1p-3 * kNarrow;
    const double slope = (before.value - last_.value) / (before.at - last_.at);
    const double other = (across_.value - last_.value) / (across_.at - last_.at), step = -last_.value / slope;
    const bool is_straight = std::abs(last_.value) <= kMuchNearer * std::abs(before.value) && slope / other < kAlike &&
                             other / slope < kAlike;  // false where there are NaN
    if (!is_straight || !(std::abs(step) <= kNear)) return;
    is_met_ = true;
    bracket_->root = std::clamp(last_.at + step, bracket_->low, bracket_->high);
  }

  // Of the way from the last place to the one across. A root that is nearly found is overtaken, as only places on both
  // sides of it narrow the bracket.
  [[nodiscard]] double part_by(const Place& before) const {
    const double a = last_.value, b = across_.value, c = before.value;
    const double width = across_.at - last_.at, least = 0.75 * kNarrow / std::abs(width);
    const double xi = (last_.at - across_.at) / (before.at - across_.at), phi = (a - b) / (c - b);
    const bool is_sure = phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi;  // false where there are NaN
    if (!is_sure || a == b || b == c || a == c) return 0.5;
    const double part = a / (b - a) * c / (b - c) + (before.at - last_.at) / width * a / (c - a) * b / (c - b);
    return std::min(std::max(part, least), 1.0 - least);
  }

  Bracket* bracket_;
  Place last_, across_;
  double part_ = 0.5;
  bool is_met_ = false;
};

// On all threads.
template <class Body>
void for_each(std::size_t count, const Body& body) {
  constexpr std::size_t kPerTask = 4096;
  parallel_for_each(count, kPerTask, body);
}

// Asks once where points are equal: many edges have an end in common.
std::vector<double> values_of_each(const std::vector<Vec3>& points, const ValuesAt& values_at) {
  std::vector<std::size_t> order(points.size()), place(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t n) { return std::tuple(points[n].x, points[n].y, points[n].z); });
  std::vector<Vec3> distinct;
  for (const std::size_t n : order) {
    if (distinct.empty() || distinct.back() != points[n]) distinct.push_back(points[n]);
    place[n] = distinct.size() - 1;
  }
  const std::vector<double> values = values_at(distinct);
  std::vector<double> of_each(points.size());
  std::ranges::transform(place, of_each.begin(), [&](std::size_t at) { return values[at]; });
  return of_each;
}

}  // namespace

// Near half-integers values are settled already.
std::vector<double> RuleAlong::winding_numbers(const std::vector<Vec3>& points) const {
  std::vector<double> values(points.size());
  if (points.empty()) return values;  // the evaluator prepares for points, many or none
  rough_.evaluate(points, values);
  for (const double threshold : thresholds_to_settle(rule_)) {
    std::vector<std::size_t> doubtful;
    std::vector<Vec3> there;
    std::vector<double> settled;
    for (std::size_t n = 0; n < values.size(); ++n) {
      if (!may_be_across(values[n], threshold, rough_doubt())) continue;
      doubtful.push_back(n);
      there.push_back(points[n]);
      settled.push_back(values[n]);
    }
    rough_.settle(there, threshold, settled);
    for (std::size_t i = 0; i < doubtful.size(); ++i) values[doubtful[i]] = settled[i];
  }
  return values;
}

std::vector<std::uint8_t> RuleAlong::holds_at(const std::vector<Vec3>& points) const {
  const std::vector<double> values = winding_numbers(points);
  std::vector<std::uint8_t> holds_there(values.size());
  std::ranges::transform(values, holds_there.begin(), [&](double w) { return holds_for(w) ? 1 : 0; });
  return holds_there;
}

std::vector<double> RuleAlong::near(const std::vector<Vec3>& points) const {
  std::vector<double> values(points.size());
  if (!points.empty()) fine_.evaluate_unsettled(points, values);
  for (double& w : values) w = from_threshold(w);
  return values;
}

std::vector<double> RuleAlong::roughly_near(const std::vector<Vec3>& points) const {
  std::vector<double> values(points.size());
  if (!points.empty()) rough_.evaluate_unsettled(points, values);
  for (double& w : values) w = from_threshold(w);
  if (&fine_ == &rough_) return values;
  std::vector<std::size_t> doubtful;
  std::vector<Vec3> there;
  for (std::size_t n = 0; n < values.size(); ++n) {
    if (std::abs(values[n]) > rough_doubt() + fine_.doubt()) continue;
    doubtful.push_back(n);
    there.push_back(points[n]);
  }
  const std::vector<double> finer = near(there);
  for (std::size_t i = 0; i < doubtful.size(); ++i) values[doubtful[i]] = finer[i];
  return values;
}

void find_roots(std::vector<Bracket>& brackets, const ValuesAt& values_at) {
  constexpr int kRounds = 90;  // halving alone would take 34
  std::vector<Vec3> points(2 * brackets.size());
  for_each(brackets.size(), [&](std::size_t i) {
    points[2 * i] = brackets[i].edge.point(brackets[i].low);
    points[2 * i + 1] = brackets[i].edge.point(brackets[i].high);
  });
  const std::vector<double> ends = values_of_each(points, values_at);
  std::vector<RootSearch> searches;
  searches.reserve(brackets.size());
  for (std::size_t i = 0; i < brackets.size(); ++i) searches.emplace_back(brackets[i], ends[2 * i], ends[2 * i + 1]);
  for (int round = 0; round < kRounds; ++round) {
    std::erase_if(searches, [](const RootSearch& search) { return search.is_done(); });
    if (searches.empty()) return;
    points.resize(searches.size());
    for_each(searches.size(), [&](std::size_t i) { points[i] = searches[i].next(); });
    const std::vector<double> values = values_at(points);
    for_each(searches.size(), [&](std::size_t i) { searches[i].narrow(values[i], round); });
  }
}

}  // namespace raycone
