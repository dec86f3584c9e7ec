#include "core/lattice_sums.h"

#include <algorithm>
#include <atomic>

#include "core/threads.h"

namespace raycone {
namespace {

// Where rows hold differences: entry i is what is said of the samples up to i and no further. Turns them into sums.
// Most rows hold few: eight zeros at a time are looked at together.
template <class Number>
void sum_from_behind(std::span<Number> row) {
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
    std::fill_n(numbers.begin() + static_cast<std::ptrdiff_t>(begin), end - begin, Number{0});
  });
}

template <class Number>
void add_to(Number& sum, Number term) {
  std::atomic_ref(sum).fetch_add(term, std::memory_order_relaxed);
}

}  // namespace

LatticeSums::LatticeSums(std::size_t rows, std::size_t samples, std::span<double> crossings,
                         const Diagnostics* diagnostics)
    : samples_(samples),
      crossings_(crossings),
      diagnostics_(diagnostics),
      own_on_surface_(diagnostics ? 0 : rows * samples),
      on_surface_(diagnostics ? diagnostics->on_surface : std::span(own_on_surface_)) {
  set_to_zero(crossings_);
  if (!diagnostics_) return;
  set_to_zero(diagnostics_->degenerate);
  set_to_zero(diagnostics_->on_surface);
}

void LatticeSums::add(std::size_t row, const TriangleCrossing& crossing) {
  const std::size_t first = row * samples_;
  if (crossing.crossed > 0 && !crossings_.empty()) {
    add_to(crossings_[first + crossing.crossed - 1], static_cast<double>(crossing.sigma));
  }
  if (diagnostics_ && crossing.ties > 0 && crossing.met > 0) {
    add_to(diagnostics_->degenerate[first + crossing.met - 1], std::int64_t{crossing.ties});
  }
  for (std::size_t i = crossing.on_begin; i < crossing.on_end; ++i) {
    std::atomic_ref(on_surface_[first + i]).store(1, std::memory_order_relaxed);
  }
}

std::uint64_t LatticeSums::finish(std::size_t row) {
  const std::size_t first = row * samples_;
  if (!crossings_.empty()) sum_from_behind(crossings_.subspan(first, samples_));
  if (diagnostics_) {
    sum_from_behind(diagnostics_->degenerate.subspan(first, samples_));
    std::ranges::transform(crossings_.subspan(first, samples_), diagnostics_->crossings.subspan(first).begin(),
                           [](double n) { return static_cast<std::int64_t>(n); });
  }
  const std::span<const std::uint8_t> on_surface = on_surface_.subspan(first, samples_);
  return static_cast<std::uint64_t>(std::count(on_surface.begin(), on_surface.end(), std::uint8_t{1}));
}

}  // namespace raycone
