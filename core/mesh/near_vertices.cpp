#include "core/mesh/near_vertices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace raycone {
namespace {

constexpr std::uint32_t kNoVertex = std::numeric_limits<std::uint32_t>::max();

struct RunRange {
  std::uint32_t first, last;  // both belong to it
};

// The coordinates along one axis in runs that are no longer than the distance, and as long as they can be from below.
// They are compared by the differences that is_near() takes: however these are rounded, what is near lies in the same
// run or a neighbouring one, as the start of the next but one is too far from any number below the run between.
class Runs {
 public:
  Runs(const std::vector<Vec3>& vertices, int axis, double distance) : distance_(distance) {
    std::vector<double> all;
    all.reserve(vertices.size());
    for (const Vec3& p : vertices) {
      if (is_finite(p)) all.push_back(p[axis]);
    }
    std::sort(all.begin(), all.end());
    for (const double x : all) {
      if (runs_.empty() || x - runs_.back().first > distance) runs_.push_back({x, x});
      runs_.back().last = x;
    }
  }

  // The run that holds x, a coordinate of a vertex.
  [[nodiscard]] std::uint32_t run_of(double x) const {
    const auto above =
        std::upper_bound(runs_.begin(), runs_.end(), x, [](double y, const CoordinateRun& r) { return y < r.first; });
    return static_cast<std::uint32_t>(above - runs_.begin() - 1);
  }

  // Those that hold a coordinate near x, which is in `run`; and the run itself.
  [[nodiscard]] RunRange near(double x, std::uint32_t run) const {
    const bool below = run > 0 && x - runs_[run - 1].last <= distance_;
    const bool above = run + 1 < runs_.size() && runs_[run + 1].first - x <= distance_;
    return {run - (below ? 1 : 0), run + (above ? 1 : 0)};
  }

 private:
  struct CoordinateRun {
    double first, last;
  };
  double distance_;
  std::vector<CoordinateRun> runs_;
};

// Representatives by cells, a run of each axis: eight at most are in one, since its eighths are less than the distance
// across.
class RepresentativeCells {
 public:
  RepresentativeCells(const std::vector<Vec3>& vertices, double distance)
      : distance_(distance),
        runs_{Runs(vertices, 0, distance), Runs(vertices, 1, distance), Runs(vertices, 2, distance)} {
    cells_.reserve(vertices.size());
    for (const Vec3& p : vertices) {
      if (is_finite(p)) cells_.push_back({index_of(p), kNoVertex});
    }
    std::sort(cells_.begin(), cells_.end(),
              [](const OccupiedCell& a, const OccupiedCell& b) { return a.index < b.index; });
    const auto same = [](const OccupiedCell& a, const OccupiedCell& b) { return a.index == b.index; };
    cells_.erase(std::unique(cells_.begin(), cells_.end(), same), cells_.end());
  }

  // The first representative near p, or kNoVertex. None is above p along x.
  [[nodiscard]] std::uint32_t find(const std::vector<Vec3>& representatives, const Vec3& p) const {
    const CellIndex at = index_of(p);
    const RunRange ys = runs_[1].near(p.y, at[1]), zs = runs_[2].near(p.z, at[2]);
    std::uint32_t first = kNoVertex;
    for (std::uint32_t x = runs_[0].near(p.x, at[0]).first; x <= at[0]; ++x) {
      for (std::uint32_t y = ys.first; y <= ys.last; ++y) {
        for (auto cell = cell_from({x, y, zs.first}); cell != cells_.end() && cell->index <= CellIndex{x, y, zs.last};
             ++cell) {
          for (std::uint32_t r = cell->newest; r != kNoVertex; r = older_[r]) {
            if (is_near(representatives[r], p, distance_)) first = std::min(first, r);
          }
        }
      }
    }
    return first;
  }

  // `index`: the number of representatives so far.
  void add(const Vec3& p, std::uint32_t index) {
    older_.resize(index + std::size_t{1}, kNoVertex);
    if (is_finite(p)) older_[index] = std::exchange(cell_from(index_of(p))->newest, index);
  }

 private:
  using CellIndex = std::array<std::uint32_t, 3>;  // runs along x, y and z
  struct OccupiedCell {
    CellIndex index;
    std::uint32_t newest;  // representative in it
  };

  [[nodiscard]] CellIndex index_of(const Vec3& p) const {
    return {runs_[0].run_of(p.x), runs_[1].run_of(p.y), runs_[2].run_of(p.z)};
  }
  static bool is_before(const OccupiedCell& cell, const CellIndex& index) { return cell.index < index; }
  [[nodiscard]] std::vector<OccupiedCell>::const_iterator cell_from(const CellIndex& index) const {
    return std::lower_bound(cells_.begin(), cells_.end(), index, is_before);
  }
  [[nodiscard]] std::vector<OccupiedCell>::iterator cell_from(const CellIndex& index) {
    return std::lower_bound(cells_.begin(), cells_.end(), index, is_before);
  }

  double distance_;
  std::array<Runs, 3> runs_;
  std::vector<OccupiedCell> cells_;   // all that hold vertices
  std::vector<std::uint32_t> older_;  // per representative: the one before in its cell
};

}  // namespace

bool is_near(const Vec3& a, const Vec3& b, double distance) {
  const Vec3 d = a - b;
  const auto within = [&](double x) { return std::abs(x) <= distance; };
  return within(d.x) && within(d.y) && within(d.z) && std::hypot(d.x, d.y, d.z) <= distance;
}

Representatives representatives_within(const std::vector<Vec3>& vertices, double distance) {
  std::vector<std::uint32_t> order(vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
    const auto order_of_two = lexicographic_order(vertices[i], vertices[j]);
    return order_of_two != 0 ? order_of_two < 0 : i < j;
  });
  RepresentativeCells cells(vertices, distance);
  Representatives result{{}, std::vector<std::uint32_t>(vertices.size())};
  for (const std::uint32_t i : order) {
    const Vec3& p = vertices[i];
    std::uint32_t found = is_finite(p) ? cells.find(result.vertices, p) : kNoVertex;
    if (found == kNoVertex) {
      found = static_cast<std::uint32_t>(result.vertices.size());
      cells.add(p, found);
      result.vertices.push_back(p);
    }
    result.of[i] = found;
  }
  return result;
}

}  // namespace raycone
