// Signs that make a sum of squares small.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace raycone {

// The sum over samples k of weight[k] (rest[k] + sum over surfaces p of sign[p] w(p, k))^2, where most w(p, k) are 0 or
// left out. All of it is summed in one fixed order.
class SignProblem {
 public:
  struct Effect {
    std::uint32_t sample;
    float winding;  // w; its rounding is far below what decides
  };

  explicit SignProblem(std::vector<double> weight) : weight_(std::move(weight)), begin_(1, 0) {}

  // The effects of the next surface.
  void add_surface(std::span<const Effect> effects);
  [[nodiscard]] std::size_t surfaces() const { return begin_.size() - 1; }

  // Adds the surfaces one after the other; each gets the sign that makes the sum smaller. Returns the signs, 1 or -1.
  [[nodiscard]] std::vector<int> one_after_the_other(std::vector<double> rest) const;

  [[nodiscard]] double sum(const std::vector<double>& rest, const std::vector<int>& sign) const;

  // Turns surfaces (changes `sign`) until no smaller sum is found. Of many surfaces, each turn makes the sum smaller;
  // of few, chains of turns may pass through larger sums. Returns the sum. Uses the threads that ThreadLimit allows;
  // the same for any number of them.
  double improve(const std::vector<double>& rest, std::vector<int>& sign);

 private:
  [[nodiscard]] std::span<const Effect> effects(std::size_t surface) const {
    return std::span(effects_).subspan(begin_[surface], begin_[surface + 1] - begin_[surface]);
  }
  [[nodiscard]] double slope(std::size_t surface, const std::vector<double>& rest) const;
  void add(std::size_t surface, int factor, std::vector<double>& rest) const;
  [[nodiscard]] std::vector<double> with_all(std::vector<double> rest, const std::vector<int>& sign) const;
  // From here on `rest` includes all surfaces. Turning a surface makes the sum smaller by 4 times its gain.
  [[nodiscard]] double gain(std::size_t surface, const std::vector<double>& rest, const std::vector<int>& sign) const;
  // Turns surfaces that make the sum smaller by more than 4 times `least`. Returns whether there were any.
  bool turn_single(double least, std::vector<double>& rest, std::vector<int>& sign) const;
  void turn_chains(double least, const std::vector<double>& rest, std::vector<int>& sign);
  void make_products();

  std::vector<double> weight_;
  std::vector<Effect> effects_;  // by surface
  std::vector<std::size_t> begin_;
  std::vector<double> own_;       // per surface: the sum of weight w^2
  std::vector<double> products_;  // of each two surfaces, of few: the sum of weight w w; made once
};

}  // namespace raycone
