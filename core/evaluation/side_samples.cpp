#include "core/evaluation/side_samples.h"

#include "core/data/space_curve.h"

namespace raycone {

std::uint64_t SideSamples::code_of(const Index& sample) {
  std::uint64_t code = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) code |= spread_bits(sample[axis]) << axis;
  return code;
}

template <class Visit>
bool SideSamples::for_each_run(const SampleBox& box, Crossings which, const Visit& visit) const {
  for (std::size_t k = box.begin[2]; k < box.end[2]; ++k) {
    for (std::size_t j = box.begin[1]; j < box.end[1]; ++j) {
      const std::size_t row = row_of(j, k), index = row * rows_.xs.size();
      const bool all =
          crossings_.runs(row).for_each(box.begin[0], box.end[0], [&](std::size_t begin, std::size_t end, double n) {
            if (which == Crossings::kMesh) return visit(index + begin, index + end, n);
            return cap_crossings_.runs(row).for_each(begin, end, [&](std::size_t from, std::size_t to, double caps) {
              return visit(index + from, index + to, n - caps);
            });
          });
      if (!all) return false;
    }
  }
  return true;
}

bool SideSamples::decide(const SampleBox& box, Crossings which, double rest, double needed) const {
  return for_each_run(box, which, [&](std::size_t begin, std::size_t end, double n) {
    const double w = n + rest;
    if (!is_certain(w, needed)) return false;
    std::fill(place(begin), place(end), holds(mesh_rule_.rule(), w) ? 1 : 0);
    return true;
  });
}

bool SideSamples::decide_together(std::size_t index, double crossings, std::span<const double> rest,
                                  double needed) const {
  double least = rest[0], most = rest[0];
  bool are_known = true;  // no NaN
  for (const double value : rest) {
    least = std::min(least, value), most = std::max(most, value);
    are_known &= value == value;
  }
  const double middle = crossings + (least + most) / 2;
  const double off = needed + (most - least) / 2 + kSumsRound * (1 + std::abs(least) + std::abs(most));
  if (!are_known || !is_certain(middle, off)) return false;
  std::fill(place(index), place(index + rest.size()), holds(mesh_rule_.rule(), middle) ? 1 : 0);
  return true;
}

// Some samples at a time, where all of them are on the same side.
void SideSamples::decide_row(const Index& first, Crossings which, std::span<const double> rest, double needed,
                             std::vector<SampleBox>& undecided) const {
  constexpr std::size_t kTogether = 16;
  const std::size_t x = first[0], j = first[1], k = first[2];
  const std::size_t row = row_of(j, k) * rows_.xs.size();
  const SampleBox part{first, {x + rest.size(), j + 1, k + 1}};
  for_each_run(part, which, [&](std::size_t begin, std::size_t end, double n) {
    for (std::size_t some = begin - row; some < end - row; some += kTogether) {
      const std::size_t last = std::min(some + kTogether, end - row);
      if (decide_together(row + some, n, rest.subspan(some - x, last - some), needed)) continue;
      for (std::size_t i = some; i < last; ++i) {
        const double w = n + rest[i - x];
        if (is_certain(w, needed)) {
          sides_[row + i] = holds(mesh_rule_.rule(), w) ? 1 : 0;
        } else if (i > begin - row && !undecided.empty() && undecided.back().end == Index{i, j + 1, k + 1}) {
          ++undecided.back().end[0];  // of the same run
        } else {
          undecided.push_back({{i, j, k}, {i + 1, j + 1, k + 1}});
        }
      }
    }
    return true;
  });
}

// Samples that share a ray are cheaper together.
void SideSamples::evaluate_rows(const SampleBox& box) const {
  SideSetter setter(mesh_rule_, sides_);
  RowTiles tiles(mesh_, [&setter](std::size_t index, const Vec3& q, double w) { setter.set(index, q, w); });
  for (std::size_t k = box.begin[2]; k < box.end[2]; ++k) {
    for (std::size_t j = box.begin[1]; j < box.end[1]; ++j) {
      const std::size_t row = row_of(j, k);
      tiles.begin_row(box.side(0));
      crossings_.runs(row).for_each(box.begin[0], box.end[0], [&](std::size_t begin, std::size_t end, double crossed) {
        for (std::size_t i = begin; i < end; ++i) {
          tiles.add(row * rows_.xs.size() + i, rows_.query({i, j, k}), static_cast<std::int64_t>(crossed));
        }
        return true;
      });
    }
  }
  tiles.finish();
  setter.finish();
}

// The far field takes much the same way for neighbours.
void SideSamples::evaluate_each(std::span<const SampleBox> boxes) const {
  struct Place {
    std::uint64_t code;
    Index sample;
  };
  std::vector<Place> places;
  for (const SampleBox& box : boxes) {
    for (std::size_t k = box.begin[2]; k < box.end[2]; ++k) {
      for (std::size_t j = box.begin[1]; j < box.end[1]; ++j) {
        for (std::size_t i = box.begin[0]; i < box.end[0]; ++i) places.push_back({code_of({i, j, k}), {i, j, k}});
      }
    }
  }
  std::ranges::sort(places, {}, &Place::code);
  SideSetter setter(mesh_rule_, sides_);
  LatticeTile tile(mesh_, [&setter](std::size_t index, const Vec3& q, double w) { setter.set(index, q, w); });
  for (const Place& place : places) {
    const auto& [i, j, k] = place.sample;
    add(tile, row_of(j, k) * rows_.xs.size() + i, place.sample);
  }
  tile.evaluate();
  setter.finish();
}

}  // namespace raycone
