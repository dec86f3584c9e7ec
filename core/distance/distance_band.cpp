#include "core/distance/distance_band.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <mutex>
#include <numeric>
#include <vector>

#include "core/crossings/row.h"
#include "core/data/interval.h"
#include "core/distance/triangle_distance.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

constexpr std::size_t kTrianglesPerTask = 2048;
constexpr std::size_t kStrip = 8;  // values of y per task
constexpr double kNowhere = std::numeric_limits<double>::infinity();

std::size_t strip_count(const LatticeRows& rows) { return (rows.ys.size() + kStrip - 1) / kStrip; }

double length(const Vec3& v) { return std::sqrt(dot(v, v)); }

// A triangle's neighbourhood, enclosed by what is easily intersected with a row: the triangle's box rounded off at the
// band, and half-spaces: on either side of the triangle's plane, and beyond each of its edges.
class Neighbourhood {
 public:
  Neighbourhood(const Vec3& a, const Vec3& b, const Vec3& c, double band) : triangle_(a, b, c) {
    const std::array<Vec3, 3> corners{a, b, c};
    for (int axis = 0; axis < 3; ++axis) {
      box_.lower[axis] = std::min({a[axis], b[axis], c[axis]});
      box_.upper[axis] = std::max({a[axis], b[axis], c[axis]});
    }
    const Vec3 sides = box_.upper - box_.lower;
    // More than the roundings of coordinates and distances (1e-15, of coordinates up to 1), and of normals (1e-11 of
    // the sides).
    reach_ = band + 1e-9 * (band + sides.x + sides.y + sides.z) + 1e-13;
    if (!triangle_.has_plane()) return;
    const Vec3 normal = unit(cross(b - a, c - a));
    add_half_space(normal, a);
    add_half_space(-1.0 * normal, a);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 along = corners[(i + 1) % 3] - corners[i];
      add_half_space(unit(cross(along, normal)), corners[i]);
    }
  }

  [[nodiscard]] double squared_distance(const Vec3& p) const { return triangle_.squared(p); }
  [[nodiscard]] Interval along(int axis) const { return {box_.lower[axis] - reach_, box_.upper[axis] + reach_}; }

  // The part of the row (y, z).
  [[nodiscard]] Interval along_row(double y, double z) const {
    const double dy = outside(1, y), dz = outside(2, z);
    const double left = reach_ * reach_ - dy * dy - dz * dz;
    if (left < 0.0) return {0.0, -1.0};
    Interval xs{box_.lower.x - std::sqrt(left), box_.upper.x + std::sqrt(left)};
    for (std::size_t i = 0; i < half_spaces_; ++i) {
      const Vec3& normal = normals_[i];
      const double rest = most_[i] - normal.y * y - normal.z * z;
      if (normal.x > 0.0) {
        xs.upper = std::min(xs.upper, rest / normal.x);
      } else if (normal.x < 0.0) {
        xs.lower = std::max(xs.lower, rest / normal.x);
      } else if (rest < 0.0) {
        return {0.0, -1.0};
      }
    }
    return xs;
  }

 private:
  static Vec3 unit(const Vec3& v) { return (1.0 / length(v)) * v; }

  // As far as reach_ from a plane with that outward normal of length 1.
  void add_half_space(const Vec3& normal, const Vec3& on_plane) {
    normals_[half_spaces_] = normal;
    most_[half_spaces_++] = dot(normal, on_plane) + reach_;
  }

  [[nodiscard]] double outside(int axis, double x) const {
    return std::max({box_.lower[axis] - x, x - box_.upper[axis], 0.0});
  }

  TriangleDistance triangle_;
  Box box_;
  double reach_;  // the band, and more than roundings take
  std::size_t half_spaces_ = 0;
  std::array<Vec3, 5> normals_;
  std::array<double, 5> most_;  // of normal . p
};

SampleRange samples_in(const std::vector<double>& samples, double per_unit, const Interval& interval) {
  if (interval.empty() || interval.upper < samples.front() || interval.lower > samples.back()) return {0, 0};
  return {static_cast<std::uint32_t>(count_below(samples, per_unit, interval.lower)),
          static_cast<std::uint32_t>(count_up_to(samples, per_unit, interval.upper))};
}

class Rasterization {
 public:
  Rasterization(const TriangleMesh& mesh, const LatticeRows& rows, double band)
      : mesh_(mesh), rows_(rows), band_(band) {}

