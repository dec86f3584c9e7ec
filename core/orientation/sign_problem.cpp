#include "core/orientation/sign_problem.h"

namespace raycone {

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

std::vector<int> SignProblem::one_after_the_other(std::vector<double> rest) const {
  std::vector<int> sign(surfaces(), 1);
  for (std::size_t p = 0; p < surfaces(); ++p) {
    sign[p] = slope(p, rest) > 0.0 ? -1 : 1;
    add(p, sign[p], rest);
  }
  return sign;
}

double SignProblem::sum_of(const std::vector<double>& rest) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < rest.size(); ++k) sum += weight_[k] * rest[k] * rest[k];
  return sum;
}

double SignProblem::sum(std::vector<double> rest, const std::vector<int>& sign) const {
  for (std::size_t p = 0; p < surfaces(); ++p) add(p, sign[p], rest);
  return sum_of(rest);
}

double SignProblem::improve(std::vector<double> rest, std::vector<int>& sign) const {
  constexpr int kMaxPasses = 60;        // a few are enough nearly always
  constexpr double kLeastGain = 1e-12;  // of the sum of weights: less than that is rounding
  double weights = 0.0;
  for (const double w : weight_) weights += w;
  for (std::size_t p = 0; p < surfaces(); ++p) add(p, sign[p], rest);
  bool turned = true;
  for (int pass = 0; turned && pass < kMaxPasses; ++pass) {
    turned = false;
    for (std::size_t p = 0; p < surfaces(); ++p) {
      // Turning p makes the sum smaller by 4 times this.
      const double gain = sign[p] * slope(p, rest) - own_[p];
      if (!(gain > kLeastGain * weights)) continue;
      add(p, -2 * sign[p], rest);
      sign[p] = -sign[p];
      turned = true;
    }
  }
  return sum_of(rest);
}

}  // namespace raycone
