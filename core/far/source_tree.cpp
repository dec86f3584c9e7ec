#include "core/far/source_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "core/data/box.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

constexpr std::size_t kOrders = kMultipoleOrder;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1e-12;       // more than what distances and radii round, relative
constexpr double kSumRounding = 0x1p-20;  // and sums of areas, of up to 2^32 triangles
constexpr double kSmallest = 0x1p-150;    // radius: smaller nodes are never far, or their powers would underflow
constexpr double kMostRatio = 0.97;       // of radius and distance, beyond which the series is of no use
// 1 / (4 pi (1 - kMostRatio)^2), rounded up: times area over distance squared, what triangles contribute at most.
constexpr double kNeglected = 100;

Box box_of(const SolidTriangle& t) { return box_of(t.a, t.b, t.c); }

// No less than the area, but for some roundings of it. A product of differences says nothing of needles; where that is
// all there is, it is rounded up.
double area_bound(const SolidTriangle& t) {
  const double exact = safe_norm(t.normal) / 2;
  if (!std::isnan(exact)) return exact;
  const Vec3 ab = t.b - t.a, ac = t.c - t.a;
  return safe_norm(cross(ab, ac)) / 2 + 0x1p-49 * safe_norm(ab) * safe_norm(ac);
}

// Of the coefficients up to this degree.
std::size_t numbers_of(int order) { return 2 * (coefficient_index(order, order) + 1); }

// The highest degree, up to `most`, that is not dearer than the triangles one by one, per sample: a triangle takes
// about as long as 20 terms.
int worthwhile_order(std::size_t triangles, int most) {
  const double terms = 20.0 * static_cast<double>(triangles) - 30;
  int order = 0;
  while (order < most && (order + 2) * (order + 3) <= 2 * terms) ++order;
  return order;
}

// The largest rho, for each degree p at which the series is cut off, for which the error is at most `share`; 0: none.
std::array<double, kOrders + 1> largest_ratios(const SourceNode& node, double share) {
  constexpr double kFarthest = 0x1p-60;
  constexpr int kSteps = 14;  // of bisection in the exponent
  const auto known = static_cast<std::size_t>(node.bounds.order), orders = static_cast<std::size_t>(node.order);
  const double area = node.area / node.unit / node.unit, radius = node.radius / node.unit;
  const auto error_at = [&](const std::array<double, kOrders + 1>& rho) {
    std::array<double, kOrders + 1> sum{};
    for (std::size_t n = known; n >= 1; --n) {
      for (std::size_t p = 1; p <= orders; ++p) {
        sum[p] = rho[p] * (sum[p] + (n <= p ? node.bounds.evaluation[n] : node.bounds.size[n]));
      }
    }
    for (std::size_t p = 1; p <= orders; ++p) {
      sum[p] = rho[p] * sum[p] + beyond_multipoles(area, radius, node.bounds.order, rho[p]);
    }
    return sum;
  };
  std::array<double, kOrders + 1> low, high;
  low.fill(kFarthest);
  high.fill(kMostRatio / radius);
  const auto at_low = error_at(low);
  for (int step = 0; step < kSteps; ++step) {
    std::array<double, kOrders + 1> between;
    for (std::size_t p = 0; p <= orders; ++p) between[p] = std::sqrt(low[p] * high[p]);
    const auto error = error_at(between);
    for (std::size_t p = 1; p <= orders; ++p) (error[p] * (1 + kRounding) <= share ? low : high)[p] = between[p];
  }
  for (std::size_t p = 1; p <= orders; ++p) {
    if (!(at_low[p] * (1 + kRounding) <= share)) low[p] = 0;
  }
  return low;
}

}  // namespace

// What the tree is built of, in place of the triangles themselves.
struct SourceTree::PlacedTriangle {
  Box box;
  std::uint32_t number;
};

// Along the axis along which the middles of their boxes are farthest apart; of many, only so far that the first half
// comes first.
void SourceTree::sort_by_middles(std::span<PlacedTriangle> placed) {
  constexpr std::size_t kMany = 64;
  Box middles = empty_box();
  for (const PlacedTriangle& t : placed) extend(middles, middle(t.box));
  const int axis = longest_axis(middles);
  std::vector<std::pair<double, std::uint32_t>> order;
  order.reserve(placed.size());
  for (std::uint32_t i = 0; i < placed.size(); ++i) order.emplace_back(middle(placed[i].box, axis), i);
  if (placed.size() > kMany) {
    std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(placed.size() / 2), order.end());
  } else {
    std::sort(order.begin(), order.end());
  }
  std::vector<PlacedTriangle> sorted;
  sorted.reserve(placed.size());
  for (const auto& [at, i] : order) sorted.push_back(placed[i]);
  std::ranges::copy(sorted, placed.begin());
}

