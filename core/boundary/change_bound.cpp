#include "core/boundary/change_bound.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace raycone {
namespace {

constexpr std::uint32_t kLeaf = 4;     // pieces
constexpr double kPiecesAlong = 64.0;  // the longest side of the caps' box
constexpr double kMostPieces = 128.0;  // of an edge
constexpr int kMostCuts = 14;          // of a cap, one after the other
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Rounding: of the ends of pieces, relative to the largest coordinate, for some units in the last place, 1e-16 each;
// and of bounds, relative to themselves: sums of up to 2^32 numbers that are not negative are off by 2^-21.
constexpr double kPlaceError = 1e-14;
constexpr double kBoundError = 0x1p-20;
constexpr double kAreaError = 1e-14;

std::array<Vec3, 3> corners(const TriangleMesh& mesh, std::size_t triangle) {
  const Triangle& t = mesh.triangles[triangle];
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

double square_of_size(const Box& box) {
  const Vec3 size = box.upper - box.lower;
  return dot(size, size);
}

}  // namespace

ChangeBound::ChangeBound(const Caps& caps) {
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
  clusters_.reserve(sources_.size());
  if (!sources_.empty()) build(0, static_cast<std::uint32_t>(sources_.size()));
}

void ChangeBound::add_edges(const std::vector<DirectedEdge>& edges) {
  const Vec3 error{place_error_, place_error_, place_error_};
  for (const DirectedEdge& e : edges) {
    const Vec3 along = e.to - e.from;
    const double length = std::sqrt(dot(along, along));
    const double count = length > piece_ ? std::min(std::ceil(length / piece_), kMostPieces) : 1.0;
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
    const auto [a, b, c] = corners(caps.mesh, n);
    cut(a, b, c, kMostCuts);
  }
}

// At the middle of the longest side, until the box of a piece is small; `depth` times at most.
void ChangeBound::cut(const Vec3& a, const Vec3& b, const Vec3& c, int depth) {
  const double ab = square_of_size(box_of(a, b)), bc = square_of_size(box_of(b, c)), ca = square_of_size(box_of(c, a));
  if (depth == 0 || !(std::max({ab, bc, ca}) > 4 * piece_ * piece_)) {
    const Vec3 error{place_error_, place_error_, place_error_};
    const Box box = box_of(a, b, c);
    wide_caps_.push_back({box.lower - error, box.upper + error});
    return;
  }
  if (bc > ab && bc >= ca) return cut(b, c, a, depth);
  if (ca > ab) return cut(c, a, b, depth);
  const Vec3 middle = 0.5 * a + 0.5 * b;
  cut(a, middle, c, depth - 1);
  cut(middle, b, c, depth - 1);
}

void ChangeBound::build(std::uint32_t begin, std::uint32_t end) {
  Source sum = sources_[begin];
  for (std::uint32_t i = begin + 1; i < end; ++i) {
    sum = {hull(sum.box, sources_[i].box), sum.length + sources_[i].length, sum.area + sources_[i].area};
  }
  const std::size_t here = clusters_.size();
  clusters_.push_back({sum, begin, end, 0});
  if (end - begin > kLeaf) {
    int axis = 0;
    for (const int other : {1, 2}) {
      if (sum.box.upper[other] - sum.box.lower[other] > sum.box.upper[axis] - sum.box.lower[axis]) axis = other;
    }
    const std::uint32_t half = begin + (end - begin) / 2;
    std::nth_element(sources_.begin() + begin, sources_.begin() + half, sources_.begin() + end,
                     [&](const Source& a, const Source& b) { return middle(a.box, axis) < middle(b.box, axis); });
    build(begin, half);
    build(half, end);
  }
  clusters_[here].next = static_cast<std::uint32_t>(clusters_.size());
}

ChangeBound::Bounds ChangeBound::in(const Box& box, double limit) const {
  double sum = 0.0, second = 0.0, third = 0.0;
  constexpr double kLeastSquare = 0x1p-900;  // less has lost bits, or loses them in what follows
  const auto add = [&](const Source& source, double square) {
    if (square < kLeastSquare) sum = kInfinity;
    const double distance = std::sqrt(square), of_length = source.length / square;
    sum += of_length;
    second += 2 * of_length / distance;
    third += 6 * of_length / square;
    if (source.area == 0.0) return;
    const double of_area = source.area / (square * distance);
    sum += of_area;
    second += 3 * of_area / distance;
    third += 12 * of_area / square;
  };
  for (std::size_t n = 0; n < clusters_.size() && sum <= limit;) {
    const Cluster& cluster = clusters_[n];
    const double square = square_of_gap(box, cluster.sum.box);
    if (square > square_of_size(cluster.sum.box)) {
      add(cluster.sum, square);
      n = cluster.next;
      continue;
    }
    if (cluster.end - cluster.begin <= kLeaf) {
      for (std::uint32_t i = cluster.begin; i < cluster.end; ++i) add(sources_[i], square_of_gap(box, sources_[i].box));
    }
    ++n;  // of a leaf that is `next`
  }
  if (!(sum <= limit)) return {kInfinity, kInfinity, kInfinity};
  return {sum * (1 + kBoundError), second * (1 + kBoundError), third * (1 + kBoundError)};
}

}  // namespace raycone
