// Where an evaluation leaves what it finds of samples.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "core/data/diagnostics.h"

namespace raycone {

struct ValueOutputs {
  std::span<double> values;  // winding numbers, one for each sample
  std::atomic<std::uint64_t>* done = nullptr;
  const Diagnostics* diagnostics = nullptr;

  // Has `done`, where given, grow by so many samples.
  void count_done(std::uint64_t samples) const {
    if (done) done->fetch_add(samples, std::memory_order_relaxed);
  }
};

}  // namespace raycone
