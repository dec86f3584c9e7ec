#include "core/crossings/lattice_sums.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/machine/threads.h"

namespace raycone {
namespace {

// A crossing that is kept takes 12 bytes, and 8 more while it is arranged.
constexpr std::size_t kSamplesPerKept = 16;
// Rows this short have about as many entries in a table of rows as samples.
constexpr std::size_t kShortRow = 16;
// Crossings of one thread that wait to be taken.
constexpr std::size_t kHandful = 4096;

// entry i: what is said of the samples up to i and no further. Turns that into sums. Most rows hold few entries: eight
// zeros are looked at together.
template <class Number>
void suffix_sums(std::span<Number> row) {
  constexpr std::size_t kTogether = 8;
  Number sum{0};
  std::size_t end = row.size();
  for (; end >= kTogether; end -= kTogether) {
    const std::span<Number> some = row.subspan(end - kTogether, kTogether);
    bool any = false;
    for (std::size_t i = 0; i < kTogether; ++i) any |= some[i] != Number{0};
    for (std::size_t i = kTogether; any && i-- > 0;) some[i] = sum += some[i];
    if (!any) std::fill(some.begin(), some.end(), sum);
  }
  while (end-- > 0) row[end] = sum += row[end];
}

template <class Number>
void set_to_zero(std::span<Number> numbers) {
  constexpr std::size_t kGrain = std::size_t{1} << 16;
  parallel_for(numbers.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::ranges::fill(numbers.subspan(begin, end - begin), Number{0});
  });
}

// Whether crossings are added up from the first one on.
bool is_dense(std::size_t rows, std::size_t samples) {
  constexpr std::size_t kIndexable = std::numeric_limits<std::uint32_t>::max();
  return samples < kShortRow || samples > kIndexable || rows > kIndexable;
}

template <class Number>
void add_to(Number& sum, Number term) {
  std::atomic_ref(sum).fetch_add(term, std::memory_order_relaxed);
}

}  // namespace

LatticeSums::LatticeSums(std::size_t rows, std::size_t samples, std::span<double> crossings,
                         const Diagnostics* diagnostics)
    : rows_(rows), samples_(samples), counts_(!crossings.empty()), crossings_(crossings), diagnostics_(diagnostics) {
  if (is_dense(rows, samples)) {
    set_to_zero(crossings_);
    dense_ = true;
  }
  if (!diagnostics_) return;
  set_to_zero(diagnostics_->degenerate);
  set_to_zero(diagnostics_->on_surface);
  on_surface_ = diagnostics_->on_surface.data();
}

LatticeSums::LatticeSums(std::size_t rows, std::size_t samples, OnSurface on_surface)
    : rows_(rows), samples_(samples), counts_(true), marks_(on_surface == OnSurface::kCount), diagnostics_(nullptr) {
  if (is_dense(rows, samples)) make_dense();
}

void LatticeSums::Collector::count(std::size_t row, const TriangleCrossing& crossing) {
  if (sums_.dense_.load(std::memory_order_acquire)) {
    add_to(sums_.crossings_[row * sums_.samples_ + crossing.crossed - 1], static_cast<double>(crossing.sigma));
    return;
  }
  waiting_.push_back({static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(crossing.crossed), crossing.sigma});
  if (waiting_.size() == kHandful) sums_.take(waiting_);
}

void LatticeSums::Collector::finish() {
  sums_.take(waiting_);
  sums_.ties_ += std::exchange(ties_, 0);
}

// Empties `crossed`.
void LatticeSums::take(std::vector<RowCrossing>& crossed) {
  if (crossed.empty()) return;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!dense_ && kept_ + crossed.size() > rows_ * samples_ / kSamplesPerKept) make_dense();
    if (!dense_) {
      kept_ += crossed.size();
      parts_.emplace_back(crossed.begin(), crossed.end());
      crossed.clear();
    }
  }
  add_to_samples(crossed);
  crossed.clear();
}