  void fill(std::span<double> squares) const {
    std::fill(squares.begin(), squares.end(), kNowhere);
    const Visitors visitors = visitors_of_strips();
    parallel_for(strip_count(rows_), 1, [&](std::size_t first, std::size_t last) {
      for (std::size_t strip = first; strip < last; ++strip) {
        for (std::size_t n = visitors.begin[strip]; n < visitors.begin[strip + 1]; ++n) {
          visit(visitors.triangles[n], strip, squares);
        }
      }
    });
  }

 private:
  // The triangles near each strip.
  struct Visitors {
    std::vector<std::size_t> begin;  // per strip, into triangles; and the end
    std::vector<std::uint32_t> triangles;
  };
  struct Visit {
    std::uint32_t strip, triangle;
  };

  [[nodiscard]] Neighbourhood neighbourhood(std::uint32_t triangle) const {
    const Triangle& t = mesh_.triangles[triangle];
    return {mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]], band_};
  }

  [[nodiscard]] SampleRange xs_near(const Interval& xs) const {
    return samples_in(rows_.xs, rows_.samples_per_unit.x, xs);
  }
  [[nodiscard]] SampleRange ys_near(const Neighbourhood& near) const {
    return samples_in(rows_.ys, rows_.samples_per_unit.y, near.along(1));
  }
  [[nodiscard]] SampleRange zs_near(const Neighbourhood& near) const {
    return samples_in(rows_.zs, rows_.samples_per_unit.z, near.along(2));
  }

  void add_visits(std::uint32_t triangle, std::vector<Visit>& visits) const {
    const Neighbourhood near = neighbourhood(triangle);
    const SampleRange xs = xs_near(near.along(0)), ys = ys_near(near), zs = zs_near(near);
    if (xs.empty() || ys.empty() || zs.empty()) return;
    for (std::size_t strip = ys.begin / kStrip; strip <= (ys.end - 1) / kStrip; ++strip) {
      visits.push_back({static_cast<std::uint32_t>(strip), triangle});
    }
  }

  [[nodiscard]] Visitors visitors_of_strips() const {
    std::vector<std::vector<Visit>> parts;
    std::mutex mutex;
    parallel_for(mesh_.triangles.size(), kTrianglesPerTask, [&](std::size_t begin, std::size_t end) {
      std::vector<Visit> visits;
      for (std::size_t i = begin; i < end; ++i) add_visits(static_cast<std::uint32_t>(i), visits);
      const std::lock_guard<std::mutex> lock(mutex);
      parts.push_back(std::move(visits));
    });
    Visitors visitors;
    visitors.begin.assign(strip_count(rows_) + 2, 0);
    for (const auto& part : parts) {
      for (const Visit& visit : part) ++visitors.begin[visit.strip + 2];
    }
    std::partial_sum(visitors.begin.begin(), visitors.begin.end(), visitors.begin.begin());
    visitors.triangles.resize(visitors.begin.back());
    // begin[strip + 1] is the strip's next free index, and its end when all are filled.
    for (const auto& part : parts) {
      for (const Visit& visit : part) visitors.triangles[visitors.begin[visit.strip + 1]++] = visit.triangle;
    }
    return visitors;
  }

  void visit(std::uint32_t triangle, std::size_t strip, std::span<double> squares) const {
    const Neighbourhood near = neighbourhood(triangle);
    const SampleRange ys = ys_near(near), zs = zs_near(near);
    for (std::size_t k = zs.begin; k < zs.end; ++k) {
      const double z = rows_.zs[k];
      for (std::size_t j = std::max<std::size_t>(ys.begin, strip * kStrip);
           j < std::min<std::size_t>(ys.end, (strip + 1) * kStrip); ++j) {
        const double y = rows_.ys[j];
        const SampleRange xs = xs_near(near.along_row(y, z));
        double* const row = &squares[(k * rows_.ys.size() + j) * rows_.xs.size()];
        for (std::size_t i = xs.begin; i < xs.end; ++i) {
          row[i] = std::min(row[i], near.squared_distance({rows_.xs[i], y, z}));
        }
      }
    }
  }

  const TriangleMesh& mesh_;
  const LatticeRows& rows_;
  double band_;
};

