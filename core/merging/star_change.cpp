#include "core/merging/star_change.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace raycone {
namespace {

// What rounding may do, beside numbers of the size of the faces. It decides on the careful side.
constexpr double kDoubt = 1e-9;

// What turn() rounds, beside squares of the largest coordinate: its differences are of up to twice that, and each of
// its two products, of up to four squares, rounds by 3 u (u = 2^-53), their difference by as much again.
constexpr double kTurnRounds = 32 * 0x1p-53;

double turn(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// The height of the triangle above p. Nothing where p is outside.
std::optional<double> height_above(const Corners3& t, const Vec3& p) {
  const double area = turn(t[0], t[1], t[2]);
  const std::array parts{turn(t[1], t[2], p) / area, turn(t[2], t[0], p) / area, turn(t[0], t[1], p) / area};
  if (std::ranges::min(parts) < -kDoubt) return std::nullopt;
  return parts[0] * t[0].z + parts[1] * t[1].z + parts[2] * t[2].z;
}

std::optional<double> height_of(const std::vector<Corners3>& faces, const Vec3& p) {
  for (const Corners3& face : faces) {
    if (const std::optional<double> height = height_above(face, p)) return height;
  }
  return std::nullopt;
}

// How far apart two lines are in height where they cross, at most; 0 where they do not, nor where they cannot be told
// from one line, which ends at corners. `size`: no coordinate is larger.
double gap_at_crossing(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, double size) {
  const double ca = turn(c, d, a), cb = turn(c, d, b), ac = turn(a, b, c), ad = turn(a, b, d);
  const double rounded = kTurnRounds * size * size;
  if (ca * cb >= 0.0 || ac * ad >= 0.0 || std::abs(ca - cb) <= 2 * rounded) return 0.0;
  const double along = ca / (ca - cb), across = ac / (ac - ad);
  // Both are within 0 and 1, whatever turns round.
  const double off_along = rounded / std::abs(ca - cb), off_across = std::min(1.0, rounded / std::abs(ac - ad));
  return std::abs(a.z + along * (b.z - a.z) - (c.z + across * (d.z - c.z))) + off_along * std::abs(b.z - a.z) +
         off_across * std::abs(d.z - c.z);
}

Vec3 across_of(const Vec3& n) {
  const Vec3 size{std::abs(n.x), std::abs(n.y), std::abs(n.z)};
  const Vec3 least = size.x <= size.y && size.x <= size.z ? Vec3{1, 0, 0}
                     : size.y <= size.z                   ? Vec3{0, 1, 0}
                                                          : Vec3{0, 0, 1};
  const Vec3 across = cross(least, n);
  return 1.0 / std::sqrt(dot(across, across)) * across;
}

// Whether is_found(node) for any node within `distance` of a face, and in a box: row by row along the axis that the
// face is steepest to.
template <class IsFound>
bool any_node_near(const Corners3& face, double distance, const Lattice& lattice, const Box& box,
                   const IsFound& is_found) {
  const auto first_from = [&](int a, double x) {
    return static_cast<std::int64_t>(std::ceil(lattice.index_at(a, std::max(x, box.lower[a])) - kDoubt));
  };
  const auto last_to = [&](int a, double x) {
    return static_cast<std::int64_t>(std::floor(lattice.index_at(a, std::min(x, box.upper[a])) + kDoubt));
  };
  const auto range = [&](int a) {
    const auto [low, high] = std::minmax({face[0][a], face[1][a], face[2][a]});
    return std::array{first_from(a, low - distance), last_to(a, high + distance)};
  };
  const Vec3 normal = cross(face[1] - face[0], face[2] - face[0]);
  const std::array sizes{std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
  const int axis = static_cast<int>(std::ranges::max_element(sizes) - sizes.begin());
  const double length = std::sqrt(dot(normal, normal));
  const double reach = distance * length / std::abs(normal[axis]) + kDoubt * lattice.spacing[axis];
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const auto [u_begin, u_end] = range(u);
  const auto [v_begin, v_end] = range(v);
  for (std::int64_t j = v_begin; j <= v_end; ++j) {
    for (std::int64_t i = u_begin; i <= u_end; ++i) {
      Vec3 node;
      node[u] = lattice.coordinate(u, i);
      node[v] = lattice.coordinate(v, j);
      const double on_plane =
          face[0][axis] - (normal[u] * (node[u] - face[0][u]) + normal[v] * (node[v] - face[0][v])) / normal[axis];
      const std::int64_t last = last_to(axis, on_plane + reach);
      for (std::int64_t k = first_from(axis, on_plane - reach); k <= last; ++k) {
        node[axis] = lattice.coordinate(axis, k);
        if (is_found(node)) return true;
      }
    }
  }
  return false;
}

}  // namespace

StarChange::StarChange(const Vec3& vertex, const std::vector<Vec3>& ring) : vertex_(vertex), ring_(ring) {
  Vec3 sum;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    sum = sum + cross(ring[i] - vertex, ring[(i + 1) % ring.size()] - vertex);
  }
  const double length = std::sqrt(dot(sum, sum));
  axes_[2] = 1.0 / length * sum;
  axes_[0] = across_of(axes_[2]);
  axes_[1] = cross(axes_[2], axes_[0]);
  seen_vertex_ = seen(vertex);
  for (const Vec3& neighbour : ring) {
    seen_ring_.push_back(seen(neighbour));
    size_ = std::max(size_, largest_coordinate(seen_ring_.back()));
  }
  for (std::size_t i = 0; i < ring.size(); ++i) {
    seen_before_.push_back({seen_vertex_, seen_ring_[i], seen_ring_[(i + 1) % ring.size()]});
  }
}

void StarChange::pull_into(std::size_t target) {
  target_ = target;
  after_.clear();
  seen_after_.clear();
  for (std::size_t i = 0; i < ring_.size(); ++i) {
    const std::size_t next = (i + 1) % ring_.size();
    if (i == target || next == target) continue;
    after_.push_back({ring_[target], ring_[i], ring_[next]});
    seen_after_.push_back({seen_ring_[target], seen_ring_[i], seen_ring_[next]});
  }
}

Vec3 StarChange::seen(const Vec3& p) const {
  const Vec3 from = p - vertex_;
  return {dot(from, axes_[0]), dot(from, axes_[1]), dot(from, axes_[2])};
}

bool StarChange::is_graph() const {
  constexpr double kSlope = 1e-3;  // the least part of a face's area that is seen
  const auto is_front = [](const Corners3& c) {
    const Vec3 normal = cross(c[1] - c[0], c[2] - c[0]);
    return normal.z > kSlope * std::sqrt(dot(normal, normal));
  };
  if (!std::ranges::all_of(seen_before_, is_front) || !std::ranges::all_of(seen_after_, is_front)) return false;
  std::size_t rounds = 0;
  for (std::size_t i = 0; i < seen_ring_.size(); ++i) {
    const Vec3 &a = seen_ring_[i], &b = seen_ring_[(i + 1) % seen_ring_.size()];
    if (a.y < seen_vertex_.y && b.y >= seen_vertex_.y) ++rounds;
  }
  return rounds == 1;
}

std::optional<double> StarChange::distance(double most) const {
  if (!is_graph()) return std::nullopt;
  const std::optional<double> at_vertex = height_of(seen_after_, seen_vertex_);
  if (!at_vertex) return std::nullopt;
  double gap = std::abs(*at_vertex);
  if (!(gap < most)) return std::nullopt;
  const Vec3& target = seen_ring_[target_];
  for (std::size_t i = 0; i < seen_ring_.size(); ++i) {
    if (i == target_) continue;
    const Vec3& spoke = seen_ring_[i];
    for (std::size_t j = 0; j < seen_ring_.size(); ++j) {
      if (j == i || j == target_) continue;
      gap = std::max(gap, gap_at_crossing(seen_vertex_, spoke, target, seen_ring_[j], size_));
    }
  }
  gap += rounding();
  return gap < most ? std::optional(gap) : std::nullopt;
}

// Of what is seen, and of heights: sums of three coordinates, weighted by parts of a face's area: these and the area
// are off by what turns round. The same for all stars of a size whose faces are not thin, so that it does not
// choose between pulls.
double StarChange::rounding() const {
  constexpr double kOfMost = 0x1p-42;
  double least = size_ * size_;
  for (const Corners3& c : seen_after_) least = std::min(least, turn(c[0], c[1], c[2]));
  return 0x1p-45 * size_ + size_ * std::max(kOfMost, 4 * kTurnRounds * size_ * size_ / least);
}

bool StarChange::is_between(const Vec3& node) const {
  const Vec3 p = seen(node);
  const std::optional<double> before = height_of(seen_before_, p), after = height_of(seen_after_, p);
  if (!before || !after) return false;
  const double doubt = kDoubt * (std::abs(p.x) + std::abs(p.y) + std::abs(p.z));
  return p.z >= std::min(*before, *after) - doubt && p.z <= std::max(*before, *after) + doubt;
}

// The nodes of the cell that holds what is halfway between the vertex and the faces after.
bool StarChange::passes_node_below_vertex(const Lattice& lattice) const {
  const std::optional<double> height = height_of(seen_after_, seen_vertex_);
  if (!height) return false;
  const Vec3 halfway = vertex_ + 0.5 * *height * axes_[2];
  const Box all = box();
  Vec3 first;
  for (int a = 0; a < 3; ++a)
    first[a] = std::floor(lattice.index_at(a, std::clamp(halfway[a], all.lower[a], all.upper[a])));
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 node;
    for (int a = 0; a < 3; ++a) {
      node[a] = lattice.coordinate(a, static_cast<std::int64_t>(first[a]) + (corner >> a & 1));
    }
    if (is_between(node)) return true;
  }
  return false;
}

// A box that holds all that is between the faces, as far as is_between() can tell.
Box StarChange::box() const {
  constexpr double kSlack = 16 * kDoubt;
  Box box{vertex_, vertex_};
  for (const Vec3& p : ring_) extend(box, p);
  return widened(box, kSlack * longest_side(box));
}

// Where there is much between the faces, most nodes near those after are beside it: then a node below the vertex is
// found sooner. Along the direction, steep faces may be far from each other: nodes beyond all of them are between none.
bool StarChange::passes_node(const Lattice& lattice, double distance) const {
  if (distance > lattice.least_spacing() && passes_node_below_vertex(lattice)) return true;
  const Box all = box();
  return std::ranges::any_of(after_, [&](const Corners3& face) {
    return any_node_near(face, distance, lattice, all, [&](const Vec3& node) { return is_between(node); });
  });
}

}  // namespace raycone
