// Whether the grid of rays pays for points, or passes over the triangles are cheaper.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace raycone {

// What passes over the triangles take (point_crossings.h).
struct PassEffort {
  std::uint64_t triangles = 0;
  std::uint64_t looks = 0;      // of triangles, at rays and at rows of bins
  std::uint64_t decisions = 0;  // of predicates

  static constexpr std::uint64_t kTriangle = 3, kDecision = 10;
  // In units of 5 to 10 ns.
  [[nodiscard]] std::uint64_t sum() const { return kTriangle * triangles + looks + kDecision * decisions; }
};

// Nobody knows how many points will come, nor how many triangles their rays will meet. So passes are counted: the grid
// pays once they have taken about as long as building it. Some points do not wait for it then, and many wait about
// twice as long at most. Thread-safe.
class GridChoice {
 public:
  // For a mesh of so many triangles.
  explicit GridChoice(std::size_t triangles) : triangles_(triangles) {}

  // The grid cannot be built, or must not be.
  void rule_out() { is_ruled_out_.store(true, std::memory_order_relaxed); }
  // So many points are going to come, in however many portions.
  void expect_points(double points) { expected_points_.store(points, std::memory_order_relaxed); }
  void count_rays(std::size_t rays) { rays_.fetch_add(rays, std::memory_order_relaxed); }
  void count_effort(const PassEffort& effort);

  // Whether the grid pays for so many more points.
  [[nodiscard]] bool pays_for(double points) const;
  // How many of so many points are to be evaluated first, as what they take tells whether the grid pays for the others.
  [[nodiscard]] std::size_t points_to_try(std::size_t points) const;
  // How much more effort passes may take until they have taken as long as building the grid.
  [[nodiscard]] std::uint64_t effort_left() const;

 private:
  // What passes take for so many points.
  [[nodiscard]] double effort_of_passes(double points) const;
  [[nodiscard]] bool is_ruled_out() const { return is_ruled_out_.load(std::memory_order_relaxed); }

  std::uint64_t triangles_;
  std::atomic<bool> is_ruled_out_ = false;
  std::atomic<double> expected_points_ = 0.0;
  std::atomic<std::uint64_t> rays_ = 0, decisions_ = 0, effort_ = 0;  // of passes so far
};

}  // namespace raycone
