#include "app/fields/label_volume.h"

#include <limits>

#include "core/machine/threads.h"

namespace raycone {
namespace {

// Bytes of a label.
std::size_t label_bytes(std::size_t parts) {
  if (parts <= std::numeric_limits<std::uint8_t>::max()) return sizeof(std::uint8_t);
  return parts <= std::numeric_limits<std::uint16_t>::max() ? sizeof(std::uint16_t) : sizeof(std::int32_t);
}

}  // namespace

LabelVolume::LabelVolume(const Lattice& lattice, std::size_t parts) : lattice_(lattice), parts_(parts) {
  const auto samples = static_cast<std::size_t>(whole(lattice).size());
  switch (label_bytes(parts)) {
    case 1:
      labels_ = std::vector<std::uint8_t>(samples);
      break;
    case 2:
      labels_ = std::vector<std::uint16_t>(samples);
      break;
    default:
      labels_ = std::vector<std::int32_t>(samples);
  }
}

double LabelVolume::bytes(const Lattice& lattice, std::size_t parts) {
  return lattice.samples() * static_cast<double>(label_bytes(parts));
}

template <typename Visit>
void LabelVolume::for_rows(const LatticeBlock& block, const Visit& visit) const {
  const auto length = static_cast<std::size_t>(block.counts[0]);
  const std::size_t rows = static_cast<std::size_t>(block.counts[1]) * static_cast<std::size_t>(block.counts[2]);
  const std::size_t grain = (std::size_t{1} << 14) / length + 1;
  parallel_for_each(rows, grain, [&](std::size_t row) {
    visit(whole(lattice_).number_of(block.index_of(row * length)), row * length, length);
  });
}

void LabelVolume::add(const LatticeBlock& block, std::span<const std::uint8_t> inside, std::int32_t label,
                      PartPriority priority) {
  const bool keeps = priority == PartPriority::kFirst;
  const auto add_to = [&](auto& labels) {
    using Label = typename std::decay_t<decltype(labels)>::value_type;
    for_rows(block, [&](std::size_t where, std::size_t n, std::size_t count) {
      for (std::size_t i = 0; i < count; ++i) {
        Label& here = labels[where + i];
        if (inside[n + i] != 0 && !(keeps && here != 0)) here = static_cast<Label>(label);
      }
    });
  };
  std::visit(add_to, labels_);
}

void LabelVolume::copy(const LatticeBlock& block, std::span<std::int32_t> labels) const {
  const auto copy_from = [&](const auto& from) {
    for_rows(block, [&](std::size_t where, std::size_t n, std::size_t count) {
      for (std::size_t i = 0; i < count; ++i) labels[n + i] = static_cast<std::int32_t>(from[where + i]);
    });
  };
  std::visit(copy_from, labels_);
}

std::int32_t LabelVolume::at(std::uint64_t number) const {
  return std::visit([&](const auto& labels) { return static_cast<std::int32_t>(labels[number]); }, labels_);
}

std::vector<std::uint64_t> LabelVolume::counts() const {
  std::vector<std::uint64_t> counts(parts_ + 1);
  const auto count = [&](const auto& labels) {
    for (const auto label : labels) ++counts[static_cast<std::size_t>(label)];
  };
  std::visit(count, labels_);
  return counts;
}

}  // namespace raycone
