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

double SignProblem::gain(std::size_t surface, const std::vector<double>& rest, const std::vector<int>& sign) const {
  return sign[surface] * slope(surface, rest) - own_[surface];
}

void SignProblem::turn(std::size_t surface, std::vector<double>& rest, std::vector<int>& sign) const {
  add(surface, -2 * sign[surface], rest);
  sign[surface] = -sign[surface];
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

bool SignProblem::turn_single(double least, std::vector<double>& rest, std::vector<int>& sign) const {
  bool turned = false;
  for (std::size_t p = 0; p < surfaces(); ++p) {
    if (!(gain(p, rest, sign) > least)) continue;
    turn(p, rest, sign);
    turned = true;
  }
  return turned;
}

bool SignProblem::turn_pair(double least, std::vector<double>& rest, std::vector<int>& sign) const {
  for (std::size_t p = 0; p < surfaces(); ++p) {
    const double of_first = gain(p, rest, sign);
    turn(p, rest, sign);
    for (std::size_t q = p + 1; q < surfaces(); ++q) {
      if (!(of_first + gain(q, rest, sign) > least)) continue;
      turn(q, rest, sign);
      return true;
    }
    turn(p, rest, sign);
  }
  return false;
}

double SignProblem::improve(std::vector<double> rest, std::vector<int>& sign) const {
  constexpr int kMaxPasses = 60;        // a few are enough nearly always
  constexpr double kLeastGain = 1e-12;  // of the sum of weights: less than that is rounding
  constexpr std::size_t kFew = 64;      // surfaces: all pairs of them take some milliseconds
  double weights = 0.0;
  for (const double w : weight_) weights += w;
  for (std::size_t p = 0; p < surfaces(); ++p) add(p, sign[p], rest);
  const double least = kLeastGain * weights;
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    if (turn_single(least, rest, sign)) continue;
    if (surfaces() > kFew || !turn_pair(least, rest, sign)) break;
  }
  return sum_of(rest);
}

}  // namespace raycone