// On one thread: others may wait for it.
void LatticeSums::make_dense() {
  if (crossings_.empty()) {
    own_crossings_.resize(rows_ * samples_);
    crossings_ = own_crossings_;
  } else {
    std::ranges::fill(crossings_, 0.0);
  }
  for (const std::vector<RowCrossing>& part : parts_) add_to_samples(part);
  parts_ = {};
  dense_.store(true, std::memory_order_release);
}

void LatticeSums::add_to_samples(std::span<const RowCrossing> crossed) {
  for (const RowCrossing& c : crossed) {
    add_to(crossings_[c.row * samples_ + c.samples - 1], static_cast<double>(c.sigma));
  }
}

void LatticeSums::mark(std::size_t row, const TriangleCrossing& crossing) {
  const std::size_t first = row * samples_;
  if (diagnostics_ && crossing.ties > 0 && crossing.met > 0) {
    add_to(diagnostics_->degenerate[first + crossing.met - 1], std::int64_t{crossing.ties});
  }
  if (crossing.on_begin == crossing.on_end) return;
  std::uint8_t* const flags = on_surface();
  for (std::size_t i = crossing.on_begin; i < crossing.on_end; ++i) {
    std::atomic_ref(flags[first + i]).store(1, std::memory_order_relaxed);
  }
}

// Flags of all samples.
std::uint8_t* LatticeSums::on_surface() {
  if (std::uint8_t* const flags = on_surface_.load(std::memory_order_acquire)) return flags;
  const std::lock_guard<std::mutex> lock(mutex_);
  if (own_on_surface_.empty()) own_on_surface_.resize(rows_ * samples_);
  on_surface_.store(own_on_surface_.data(), std::memory_order_release);
  return own_on_surface_.data();
}

void LatticeSums::arrange() {
  if (dense_ || !counts_) return;
  prefixes_ = {rows_, [&](const auto& emit) {
                 for (const std::vector<RowCrossing>& part : parts_) {
                   for (const RowCrossing& c : part) emit(c.row, RowPrefix{c.samples, c.sigma});
                 }
               }};
  parts_ = {};
}

void LatticeSums::sum_prefixes(std::size_t row) {
  const std::span<RowPrefix> prefixes = prefixes_[row];
  std::ranges::sort(prefixes, std::ranges::greater{}, &RowPrefix::samples);
  const std::span<double> sums = crossings_.subspan(row * samples_, samples_);
  double sum = 0.0;
  auto end = sums.end();
  for (const RowPrefix& e : prefixes) {
    const auto begin = sums.begin() + static_cast<std::ptrdiff_t>(e.samples);
    std::fill(begin, end, sum);
    sum += e.crossings;
    end = begin;
  }
  std::fill(sums.begin(), end, sum);
}

void LatticeSums::make_runs(std::size_t row) {
  const std::span<RowPrefix> prefixes = prefixes_[row];
  std::ranges::sort(prefixes, std::ranges::less{}, &RowPrefix::samples);
  std::int32_t sum = 0;
  for (std::size_t i = prefixes.size(); i-- > 0;) prefixes[i].crossings = sum += prefixes[i].crossings;
}

std::uint64_t LatticeSums::finish(std::size_t row) {
  const std::size_t first = row * samples_;
  if (counts_) {
    if (dense_) {
      suffix_sums(crossings_.subspan(first, samples_));
    } else if (crossings_.empty()) {
      make_runs(row);
    } else {
      sum_prefixes(row);
    }
  }
  if (diagnostics_) {
    suffix_sums(diagnostics_->degenerate.subspan(first, samples_));
    std::ranges::transform(crossings_.subspan(first, samples_), diagnostics_->crossings.subspan(first).begin(),
                           [](double n) { return static_cast<std::int64_t>(n); });
  }
  const std::uint8_t* const flags = on_surface_.load(std::memory_order_relaxed);
  return flags ? static_cast<std::uint64_t>(std::count(flags + first, flags + first + samples_, std::uint8_t{1})) : 0;
}

}  // namespace raycone
