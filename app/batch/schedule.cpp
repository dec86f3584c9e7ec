#include "app/batch/schedule.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace raycone {
namespace {

// What a mesh costs whatever its size, in bytes of meshes.
constexpr std::uint64_t kBaseWeight = std::uint64_t{1} << 16;

// Sizes within a factor of four are similar.
int size_class(std::uint64_t size) { return static_cast<int>(std::bit_width(size / kBaseWeight)) / 2; }

}  // namespace

Schedule::Schedule(const std::vector<std::uint64_t>& sizes, int threads, int jobs)
    : sizes_(sizes), waiting_(sizes.size()), threads_(threads), free_threads_(threads), free_jobs_(jobs) {
  std::iota(waiting_.begin(), waiting_.end(), std::size_t{0});
  std::ranges::stable_sort(waiting_, std::greater<>(), [this](std::size_t mesh) { return size_class(sizes_[mesh]); });
  for (const std::size_t mesh : waiting_) all_weight_ += weight(mesh);
  waiting_weight_ = all_weight_;
}

double Schedule::weight(std::size_t mesh) const { return static_cast<double>(sizes_[mesh] + kBaseWeight); }

std::optional<Schedule::Start> Schedule::next() {
  if (waiting_.empty() || free_threads_ == 0 || free_jobs_ == 0) return std::nullopt;
  const std::size_t mesh = waiting_.front();
  const auto starters = static_cast<int>(std::min<std::size_t>(waiting_.size(), static_cast<std::size_t>(free_jobs_)));
  const int idle_otherwise = free_threads_ / starters;
  const auto in_proportion = static_cast<int>(std::floor(threads_ * weight(mesh) / waiting_weight_));
  const Start start{mesh, std::min(std::max({1, idle_otherwise, in_proportion}), free_threads_)};
  waiting_.pop_front();
  waiting_weight_ -= weight(mesh);
  free_threads_ -= start.threads;
  --free_jobs_;
  return start;
}

void Schedule::finished(const Start& start) {
  done_weight_ += weight(start.mesh);
  free_threads_ += start.threads;
  ++free_jobs_;
}

void Schedule::put_off(const Start& start) {
  waiting_.push_front(start.mesh);
  waiting_weight_ += weight(start.mesh);
  free_threads_ += start.threads;
  free_jobs_ = 0;
}

double Schedule::progress() const { return all_weight_ > 0.0 ? done_weight_ / all_weight_ : 1.0; }

}  // namespace raycone
