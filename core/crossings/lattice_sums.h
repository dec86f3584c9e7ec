// What triangles say about the samples of a lattice, summed up in memory that does not grow with what they say: soups
// and sheets have thousands of crossings per row.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "core/crossings/crossings.h"
#include "core/data/diagnostics.h"
#include "core/machine/sorted_by_key.h"

namespace raycone {

// The first `samples` of a row count `crossings` more. In runs(): the samples up to `samples` have `crossings`.
struct RowPrefix {
  std::uint32_t samples;
  std::int32_t crossings;
};

// The crossings n of the samples of one row, as runs of samples that have the same.
class RowRuns {
 public:
  explicit RowRuns(std::span<const RowPrefix> runs) : runs_(runs) {}
  explicit RowRuns(std::span<const double> each) : each_(each) {}

  [[nodiscard]] double at(std::size_t sample) const {
    if (!each_.empty()) return each_[sample];
    const auto run = run_of(sample);
    return run == runs_.end() ? 0.0 : run->crossings;
  }

  // visit(first, last, n) for the samples [begin, end), in ascending order, as long as it returns true. Returns whether
  // it always did.
  template <class Visit>
  bool for_each(std::size_t begin, std::size_t end, const Visit& visit) const {
    if (!each_.empty()) return for_each_of_each(begin, end, visit);
    auto run = run_of(begin);
    while (begin < end) {
      const std::size_t last = run == runs_.end() ? end : std::min<std::size_t>(end, run->samples);
      if (last > begin && !visit(begin, last, run == runs_.end() ? 0.0 : run->crossings)) return false;
      begin = last;
      if (run != runs_.end()) ++run;
    }
    return true;
  }

 private:
  [[nodiscard]] std::span<const RowPrefix>::iterator run_of(std::size_t sample) const {
    return std::ranges::upper_bound(runs_, sample, {}, &RowPrefix::samples);
  }
  template <class Visit>
  bool for_each_of_each(std::size_t begin, std::size_t end, const Visit& visit) const {
    while (begin < end) {
      std::size_t last = begin + 1;
      while (last < end && each_[last] == each_[begin]) ++last;
      if (!visit(begin, last, each_[begin])) return false;
      begin = last;
    }
    return true;
  }

  std::span<const RowPrefix> runs_;  // ascending; what is behind the last one has none
  std::span<const double> each_;     // of each sample, where there are too many runs
};

// Rows of `samples` samples each; sample i of row r is number r * samples + i of all spans. First all crossings are
// collected, then they are arranged, then rows are finished.
class LatticeSums {
  struct RowCrossing {
    std::uint32_t row;
    std::uint32_t samples;  // counted by the samples [0, samples)
    std::int32_t sigma;
  };

 public:
  // `crossings` receives n of each sample, an integer; empty where nobody asks for it. `diagnostics`, where given, its
  // crossings (which need the other ones), degenerate and on_surface. All must outlive this.
  LatticeSums(std::size_t rows, std::size_t samples, std::span<double> crossings, const Diagnostics* diagnostics);
  // kIgnore: nobody asks what is on the surface, and finish() returns 0.
  enum class OnSurface { kCount, kIgnore };
  // For who asks for runs().
  LatticeSums(std::size_t rows, std::size_t samples, OnSurface on_surface = OnSurface::kCount);

  // Most bytes per sample that this takes beside the caller's spans: a byte, and 20 for each 16 samples, rounded up
  // with 8 for each row; for runs(), sizeof(double) more.
  static constexpr double kBytesPerSample = 3.0;

  // What one thread has to say.
  class Collector {
   public:
    explicit Collector(LatticeSums& sums) : sums_(sums) {}
    void add(std::size_t row, const TriangleCrossing& crossing) {
      if (crossing.crossed > 0 && sums_.counts_) count(row, crossing);
      if (sums_.marks_ && (crossing.ties > 0 || crossing.on_begin < crossing.on_end)) sums_.mark(row, crossing);
      ties_ += crossing.met * static_cast<std::uint64_t>(crossing.ties);
    }
    // To be called when all has been said.
    void finish();

   private:
    void count(std::size_t row, const TriangleCrossing& crossing);

    LatticeSums& sums_;
    std::vector<RowCrossing> waiting_;
    std::uint64_t ties_ = 0;
  };

  // Between the last Collector::finish() and the first finish().
  void arrange();

  // Sets the spans of a row. Returns how many of its samples lie on the surface. Once per row; different rows may be
  // finished at the same time.
  std::uint64_t finish(std::size_t row);

  // The crossings of a row that is finished; where runs were asked for.
  [[nodiscard]] RowRuns runs(std::size_t row) const {
    if (dense_) return RowRuns(std::span<const double>(crossings_).subspan(row * samples_, samples_));
    return RowRuns(prefixes_[row]);
  }

  // Edge sides that were ties, over all samples.
  [[nodiscard]] std::uint64_t ties() const { return ties_; }

 private:
  void take(std::vector<RowCrossing>& crossed);
  void make_dense();
  void add_to_samples(std::span<const RowCrossing> crossed);
  // Adds ties where diagnostics ask for them, and flags samples on the surface.
  void mark(std::size_t row, const TriangleCrossing& crossing);
  std::uint8_t* on_surface();
  void sum_prefixes(std::size_t row);
  void make_runs(std::size_t row);

  std::size_t rows_, samples_;
  bool counts_;                        // whether anybody asks for n
  bool marks_ = true;                  // whether anybody asks what is on the surface or degenerate
  std::vector<double> own_crossings_;  // where runs were asked for and there are too many
  std::span<double> crossings_;
  const Diagnostics* diagnostics_;
  std::mutex mutex_;
  std::atomic<std::uint64_t> ties_ = 0;
  // Few crossings are kept as they come, until they are arranged by row.
  std::vector<std::vector<RowCrossing>> parts_;
  std::size_t kept_ = 0;
  SortedByKey<RowPrefix> prefixes_;  // by row
  // Many are added up: crossings_[i] is then what is said of the samples of its row up to i and no further.
  std::atomic<bool> dense_ = false;
  std::vector<std::uint8_t> own_on_surface_;  // where there are no diagnostics; empty as long as nothing is on it
  std::atomic<std::uint8_t*> on_surface_ = nullptr;
};

}  // namespace raycone