SourceTree::SourceTree(std::vector<SolidTriangle> triangles, double tolerance, SimdLevel level, Detail detail)
    : triangles_(std::move(triangles)), tolerance_(tolerance), detail_(detail), moments_(moment_kernel(level)) {
  if (triangles_.empty()) return;
  if (triangles_.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw std::length_error("raycone: more than 4294967295 sources of a far field");
  }
  build();
  expand();
}

void SourceTree::build() {
  nodes_.reserve(8 * triangles_.size() / detail_.leaf + 1);
  std::vector<PlacedTriangle> placed;
  placed.reserve(triangles_.size());
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) placed.push_back({box_of(triangles_[i]), i});
  build_node(placed, 0);
  std::vector<SolidTriangle> ordered;
  ordered.reserve(triangles_.size());
  for (const PlacedTriangle& t : placed) ordered.push_back(triangles_[t.number]);
  triangles_ = std::move(ordered);
  std::size_t coefficients = 0;
  corners_ = SharedCorners(triangles_);
  constexpr std::size_t kPerTask = 64;  // nodes
  parallel_for_each(nodes_.size(), kPerTask, [&](std::size_t n) { measure(nodes_[n]); });
  for (SourceNode& node : nodes_) {
    node.first_chunk = static_cast<std::uint32_t>(corners_.chunks());
    corners_.add_group(node.own_end - node.begin, GroupLooks::kAny);
    node.last_chunk = static_cast<std::uint32_t>(corners_.chunks());
    node.first_coefficient = coefficients;
    if (node.order > 0) coefficients += numbers_of(node.order);
  }
  coefficients_ = std::make_unique_for_overwrite<double[]>(coefficients);
}

// Triangles that are large beside the node stay with it; the others are halved by their middles.
void SourceTree::build_node(std::span<PlacedTriangle> placed, std::uint32_t begin) {
  const auto number = static_cast<std::uint32_t>(nodes_.size());
  const auto end = begin + static_cast<std::uint32_t>(placed.size());
  nodes_.emplace_back();
  nodes_[number].begin = begin;
  nodes_[number].end = nodes_[number].own_end = end;
  if (placed.size() > detail_.leaf) {
    Box box = placed.front().box;
    for (const PlacedTriangle& t : placed) extend(box, t.box);
    const double large = longest_side(box) / 2;
    const auto rest = std::stable_partition(placed.begin(), placed.end(),
                                            [&](const PlacedTriangle& t) { return longest_side(t.box) > large; });
    const auto own = static_cast<std::size_t>(rest - placed.begin());
    if (placed.size() - own > detail_.leaf / 2) {
      nodes_[number].own_end = begin + static_cast<std::uint32_t>(own);
      sort_by_middles(placed.subspan(own));
      const std::size_t half = own + (placed.size() - own) / 2;
      build_node(placed.subspan(own, half - own), begin + static_cast<std::uint32_t>(own));
      build_node(placed.subspan(half), begin + static_cast<std::uint32_t>(half));
    }
  }
  nodes_[number].next = static_cast<std::uint32_t>(nodes_.size());
}

// Farther from the ball around the node than the longest side of its own triangles.
double SourceTree::square_of_small(const SourceNode& node) const {
  double longest = 0.0;  // side, squared
  for (std::uint32_t i = node.begin; i < node.own_end; ++i) {
    longest = std::max(longest, square_to_look_small(triangles_[i]));
  }
  const double distance = node.radius + std::sqrt(longest);
  return distance * distance * (1 + kRounding);
}

void SourceTree::measure(SourceNode& node) const {
  Box box = box_of(triangles_[node.begin]);
  for (std::uint32_t i = node.begin; i < node.end; ++i) {
    extend(box, box_of(triangles_[i]));
    node.area += area_bound(triangles_[i]);
  }
  node.area *= 1 + kSumRounding;
  node.centre = middle(box);
  for (std::uint32_t i = node.begin; i < node.end; ++i) {
    const SolidTriangle& t = triangles_[i];
    for (const Vec3* v : {&t.a, &t.b, &t.c}) node.radius = std::max(node.radius, norm(*v - node.centre));
  }
  node.radius *= 1 + kRounding;
  node.square_of_small = square_of_small(node);
  node.square_of_distance.fill(std::numeric_limits<double>::quiet_NaN());
  if (!(node.radius > kSmallest)) return;
  node.unit = std::ldexp(1.0, std::ilogb(node.radius) + 1);
  node.order = worthwhile_order(node.triangles(), detail_.order);
  if (node.order > 0) node.square_of_distance.fill(kInfinity);
}

