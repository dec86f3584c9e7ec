#include "core/boundary/change_bound.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "core/machine/threads.h"

namespace raycone {
namespace {

constexpr double kPiecesAlong = 64.0;  // the longest side of the caps' box
constexpr double kMostPieces = 128.0;  // of an edge
constexpr double kOfCaps = 0x1p15;     // pieces of all caps, about, where these lie one over the other
constexpr double kFiner = 4.0;
constexpr int kMostCuts = 14;  // of a cap, one after the other
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Rounding: of the ends of pieces, relative to the largest coordinate, for some units in the last place, 1e-16 each;
// and of bounds, relative to themselves: sums of up to 2^32 numbers that are not negative are off by 2^-21.
constexpr double kPlaceError = 1e-14;
constexpr double kBoundError = 0x1p-20;
constexpr double kAreaError = 1e-14;

constexpr double kLeastDerivative = 0x1p-700;  // less has lost bits, or loses them in what follows
constexpr double kFar = 4.0;                   // clusters act as one from twice their size on, squared

// Slices abc, whose side ab is short, across: visit(box, part of the area) for each of so many.
template <class Visit>
void slice(const Vec3& a, const Vec3& b, const Vec3& c, double count, double part, const Visit& visit) {
  Box last{c, c};
  for (double i = 1.0; i <= count; ++i) {
    const double to = i / count;
    const Box here = i == count ? box_of(a, b) : box_of(c + to * (a - c), c + to * (b - c));
    visit(hull(last, here), part * (2.0 * i - 1.0) / (count * count));
    last = here;
  }
}

// Cuts abc into parts whose boxes have diagonals of about `size` at most, or 2^kMostCuts of them: at the middle of its
// longest side, and the parts likewise; across where it is slender, as halves of long sides would leave others as long.
// visit(box, part of the area) for each.
template <class Visit>
void cut(const Vec3& a, const Vec3& b, const Vec3& c, double size, const Visit& visit, int cuts = 0) {
  const double ab = square_of_diagonal(box_of(a, b)), bc = square_of_diagonal(box_of(b, c)),
               ca = square_of_diagonal(box_of(c, a));
  const double part = std::ldexp(1.0, -cuts), longest = std::max({ab, bc, ca});
  if (cuts == kMostCuts || !(longest > size * size)) return visit(box_of(a, b, c), part);
  if (bc > ab && bc >= ca) return cut(b, c, a, size, visit, cuts);
  if (ca > ab) return cut(c, a, b, size, visit, cuts);
  const double most = std::ldexp(1.0, kMostCuts - cuts), slices = std::min(std::ceil(std::sqrt(longest) / size), most);
  if (std::min(bc, ca) <= size * size / 4) {
    return bc <= ca ? slice(b, c, a, slices, part, visit) : slice(c, a, b, slices, part, visit);
  }
  const Vec3 middle = 0.5 * a + 0.5 * b;
  cut(a, middle, c, size, visit, cuts + 1);
  cut(middle, b, c, size, visit, cuts + 1);
}

}  // namespace

ChangeBound::ChangeBound(const Caps& caps, SimdLevel level) : kernel_(change_kernel(level)) {
  if (caps.mesh.triangles.empty()) return;  // edges there and back, which add nothing
  const Box box = bounding_box(caps.mesh);
  piece_ = std::max(longest_side(box) / kPiecesAlong, std::sqrt(total_area(caps.mesh) / kOfCaps));
  place_error_ = kPlaceError * largest_coordinate(box);
  add_edges(caps.wide_loops);
  add_narrow(caps);
  add_wide(caps);
  if (sources_.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw std::length_error("raycone: more than 4294967295 pieces of exterior edges and caps");
  }
  if (sources_.empty()) return;
  sort_by_halves(sources_);
  nodes_.emplace_back();
  build(0, {sources_});
  sources_ = {};
}

void ChangeBound::add_edges(const std::vector<DirectedEdge>& edges) {
  for (const DirectedEdge& e : edges) {
    const Vec3 along = e.to - e.from;
    const double length = norm(along);
    const double piece = piece_ / kFiner;
    const double count = length > piece ? std::min(std::ceil(length / piece), kMostPieces) : 1.0;
    Vec3 from = e.from;
    for (double i = 1.0; i <= count; ++i) {
      const Vec3 to = i == count ? e.to : e.from + (i / count) * along;
      const double share = 1 / (count * 4 * std::numbers::pi);
      sources_.push_back({widened(box_of(from, to), place_error_), share * length, 0.0, share * along});
      from = to;
    }
  }
}

void ChangeBound::add_narrow(const Caps& caps) {
  for (std::size_t n = 0; n < caps.narrow; ++n) {
    const auto [a, b, c] = corners_of(caps.mesh, caps.mesh.triangles[n]);
    const Vec3 normal = cross(b - a, c - a);
    const double twice_area = safe_norm(normal) + kAreaError * square_of_diagonal(box_of(a, b, c));
    cut(a, b, c, piece_, [this, of_cap = twice_area / (4 * std::numbers::pi)](const Box& box, double part) {
      sources_.push_back({widened(box, place_error_), 0.0, of_cap * part, {}});
    });
  }
}

void ChangeBound::add_wide(const Caps& caps) {
  for (std::size_t n = caps.narrow; n < caps.mesh.triangles.size(); ++n) {
    const auto [a, b, c] = corners_of(caps.mesh, caps.mesh.triangles[n]);
    cut(a, b, c, 2 * piece_, [&, &a = a, &b = b, &c = c](const Box& box, double) {
      wide_caps_.push_back(FlatPiece::of_triangle(a, b, c, widened(box, place_error_)));
    });
  }
}

// Of a cluster that acts as one: moved to the middle of its box, its pieces are one vector. Each moves by half of the
// diagonal at most, which changes derivatives as an area of that times its length would (docs/method.md).
ChangeBound::Source ChangeBound::seen_from_afar(const Source& cluster) {
  Source moved = cluster;
  moved.length = safe_norm(cluster.along) + kBoundError * cluster.length;
  moved.area += std::sqrt(square_of_diagonal(cluster.box)) * cluster.length;
  // At the nearest distance, twice the diagonal, the area adds half of what the length did.
  return moved.length < cluster.length / 2 ? moved : cluster;
}

// Two halves, along the longest side of what there is, and each of them likewise.
void ChangeBound::sort_by_halves(std::span<Source> sources) {
  constexpr std::size_t kMany = 1 << 12;
  if (sources.size() < 2) return;
  Box box = sources.front().box;
  for (const Source& source : sources) extend(box, source.box);
  const int axis = longest_axis(box);
  const std::size_t half = sources.size() / 2;
  std::nth_element(sources.begin(), sources.begin() + static_cast<std::ptrdiff_t>(half), sources.end(),
                   [&](const Source& a, const Source& b) { return middle(a.box, axis) < middle(b.box, axis); });
  const std::array halves{sources.first(half), sources.subspan(half)};
  if (sources.size() >= kMany) {
    parallel_for_each(halves.size(), [&](std::size_t n) { sort_by_halves(halves[n]); });
  } else {
    for (const std::span<Source> part : halves) sort_by_halves(part);
  }
}

// The halves that sort_by_halves() has made, so often.
void ChangeBound::halve(std::span<const Source> sources, int times, std::vector<std::span<const Source>>& parts) {
  if (times == 0 || sources.size() < 2) return parts.push_back(sources);
  const std::size_t half = sources.size() / 2;
  halve(sources.first(half), times - 1, parts);
  halve(sources.subspan(half), times - 1, parts);
}

// `parts`, eight at most, are below the node.
void ChangeBound::build(std::uint32_t node, const std::vector<std::span<const Source>>& parts) {
  for (std::size_t n = 0; n < nodes_[node].length.size(); ++n) {
    Source sum{{{kInfinity, kInfinity, kInfinity}, {kInfinity, kInfinity, kInfinity}}, 0.0, 0.0, {}};
    double far_square = -1.0;
    std::uint32_t child = 0;
    if (n < parts.size()) {
      sum = parts[n].front();
      for (const Source& source : parts[n].subspan(1)) {
        sum = {hull(sum.box, source.box), sum.length + source.length, sum.area + source.area, sum.along + source.along};
      }
      if (parts[n].size() > 1) {
        far_square = kFar * square_of_diagonal(sum.box);
        sum = seen_from_afar(sum);
        child = static_cast<std::uint32_t>(nodes_.size());
        nodes_.emplace_back();
        std::vector<std::span<const Source>> below;
        halve(parts[n], 3, below);
        build(child, below);
      }
    }
    ChangeNode& here = nodes_[node];
    for (int axis = 0; axis < 3; ++axis) {
      here.lower[static_cast<std::size_t>(axis)][n] = sum.box.lower[axis];
      here.upper[static_cast<std::size_t>(axis)][n] = sum.box.upper[axis];
    }
    here.far_square[n] = far_square;
    here.length[n] = sum.length;
    here.area[n] = sum.area;
    here.child[n] = child;
  }
}

double ChangeBound::gradient_in(const Box& box, double limit) const {
  return nodes_.empty() ? 0.0 : kernel_.gradient(nodes_, box, limit) * (1 + kBoundError);
}

ChangeSums ChangeBound::derivatives_in(const Box& box) const {
  ChangeSums sums = nodes_.empty() ? ChangeSums{} : kernel_.derivatives(nodes_, box);
  for (double& sum : sums) sum = std::max(sum * (1 + kBoundError), kLeastDerivative);
  return sums;
}

}  // namespace raycone
