#include "core/orientation/sign_problem.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

#include "core/machine/threads.h"

namespace raycone {
namespace {

constexpr int kMaxPasses = 60;  // a few are enough nearly always

// Turns a surface even where that makes the sum larger, and then others one by one, each time that which makes it
// smallest, as far as the sum becomes smaller than it was: with chains of turns as Kernighan and Lin's ("An efficient
// heuristic procedure for partitioning graphs", 1970), from each surface in turn.
class TurnChains {
 public:
  // `gains`: turning a surface makes the sum smaller by 4 times its gain. `products` must stay.
  TurnChains(std::span<const double> products, std::vector<double> gains, std::vector<int> sign)
      : products_(products), now_{std::move(gains), std::move(sign)} {}

  // Whether there was a chain that makes the sum smaller by more than 4 times `least`.
  bool pass(double least) {
    bool any = false;
    for (std::size_t p = 0; p < now_.sign.size(); ++p) any = turn_from(p, least) || any;
    return any;
  }
  [[nodiscard]] const std::vector<int>& sign() const { return now_.sign; }

 private:
  struct State {
    std::vector<double> gains;
    std::vector<int> sign;
  };

  bool turn_from(std::size_t first, double least) {
    constexpr std::size_t kLongest = 32;  // turns
    State trial = now_, best;
    std::vector<bool> turned(now_.sign.size(), false);
    double won = 0.0, most_won = least;
    std::size_t p = first;
    for (std::size_t n = 0; n < kLongest && p < turned.size(); ++n, p = best_of(trial, turned)) {
      won += trial.gains[p];
      turn(p, trial);
      turned[p] = true;
      if (!(won > most_won)) continue;
      most_won = won;
      best = trial;
    }
    if (best.sign.empty()) return false;
    now_ = std::move(best);
    return true;
  }

  // Of the surfaces that have not been turned; their number if there is none.
  static std::size_t best_of(const State& state, const std::vector<bool>& turned) {
    std::size_t best = turned.size();
    for (std::size_t p = 0; p < turned.size(); ++p) {
      if (!turned[p] && (best == turned.size() || state.gains[p] > state.gains[best])) best = p;
    }
    return best;
  }

  void turn(std::size_t p, State& state) const {
    const std::span<const double> with_p = products_.subspan(p * state.sign.size(), state.sign.size());
    const double own_gain = state.gains[p];
    const int factor = 2 * state.sign[p];
    for (std::size_t q = 0; q < with_p.size(); ++q) state.gains[q] -= factor * state.sign[q] * with_p[q];
    state.gains[p] = -own_gain;
    state.sign[p] = -state.sign[p];
  }

  std::span<const double> products_;
  State now_;
};

}  // namespace

void SignProblem::add_surface(std::span<const Effect> effects) {
  effects_.insert(effects_.end(), effects.begin(), effects.end());
  begin_.push_back(effects_.size());
  double own = 0.0;
  for (const Effect& e : effects) own += weight_[e.sample] * e.winding * e.winding;
  own_.push_back(own);
}

double SignProblem::slope(std::size_t surface, const std::vector<double>& rest) const {
  double sum = 0.0;
  for (const Effect& e : effects(surface)) sum += weight_[e.sample] * rest[e.sample] * e.winding;
  return sum;
}

void SignProblem::add(std::size_t surface, int factor, std::vector<double>& rest) const {
  for (const Effect& e : effects(surface)) rest[e.sample] += factor * static_cast<double>(e.winding);
}

double SignProblem::gain(std::size_t surface, const std::vector<double>& rest, const std::vector<int>& sign) const {
  return sign[surface] * slope(surface, rest) - own_[surface];
}

std::vector<int> SignProblem::one_after_the_other(std::vector<double> rest) const {
  std::vector<int> sign(surfaces(), 1);
  for (std::size_t p = 0; p < surfaces(); ++p) {
    sign[p] = slope(p, rest) > 0.0 ? -1 : 1;
    add(p, sign[p], rest);
  }
  return sign;
}

std::vector<double> SignProblem::with_all(std::vector<double> rest, const std::vector<int>& sign) const {
  for (std::size_t p = 0; p < surfaces(); ++p) add(p, sign[p], rest);
  return rest;
}

double SignProblem::sum(const std::vector<double>& rest, const std::vector<int>& sign) const {
  const std::vector<double> all = with_all(rest, sign);
  double sum = 0.0;
  for (std::size_t k = 0; k < all.size(); ++k) sum += weight_[k] * all[k] * all[k];
  return sum;
}

bool SignProblem::turn_single(double least, std::vector<double>& rest, std::vector<int>& sign) const {
  bool turned = false;
  for (std::size_t p = 0; p < surfaces(); ++p) {
    if (!(gain(p, rest, sign) > least)) continue;
    add(p, -2 * sign[p], rest);
    sign[p] = -sign[p];
    turned = true;
  }
  return turned;
}

// Some rows at once, so that effects are read less often.
void SignProblem::make_products() {
  constexpr std::size_t kRows = 8;
  const std::size_t count = surfaces(), samples = weight_.size();
  std::vector<float> by_sample(samples * count, 0.0F);
  for (std::size_t p = 0; p < count; ++p) {
    for (const Effect& e : effects(p)) by_sample[e.sample * count + p] = e.winding;
  }
  products_.assign(count * count, 0.0);
  parallel_for_each((count + kRows - 1) / kRows, [&](std::size_t block) {
    const std::size_t first = block * kRows, end = std::min(count, first + kRows);
    for (std::size_t k = 0; k < samples; ++k) {
      const float* const w = &by_sample[k * count];
      for (std::size_t p = first; p < end; ++p) {
        const double factor = weight_[k] * w[p];
        double* const with_p = &products_[p * count];
        for (std::size_t q = first; q < count; ++q) with_p[q] += factor * w[q];
      }
    }
  });
  for (std::size_t p = 0; p < count; ++p) {
    for (std::size_t q = 0; q < p; ++q) products_[p * count + q] = products_[q * count + p];
  }
}

void SignProblem::turn_chains(double least, const std::vector<double>& rest, std::vector<int>& sign) {
  if (products_.empty()) make_products();
  std::vector<double> gains;
  for (std::size_t p = 0; p < surfaces(); ++p) gains.push_back(gain(p, rest, sign));
  TurnChains chains(products_, std::move(gains), sign);
  for (int pass = 0; pass < kMaxPasses && chains.pass(least); ++pass) {
  }
  sign = chains.sign();
}

double SignProblem::improve(const std::vector<double>& rest, std::vector<int>& sign) {
  constexpr double kLeastGain = 1e-12;  // of the sum of weights: less than that is rounding
  constexpr std::size_t kFew = 512;     // surfaces: their products take a tenth of a second
  const double least = kLeastGain * std::accumulate(weight_.begin(), weight_.end(), 0.0);
  std::vector<double> all = with_all(rest, sign);
  if (surfaces() <= kFew) {
    turn_chains(least, all, sign);
  } else {
    for (int pass = 0; pass < kMaxPasses && turn_single(least, all, sign); ++pass) {
    }
  }
  return sum(rest, sign);
}

}  // namespace raycone