// From the leaves up, in pieces that threads take; the nodes above the pieces at last.
void SourceTree::expand() {
  const std::size_t piece = std::max<std::size_t>(triangles_.size() / 64, 256);
  std::vector<std::uint32_t> pieces;
  for (std::uint32_t i = 0; i < nodes_.size();) {
    const bool small = nodes_[i].triangles() <= piece || nodes_[i].next == i + 1;
    if (small) pieces.push_back(i);
    i = small ? nodes_[i].next : i + 1;
  }
  std::vector<std::optional<Multipole>> done(pieces.size());
  const auto expand_node = [&](const auto& self, std::uint32_t number) -> Multipole {
    const auto found = std::ranges::lower_bound(pieces, number);
    if (found != pieces.end() && *found == number) {
      if (const auto& known = done[static_cast<std::size_t>(found - pieces.begin())]) return *known;
    }
    SourceNode& node = nodes_[number];
    Multipole multipole = expansion_of(node);
    for (std::uint32_t child = number + 1; child < node.next; child = nodes_[child].next) {
      const SourceNode& part = nodes_[child];
      const Multipole expansion = self(self, child);
      if (!(part.radius > kSmallest)) {
        multipole.error[1] += kNeglected * (part.area / node.unit / node.unit);
        continue;
      }
      add_shifted(multipole, expansion, (1 / node.unit) * (part.centre - node.centre), part.unit / node.unit, moments_);
    }
    finish(node, multipole);
    return multipole;
  };
  parallel_for_each(pieces.size(), [&](std::size_t i) { done[i] = expand_node(expand_node, pieces[i]); });
  expand_node(expand_node, 0);
}

// Of the node's own triangles.
Multipole SourceTree::expansion_of(const SourceNode& node) const {
  if (!(node.radius > kSmallest)) return {detail_.order, {}, {}, {}};
  const std::span own = triangles().subspan(node.begin, node.own_end - node.begin);
  constexpr double kPrecision = 0x1p-22;  // of the tolerance: what is near stays as it is
  return multipole_of(own, {node.centre, node.unit, node.radius / node.unit}, detail_.order, kPrecision * tolerance_,
                      moments_);
}

void SourceTree::finish(SourceNode& node, const Multipole& multipole) {
  if (node.order == 0) return;
  node.bounds = bounds_of(multipole);
  set_coefficients(multipole, node.order, {&coefficients_[node.first_coefficient], numbers_of(node.order)});
  const double of_triangles = static_cast<double>(node.triangles()) / static_cast<double>(triangles_.size());
  const double share = tolerance_ / 2 * (node.area / area() + of_triangles) * (1 - 4 * kSumRounding);
  const auto ratios = largest_ratios(node, share);
  double least = kInfinity;
  for (int p = 1; p <= node.order; ++p) {
    const auto i = static_cast<std::size_t>(p);
    if (ratios[i] > 0) least = std::min(least, node.unit / ratios[i] * (1 + kRounding));
    node.square_of_distance[i] = least * least * (1 + kRounding);
  }
}

std::optional<SourceTree::Cut> SourceTree::least_cut(const SourceNode& node, double distance, double most) {
  if (node.order == 0) return std::nullopt;  // it has no bounds
  const double rho = node.unit / distance * (1 + kRounding);
  std::array<double, kOrders + 1> powers, left_out;  // [p]: of all beyond degree p
  powers[0] = rho;
  const auto orders = static_cast<std::size_t>(node.bounds.order);
  for (std::size_t n = 1; n <= orders; ++n) powers[n] = powers[n - 1] * rho;
  const double area = node.area / node.unit / node.unit;
  left_out[orders] = beyond_multipoles(area, node.radius / node.unit, node.bounds.order, rho);
  for (std::size_t n = orders; n > 0; --n) left_out[n - 1] = left_out[n] + powers[n] * node.bounds.size[n];
  double evaluated = 0.0;
  for (int p = 0; p <= node.order; ++p) {
    const auto n = static_cast<std::size_t>(p);
    if (p > 0) evaluated += powers[n] * node.bounds.evaluation[n];
    const double error = (evaluated + left_out[n]) * (1 + kRounding);
    if (error <= most) return Cut{p, error};
  }
  return std::nullopt;
}

}  // namespace raycone
