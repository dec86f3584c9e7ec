// What triangles say about the samples of a lattice, summed up in memory that does not grow with what they say: soups
// and sheets have thousands of crossings per row.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "core/crossings/crossings.h"
#include "core/data/diagnostics.h"

namespace raycone {

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

  // Most bytes per sample that this takes beside the caller's spans.
  static constexpr double kBytesPerSample = 3.0;

  // What one thread has to say.
  class Collector {
   public:
    explicit Collector(LatticeSums& sums) : sums_(sums) {}
    void add(std::size_t row, const TriangleCrossing& crossing) {
      if (crossing.crossed > 0 && !sums_.crossings_.empty()) count(row, crossing);
      if (crossing.ties > 0 || crossing.on_begin < crossing.on_end) sums_.add_degenerate(row, crossing);
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

  // Edge sides that were ties, over all samples.
  [[nodiscard]] std::uint64_t ties() const { return ties_; }

 private:
  // A crossing of one row.
  struct Prefix {
    std::uint32_t samples;  // counted by the first ones, so many
    std::int32_t sigma;
  };

  void take(std::vector<RowCrossing>& crossed);
  void make_dense();
  void add_to_samples(std::span<const RowCrossing> crossed);
  void add_degenerate(std::size_t row, const TriangleCrossing& crossing);
  std::uint8_t* on_surface();
  void sum_prefixes(std::size_t row);

  std::size_t rows_, samples_;
  std::span<double> crossings_;
  const Diagnostics* diagnostics_;
  std::mutex mutex_;
  std::atomic<std::uint64_t> ties_ = 0;
  // Few crossings are kept as they come, until they are arranged by row.
  std::vector<std::vector<RowCrossing>> parts_;
  std::size_t kept_ = 0;
  std::vector<std::size_t> begin_;  // per row, into prefixes_; and the end
  std::vector<Prefix> prefixes_;
  // Many are added up: crossings_[i] is then what is said of the samples of its row up to i and no further.
  std::atomic<bool> dense_ = false;
  std::vector<std::uint8_t> own_on_surface_;  // where there are no diagnostics; empty as long as nothing is on it
  std::atomic<std::uint8_t*> on_surface_ = nullptr;
};

}  // namespace raycone
