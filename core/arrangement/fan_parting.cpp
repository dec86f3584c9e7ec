#include "core/arrangement/fan_parting.h"

#include <algorithm>
#include <functional>

namespace raycone {
namespace {

std::vector<Vec3> ways_along_others(const std::vector<FanCone>& fans, std::size_t n) {
  std::vector<Vec3> others;
  for (std::size_t m = 0; m < fans.size(); ++m) {
    if (m != n) others.push_back(fans[m].way_along());
  }
  return others;
}

// Against the perturbation: a small number of times as far along y as along x, and along z as along y, as faces are
// hardly ever nearer to level without being so.
Vec3 way_against(double along_y, double along_z) {
  constexpr double kMuchLess = 0x1p-5;
  const Vec3 way{-1.0, -kMuchLess * along_y, -kMuchLess * kMuchLess * along_y * along_z};
  return (1.0 / norm(way)) * way;
}

// Whether an axis alone would do is asked of ways a bit off it: along it, faces may be level.
constexpr double kAcross = 0x1p-6, kLessAcross = 0x1p-8;

bool leaves_all(const std::vector<FanCone>& fans, std::size_t n, const Vec3& way) {
  for (std::size_t m = 0; m < fans.size(); ++m) {
    if (m != n && !fans[n].leaves(fans[m], way)) return false;
  }
  return true;
}

// Along an axis alone, a fan leaves faces in their planes that it need not move: samples may be some roundings off
// them. Nothing where it takes more than that, whichever way the others go.
std::optional<Vec3> way_along_one_axis(const std::vector<FanCone>& fans, std::size_t n) {
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 way;
    way[axis] = -1.0;
    bool does = fans[n].goes_against_perturbation(way);
    for (const double first : {kAcross, -kAcross}) {
      for (const double second : {kLessAcross, -kLessAcross}) {
        Vec3 near = way;
        near[(axis + 1) % 3] = first;
        near[(axis + 2) % 3] = second;
        does = does && leaves_all(fans, n, near);
      }
    }
    if (does) return way;
  }
  return std::nullopt;
}

// The way of a fan. Farther along y, or z, where that takes it off all others and the axis before does not: so if
// different fans are ahead at the two ends of an edge, they pass each other between these where no solid is. Not much
// farther: of a few fans, one that is more steps ahead stays ahead along all axes.
Vec3 way_of(const std::vector<FanCone>& fans, std::size_t n) {
  constexpr double kFarther = 1.25;
  if (const std::optional<Vec3> way = way_along_one_axis(fans, n)) return *way;
  const bool x = leaves_all(fans, n, {-1.0, kAcross, kLessAcross});
  const bool y = leaves_all(fans, n, {kLessAcross, -1.0, kAcross});
  const bool z = leaves_all(fans, n, {kAcross, kLessAcross, -1.0});
  return way_against(y && !x ? kFarther : 1.0, z && !y ? kFarther : 1.0);
}

// From the one that stays to the one that goes farthest. Nothing where one may not leave another that is before it.
std::optional<std::vector<std::size_t>> order_against(const std::vector<FanCone>& fans, const FanSteps& steps) {
  const std::size_t count = fans.size();
  const Vec3 way = way_against(1.0, 1.0);
  std::vector<std::vector<bool>> leaves(count, std::vector<bool>(count, false));
  std::vector<std::pair<int, std::size_t>> ranks;  // how many each is ahead of, and which it is
  for (std::size_t n = 0; n < count; ++n) {
    for (std::size_t m = 0; m < count; ++m) leaves[n][m] = n != m && fans[n].leaves(fans[m], way);
    ranks.emplace_back(0, n);
  }
  for (std::size_t n = 0; n < count; ++n) {
    for (std::size_t m = 0; m < n; ++m) {
      const int ends = steps.corners_ahead(fans[n], fans[m]);
      const bool is_ahead = ends != 0 ? ends > 0 : fans[n].lead(fans[m], way) > 0.0;
      ++ranks[leaves[n][m] && (is_ahead || !leaves[m][n]) ? n : m].first;
    }
  }
  std::ranges::sort(ranks);
  std::vector<std::size_t> order;
  for (const auto& [ahead_of, n] : ranks) {
    if (!std::ranges::all_of(order, [&, n = n](std::size_t before) { return leaves[n][before]; })) return std::nullopt;
    order.push_back(n);
  }
  return order;
}

}  // namespace

std::optional<FanParting> parting_inside(const std::vector<FanCone>& fans, double distance) {
  FanParting parting;
  std::vector<std::size_t> stuck;
  for (std::size_t n = 0; n < fans.size(); ++n) {
    const bool may_stay = stuck.empty() && n + 1 == fans.size();
    const std::optional<Vec3> way = may_stay ? std::nullopt : fans[n].way_from(ways_along_others(fans, n));
    if (way) {
      parting.moves.push_back({n, distance * *way});
    } else {
      stuck.push_back(n);
    }
  }
  // One stays: the one that cannot be cut off, or that with most faces.
  std::vector<std::optional<double>> sides(fans.size());
  for (const std::size_t n : stuck) sides[n] = fans[n].side_of_lid();
  std::ranges::stable_sort(stuck, std::greater(),
                           [&](std::size_t n) { return std::pair(!sides[n], fans[n].faces().size()); });
  for (std::size_t i = 1; i < stuck.size(); ++i) {
    if (!sides[stuck[i]]) return std::nullopt;
    parting.cuts.push_back({stuck[i], *sides[stuck[i]]});
  }
  return parting;
}

void FanSteps::note(std::uint32_t vertex, const std::vector<FanCone>& fans, const std::vector<std::size_t>& order) {
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (const std::uint32_t face : fans[order[i]].faces()) steps_[{face, vertex}] = static_cast<int>(i);
  }
}

int FanSteps::corners_ahead(const FanCone& one, const FanCone& other) const {
  int ahead = 0;
  for (const std::uint32_t face : one.faces()) {
    for (const std::uint32_t corner : mesh_.triangles[face]) {
      const auto here = steps_.find({face, corner});
      if (here == steps_.end()) continue;
      for (const std::uint32_t beside : other.faces()) {
        const auto there = steps_.find({beside, corner});
        if (there != steps_.end()) ahead += (here->second > there->second) - (here->second < there->second);
      }
    }
  }
  return ahead;
}

std::optional<FanParting> parting_against_perturbation(const std::vector<FanCone>& fans, double distance,
                                                       const FanSteps& steps) {
  std::optional<std::vector<std::size_t>> order = order_against(fans, steps);
  if (!order) return std::nullopt;
  FanParting parting;
  for (std::size_t i = 1; i < order->size(); ++i) {
    const std::size_t n = (*order)[i];
    parting.moves.push_back({n, static_cast<double>(i) * distance * way_of(fans, n)});
  }
  parting.order = std::move(*order);
  return parting;
}

}  // namespace raycone