// Samples [begin, end) of each axis.
struct SampleBox {
  std::array<std::size_t, 3> begin, end;

  [[nodiscard]] std::size_t side(std::size_t axis) const { return end[axis] - begin[axis]; }
  [[nodiscard]] std::size_t longest_axis() const {
    const std::size_t xy = side(0) >= side(1) ? 0 : 1;
    return side(xy) >= side(2) ? xy : 2;
  }
};

class Descent {
 public:
  Descent(const DistanceTree& tree, const LatticeRows& rows, double band, std::span<double> squares)
      : tree_(tree), rows_(rows), band_(band), squares_(squares) {}

  // `distance`: of `from`, or infinity.
  void fill(const SampleBox& block, const Vec3& from, double distance) const {
    const Vec3 center = center_of(block);
    const double radius = length(center - corner_of(block));
    const double reach = std::min(band_ + radius, distance + length(center - from)) * kSlack;
    const double square = tree_.squared_distance(center, reach * reach);
    if (square == kNowhere) return;  // no sample is within the band
    const std::size_t axis = block.longest_axis();
    if (block.side(axis) <= kSmall) return fill_rows(block, center, std::sqrt(square));
    const std::size_t middle = block.begin[axis] + (block.side(axis) + 1) / 2;
    for (const bool upper : {false, true}) {
      SampleBox half = block;
      (upper ? half.begin : half.end)[axis] = middle;
      fill(half, center, std::sqrt(square));
    }
  }

 private:
  static constexpr std::size_t kSmall = 4;
  static constexpr double kSlack = 1 + 1e-9;  // more than roundings of sums take; the tree adds those of distances

  [[nodiscard]] Vec3 corner_of(const SampleBox& block) const {
    return {rows_.xs[block.begin[0]], rows_.ys[block.begin[1]], rows_.zs[block.begin[2]]};
  }
  [[nodiscard]] Vec3 center_of(const SampleBox& block) const {
    return 0.5 * (corner_of(block) +
                  Vec3{rows_.xs[block.end[0] - 1], rows_.ys[block.end[1] - 1], rows_.zs[block.end[2] - 1]});
  }

  void fill_rows(const SampleBox& block, const Vec3& center, double distance) const {
    for (std::size_t k = block.begin[2]; k < block.end[2]; ++k) {
      for (std::size_t j = block.begin[1]; j < block.end[1]; ++j) {
        double* const row = &squares_[(k * rows_.ys.size() + j) * rows_.xs.size()];
        for (std::size_t i = block.begin[0]; i < block.end[0]; ++i) {
          const Vec3 p{rows_.xs[i], rows_.ys[j], rows_.zs[k]};
          const double reach = std::min(band_, distance + length(p - center)) * kSlack;
          row[i] = tree_.squared_distance(p, reach * reach);
        }
      }
    }
  }

  const DistanceTree& tree_;
  const LatticeRows& rows_;
  double band_;
  std::span<double> squares_;
};

}  // namespace

void rasterize_distances(const TriangleMesh& mesh, const LatticeRows& rows, double band, std::span<double> squares) {
  Rasterization(mesh, rows, band).fill(squares);
}

void descend_to_distances(const DistanceTree& tree, const LatticeRows& rows, double band, std::span<double> squares) {
  std::fill(squares.begin(), squares.end(), kNowhere);
  const Descent descent(tree, rows, band, squares);
  parallel_for(strip_count(rows), 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t strip = first; strip < last; ++strip) {
      const std::size_t end = std::min((strip + 1) * kStrip, rows.ys.size());
      descent.fill({{0, strip * kStrip, 0}, {rows.xs.size(), end, rows.zs.size()}}, {}, kNowhere);
    }
  });
}

bool descent_is_faster(const TriangleMesh& mesh, double band) {
  // Measured: a look-up costs as much as some dozens of distances.
  constexpr double kDistancesPerLookUp = 30;
  double visits = 0.0, look_ups = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const Vec3 normal = cross(b - a, c - a);
    const double area = 0.5 * std::sqrt(dot(normal, normal));
    const double perimeter = length(b - a) + length(c - b) + length(a - c);
    visits += 2 * band * area + 1.6 * band * band * perimeter + 4.2 * band * band * band;  // volume within the band
    look_ups += 2 * band * area;
  }
  return visits > kDistancesPerLookUp * look_ups;
}

}  // namespace raycone
