#include "core/boundary/change_bound.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace raycone {
namespace {

constexpr double kPiecesAlong = 64.0;  // the longest side of the caps' box
constexpr double kMostPieces = 128.0;  // of an edge
constexpr double kFiner = 4.0;
constexpr int kMostCuts = 14;  // of a cap, one after the other
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Rounding: of the ends of pieces, relative to the largest coordinate, for some units in the last place, 1e-16 each;
// and of bounds, relative to themselves: sums of up to 2^32 numbers that are not negative are off by 2^-21.
constexpr double kPlaceError = 1e-14;
constexpr double kBoundError = 0x1p-20;
constexpr double kAreaError = 1e-14;

constexpr double kLeastDerivative = 0x1p-700;  // less has lost bits, or loses them in what follows
constexpr double kFar = 4.0;                   // clusters act as one from twice their size on

std::array<Vec3, 3> corners(const TriangleMesh& mesh, std::size_t triangle) {
  const Triangle& t = mesh.triangles[triangle];
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

double square_of_size(const Box& box) {
  const Vec3 size = box.upper - box.lower;
  return dot(size, size);
}

}  // namespace

ChangeBound::ChangeBound(const Caps& caps, SimdLevel level) : kernel_(change_kernel(level)) {
  if (caps.mesh.triangles.empty()) return;  // edges there and back, which add nothing
  const Box box = bounding_box(caps.mesh);
  double side = 0.0, largest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    side = std::max(side, box.upper[axis] - box.lower[axis]);
    largest = std::max({largest, std::abs(box.lower[axis]), std::abs(box.upper[axis])});
  }
  piece_ = side / kPiecesAlong;
  place_error_ = kPlaceError * largest;
  add_edges(caps.wide_loops);
  add_narrow(caps);
  add_wide(caps);
  if (sources_.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw std::length_error("raycone: more than 4294967295 pieces of exterior edges and caps");
  }
  if (sources_.empty()) return;
  nodes_.emplace_back();
  build(0, sources_);
  sources_ = {};
}

void ChangeBound::add_edges(const std::vector<DirectedEdge>& edges) {
  const Vec3 error{place_error_, place_error_, place_error_};
  for (const DirectedEdge& e : edges) {
    const Vec3 along = e.to - e.from;
    const double length = std::sqrt(dot(along, along));
    const double piece = piece_ / kFiner;
    const double count = length > piece ? std::min(std::ceil(length / piece), kMostPieces) : 1.0;
    Vec3 from = e.from;
    for (double i = 1.0; i <= count; ++i) {
      const Vec3 to = i == count ? e.to : e.from + (i / count) * along;
      const Box box = box_of(from, to);
      sources_.push_back({{box.lower - error, box.upper + error}, length / count / (4 * std::numbers::pi), 0.0});
      from = to;
    }
  }
}

void ChangeBound::add_narrow(const Caps& caps) {
  for (std::size_t n = 0; n < caps.narrow; ++n) {
    const auto [a, b, c] = corners(caps.mesh, n);
    const Vec3 normal = cross(b - a, c - a);
    const Box box = box_of(a, b, c);
    const double twice_area = safe_norm(normal) + kAreaError * square_of_size(box);
    sources_.push_back({box, 0.0, twice_area / (4 * std::numbers::pi)});
  }
}

void ChangeBound::add_wide(const Caps& caps) {
  for (std::size_t n = caps.narrow; n < caps.mesh.triangles.size(); ++n) {
    const std::array<Vec3, 3> cap = corners(caps.mesh, n);
    cut(cap, cap[0], cap[1], cap[2], kMostCuts);
  }
}

// abc, a part of the cap, at the middle of the longest side, until the box of a piece is small; `depth` times at most.
void ChangeBound::cut(const std::array<Vec3, 3>& cap, const Vec3& a, const Vec3& b, const Vec3& c, int depth) {
  const double ab = square_of_size(box_of(a, b)), bc = square_of_size(box_of(b, c)), ca = square_of_size(box_of(c, a));
  if (depth == 0 || !(std::max({ab, bc, ca}) > 4 * piece_ * piece_)) {
    const Vec3 error{place_error_, place_error_, place_error_};
    const Box box = box_of(a, b, c);
    wide_caps_.push_back(FlatPiece::of_triangle(cap[0], cap[1], cap[2], {box.lower - error, box.upper + error}));
    return;
  }
  if (bc > ab && bc >= ca) return cut(cap, b, c, a, depth);
  if (ca > ab) return cut(cap, c, a, b, depth);
  const Vec3 middle = 0.5 * a + 0.5 * b;
  cut(cap, a, middle, c, depth - 1);
  cut(cap, middle, b, c, depth - 1);
}

// Into two, so often, along the longest side of what there is.
void ChangeBound::halve(std::span<Source> sources, int times, std::vector<std::span<Source>>& parts) {
  if (times == 0 || sources.size() < 2) return parts.push_back(sources);
  Box box = sources.front().box;
  for (const Source& source : sources) extend(box, source.box);
  int axis = 0;
  for (const int other : {1, 2}) {
    if (box.upper[other] - box.lower[other] > box.upper[axis] - box.lower[axis]) axis = other;
  }
  const std::size_t half = sources.size() / 2;
  std::nth_element(sources.begin(), sources.begin() + static_cast<std::ptrdiff_t>(half), sources.end(),
                   [&](const Source& a, const Source& b) { return middle(a.box, axis) < middle(b.box, axis); });
  halve(sources.first(half), times - 1, parts);
  halve(sources.subspan(half), times - 1, parts);
}

void ChangeBound::build(std::uint32_t node, std::span<Source> sources) {
  std::vector<std::span<Source>> parts;
  halve(sources, 3, parts);
  for (std::size_t n = 0; n < nodes_[node].length.size(); ++n) {
    Source sum{{{kInfinity, kInfinity, kInfinity}, {kInfinity, kInfinity, kInfinity}}, 0.0, 0.0};
    double far_square = -1.0;
    std::uint32_t child = 0;
    if (n < parts.size()) {
      sum = parts[n].front();
      for (const Source& source : parts[n].subspan(1)) {
        sum = {hull(sum.box, source.box), sum.length + source.length, sum.area + source.area};
      }
      if (parts[n].size() > 1) {
        far_square = kFar * square_of_size(sum.box);
        child = static_cast<std::uint32_t>(nodes_.size());
        nodes_.emplace_back();
        build(child, parts[n]);
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
