#include "core/crossings/projected_grid.h"

#include <emmintrin.h>

#include <cmath>
#include <limits>

#include "core/crossings/crossings.h"
#include "core/crossings/projected_grid_builder.h"
#include "core/machine/threads.h"

namespace raycone {

// --- The filter -----------------------------------------------------------------------------------------------------

// With v = 2^-24 and all |Y|, |Z| at most 1: a coefficient, a coordinate and their product are rounded once each, then
// the sum of the two products, its sum with `one` (rounded too) and the difference to X (rounded too, |X| <= 2). That
// is less than 6 v (|y| + |z|) + 3 v |one| + 4 v, the last term in lane 3 only. The double arithmetic behind the
// coefficients adds less than a thousandth of it; 2^-100 stands for underflow.
ProjectedGrid::Filter ProjectedGrid::filter_of(const Vec3& a, const Vec3& b, const Vec3& c) const {
  Filter filter{};
  const auto set = [&](int lane, double y, double z, double one, double error) {
    constexpr double v = 0x1p-24;
    const double bound = 6.01 * v * (std::abs(y) + std::abs(z)) + 3.01 * v * std::abs(one) + error + 0x1p-100;
    constexpr double kMost = 0x1p60;  // far within the range of floats
    if (!(bound < kMost)) {           // NaN, too: the mesh's differences overflow. Lanes are to be numbers.
      filter.error[lane] = std::numeric_limits<float>::infinity();
      return;
    }
    filter.y[lane] = static_cast<float>(y);
    filter.z[lane] = static_cast<float>(z);
    filter.one[lane] = static_cast<float>(one);
    filter.error[lane] = rounded_up(bound);
  };
  const auto set_edge = [&](int lane, const Vec3& from, const Vec3& to) {
    const Local at = local(from);
    const double y = unit_(from.z - to.z), z = unit_(to.y - from.y);
    set(lane, y, z, -(y * at.y + z * at.z), 0.0);
  };
  set_edge(0, a, b);
  set_edge(1, b, c);
  set_edge(2, c, a);
  const TrianglePlane plane(a, b, c);
  const Local at = local(a);
  const double y = -plane.normal.y / plane.normal.x, z = -plane.normal.z / plane.normal.x;
  const double one = at.x - (y * at.y + z * at.z), error = unit_(plane.error) + 0x1p-22;
  set(3, y, z, one, error);
  return filter;
}

// --- Rays -----------------------------------------------------------------------------------------------------------

// What is done for each query is written in vectors, y in the lower lane and z in the upper one: compilers make
// branches of minima and comparisons, which no processor can foresee.
class ProjectedGrid::Coordinates {
 public:
  explicit Coordinates(const ProjectedGrid& grid)
      : unit_(_mm_set1_pd(grid.unit_.factors()[0])),
        other_unit_(_mm_set1_pd(grid.unit_.factors()[1])),
        centre_(_mm_set_pd(grid.centre_.z, grid.centre_.y)),
        centre_x_(_mm_set_sd(grid.centre_.x)),
        lower_(_mm_set_pd(grid.lower_.z, grid.lower_.y)),
        upper_(_mm_set_pd(grid.upper_.z, grid.upper_.y)),
        upper_x_(_mm_set_sd(grid.upper_.x)),
        codes_per_unit_(_mm_set_pd(grid.codes_per_z_, grid.codes_per_y_)) {}

  static_assert(offsetof(Vec3, z) == offsetof(Vec3, y) + sizeof(double));
  [[nodiscard]] __m128d yz(const Vec3& q) const { return in_units(_mm_sub_pd(_mm_loadu_pd(&q.y), centre_)); }
  [[nodiscard]] __m128d x(const Vec3& q) const { return in_units(_mm_sub_sd(_mm_set_sd(q.x), centre_x_)); }

  // Whether the ray may meet the mesh's box: 1, else 0.
  [[nodiscard]] int may_meet_box(__m128d x, __m128d yz) const {
    const int inside = _mm_movemask_pd(_mm_and_pd(_mm_cmpge_pd(yz, lower_), _mm_cmple_pd(yz, upper_)));
    return static_cast<int>(inside == 0b11) & _mm_comile_sd(x, upper_x_);
  }

  [[nodiscard]] std::uint16_t morton_code(__m128d yz) const {
    const __m128d at = _mm_mul_pd(_mm_sub_pd(yz, lower_), codes_per_unit_);
    const __m128d within = _mm_min_pd(_mm_max_pd(at, _mm_setzero_pd()), _mm_set1_pd(kCodesPerSide - 1));  // NaN: 0
    const auto codes = static_cast<std::uint64_t>(_mm_cvtsi128_si64(_mm_cvttpd_epi32(within)));
    return interleaved(static_cast<std::uint32_t>(codes | codes >> 16));
  }

  // As to_float().
  static __m128 to_float(__m128d x) {
    return _mm_cvtsd_ss(_mm_setzero_ps(), _mm_min_sd(_mm_max_sd(x, _mm_set_sd(-2.0)), _mm_set_sd(2.0)));
  }

 private:
  [[nodiscard]] __m128d in_units(__m128d v) const { return _mm_mul_pd(_mm_mul_pd(v, unit_), other_unit_); }

  __m128d unit_, other_unit_, centre_, centre_x_, lower_, upper_, upper_x_, codes_per_unit_;
};

std::uint16_t ProjectedGrid::morton_code(const Vec3& q) const {
  const Coordinates coordinates(*this);
  return coordinates.morton_code(coordinates.yz(q));
}

void ProjectedGrid::find_places(std::span<const Vec3> queries, std::span<Place> places) const {
  const Coordinates coordinates(*this);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const __m128d x = coordinates.x(queries[i]), yz = coordinates.yz(queries[i]);
    const std::uint16_t code = coordinates.morton_code(yz);
    const int ahead = _mm_comige_ss(_mm_set_ss(farthest(code)), Coordinates::to_float(x));
    places[i] = {code, (coordinates.may_meet_box(x, yz) & ahead) != 0};
  }
}

// Some rays that go through each step together: what the next step needs is fetched meanwhile.
class ProjectedGrid::Lookup {
 public:
  Lookup(const ProjectedGrid& grid, std::span<std::int64_t> n, std::vector<RayCandidate>& doubtful)
      : grid_(grid), n_(n), doubtful_(doubtful), coordinates_(grid), root_(grid.grids_.front()) {}

  static constexpr std::size_t kRays = 64;

  // At most kRays; `first` is the number of the first one.
  void cross(std::span<const Vec3> queries, std::size_t first) {
    enter(queries, first);
    find_cells();
    for (std::size_t i = 0; i < rays_; ++i) pair_with_entries(i);
    decide(pairs_);
    pairs_ = 0;
    for (std::size_t i = 0; i < rays_; ++i) n_[ray_[i].query] = ray_[i].n;
  }

 private:
  struct Ray {
    __m128 x, y, z;  // as lanes of filters are compared with them
    __m128d yz;
    const Cell* cell;
    std::int64_t n;
    std::uint32_t query;
  };
  template <class T>
  static void prefetch(const T* address) {
    _mm_prefetch(reinterpret_cast<const char*>(address), _MM_HINT_T0);
  }

  // The cells of the first grid.
  class RootCells {
   public:
    explicit RootCells(const Grid& grid)
        : lower_(_mm_set_pd(grid.lower_z, grid.lower_y)),
          per_unit_(_mm_set_pd(grid.rows_per_unit, grid.columns_per_unit)),
          last_(_mm_set_pd(grid.rows - 1.0, grid.columns - 1.0)),
          columns_(grid.columns) {}
    // As Grid::cell().
    [[nodiscard]] std::uint64_t operator()(__m128d yz) const {
      const __m128d at = _mm_mul_pd(_mm_sub_pd(yz, lower_), per_unit_);
      const auto places = static_cast<std::uint64_t>(
          _mm_cvtsi128_si64(_mm_cvttpd_epi32(_mm_min_pd(_mm_max_pd(at, _mm_setzero_pd()), last_))));
      return (places >> 32) * columns_ + static_cast<std::uint32_t>(places);
    }

   private:
    __m128d lower_, per_unit_, last_;
    std::uint64_t columns_;
  };

  // Keeps the rays that may meet the mesh's box.
  void enter(std::span<const Vec3> queries, std::size_t first) {
    rays_ = 0;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const __m128d x = coordinates_.x(queries[i]), yz = coordinates_.yz(queries[i]);
      const __m128 yz_floats = _mm_cvtpd_ps(yz);
      Ray& ray = ray_[rays_];
      ray.cell = &grid_.cells_[root_(yz)];
      prefetch(ray.cell);
      ray.yz = yz;
      ray.y = _mm_shuffle_ps(yz_floats, yz_floats, _MM_SHUFFLE(0, 0, 0, 0));
      ray.z = _mm_shuffle_ps(yz_floats, yz_floats, _MM_SHUFFLE(1, 1, 1, 1));
      ray.x = in_last_lane(Coordinates::to_float(x));
      ray.n = 0;
      ray.query = static_cast<std::uint32_t>(first + i);
      rays_ += static_cast<std::size_t>(coordinates_.may_meet_box(x, yz));
    }
  }

  static __m128 in_last_lane(__m128 lowest) { return _mm_shuffle_ps(lowest, lowest, _MM_SHUFFLE(0, 3, 2, 1)); }
  static float last_lane(__m128 lanes) { return _mm_cvtss_f32(_mm_shuffle_ps(lanes, lanes, _MM_SHUFFLE(3, 3, 3, 3))); }

  void find_cells() {
    const std::size_t entered = rays_;
    rays_ = 0;
    for (std::size_t i = 0; i < entered; ++i) {
      Ray ray = ray_[i];
      while (ray.cell->holds_grid()) {
        const double y = _mm_cvtsd_f64(ray.yz), z = _mm_cvtsd_f64(_mm_unpackhi_pd(ray.yz, ray.yz));
        ray.cell = &grid_.cells_[grid_.grids_[ray.cell->first].cell(y, z)];
      }
      prefetch(grid_.entries_.get() + ray.cell->first);
      prefetch(grid_.entries_.get() + ray.cell->first + 8);
      ray_[rays_] = ray;
      rays_ += ray.cell->upper_x >= last_lane(ray.x) ? 1 : 0;
    }
  }

  void pair_with_entries(std::size_t i) {
    const Cell& cell = *ray_[i].cell;
    const float x = last_lane(ray_[i].x);
    const Filter* const filters = grid_.filters_.get();
    std::size_t pairs = pairs_;
    for (const Entry& entry : std::span(grid_.entries_.get() + cell.first, cell.entries)) {
      if (entry.upper_x < x) break;
      prefetch(filters + entry.triangle);
      ray_of_pair_[pairs] = static_cast<std::uint32_t>(i);
      triangle_of_pair_[pairs] = entry.triangle;
      if (++pairs < kPairs) continue;
      decide(pairs);
      pairs = 0;
    }
    pairs_ = pairs;
  }

  // Bit i: lane i of the filter is certainly positive; bit 4 + i: it is certainly negative. By sign bits, which NaN
  // would have, too: lanes are numbers, and so are their differences to an error that is infinite.
  static unsigned signs(const Filter& f, const Ray& ray) {
    const __m128 plane = _mm_add_ps(_mm_mul_ps(_mm_load_ps(f.y), ray.y), _mm_mul_ps(_mm_load_ps(f.z), ray.z));
    const __m128 value = _mm_sub_ps(_mm_add_ps(plane, _mm_load_ps(f.one)), ray.x);
    const __m128 error = _mm_load_ps(f.error);
    const int positive = _mm_movemask_ps(_mm_sub_ps(error, value)),
              negative = _mm_movemask_ps(_mm_add_ps(value, error));
    return static_cast<unsigned>(positive | negative << 4);
  }

  // What these signs mean: the sign of a crossing, 0 for none, or kUncertain.
  static constexpr std::int8_t kUncertain = 2;
  static constexpr std::array<std::int8_t, 256> kMeanings = [] {
    std::array<std::int8_t, 256> meanings{};
    constexpr unsigned kEdges = 0b0111, kAhead = 0b1000;
    for (unsigned signs = 0; signs < meanings.size(); ++signs) {
      const unsigned positive = signs & 0b1111, negative = signs >> 4;
      const int left = (positive & kEdges) == kEdges, right = (negative & kEdges) == kEdges;
      const unsigned needed = kEdges | (left + right != 0 ? kAhead : 0);
      const bool certain = ((positive | negative) & needed) == needed;
      const int crossed = (positive & kAhead) != 0 ? left - right : 0;
      meanings[signs] = certain ? static_cast<std::int8_t>(crossed) : kUncertain;
    }
    return meanings;
  }();

  // Of so many pairs.
  void decide(std::size_t pairs) {
    const Filter* const filters = grid_.filters_.get();
    for (std::size_t i = 0; i < pairs; ++i) {
      const std::uint32_t triangle = triangle_of_pair_[i];
      Ray& ray = ray_[ray_of_pair_[i]];
      const std::int8_t meaning = kMeanings[signs(filters[triangle], ray)];
      if (meaning == kUncertain) {
        doubtful_.push_back({ray.query, grid_.triangles_[triangle]});
      } else {
        ray.n += meaning;
      }
    }
  }

  const ProjectedGrid& grid_;
  std::span<std::int64_t> n_;
  std::vector<RayCandidate>& doubtful_;
  Coordinates coordinates_;
  RootCells root_;
  std::size_t rays_ = 0, pairs_ = 0;
  std::array<Ray, kRays> ray_;
  static constexpr std::size_t kPairs = 256;  // their filters fit the first-level cache
  std::array<std::uint32_t, kPairs> ray_of_pair_;
  std::array<std::uint32_t, kPairs> triangle_of_pair_;  // its index in triangles_
};

void ProjectedGrid::crossings(std::span<const Vec3> queries, std::span<std::int64_t> n,
                              std::vector<RayCandidate>& doubtful) const {
  std::ranges::fill(n, 0);
  Lookup lookup(*this, n, doubtful);
  for (std::size_t first = 0; first < queries.size(); first += Lookup::kRays) {
    lookup.cross(queries.subspan(first, std::min(Lookup::kRays, queries.size() - first)), first);
  }
}

// --- How far triangles reach ----------------------------------------------------------------------------------------

// From the cells of the first grid that the rays of a square of codes may be in.
void ProjectedGrid::set_farthest() {
  constexpr std::size_t kNumbersPerTriangle = 16;  // at least: few beside what a triangle takes itself
  constexpr int kMostCoarser = 5;
  while (coarser_ < kMostCoarser && kMortonCodes >> 2 * (coarser_ + 1) >= kNumbersPerTriangle * triangles_.size()) {
    ++coarser_;
  }
  const std::uint32_t squares_per_side = kCodesPerSide >> coarser_;
  const Grid& grid = grids_.front();
  struct Range {
    std::uint32_t first, last;
  };
  const auto range = [&](std::uint32_t square, double lower, double codes_per_unit, std::uint32_t count, auto index) {
    const auto at = [&](double code) { return index(lower + code / codes_per_unit); };
    return Range{square == 0 ? 0 : at((square << coarser_) - kMargin),
                 square == squares_per_side - 1 ? count - 1 : at(((square + 1) << coarser_) + kMargin)};
  };
  farthest_.resize(std::size_t{squares_per_side} * squares_per_side);
  parallel_for(squares_per_side, 8, [&](std::size_t begin, std::size_t end) {
    std::vector<float> of_columns(grid.columns);
    for (auto z = static_cast<std::uint32_t>(begin); z < end; ++z) {
      const Range rows = range(z, lower_.z, codes_per_z_, grid.rows, [&](double at) { return grid.row(at); });
      std::ranges::fill(of_columns, -std::numeric_limits<float>::infinity());
      for (std::uint32_t row = rows.first; row <= rows.last; ++row) {
        const Cell* const cells = &cells_[std::uint64_t{row} * grid.columns];
        for (std::uint32_t i = 0; i < grid.columns; ++i) of_columns[i] = std::max(of_columns[i], cells[i].upper_x);
      }
      for (std::uint32_t y = 0; y < squares_per_side; ++y) {
        const Range columns =
            range(y, lower_.y, codes_per_y_, grid.columns, [&](double at) { return grid.column(at); });
        farthest_[interleaved(y | z << 16)] =
            *std::max_element(of_columns.begin() + columns.first, of_columns.begin() + columns.last + 1);
      }
    }
  });
}

// --- The whole ------------------------------------------------------------------------------------------------------

namespace {

// The power of two that brings half the box's longest side to at most 1.
PowerOfTwo unit_of(const Box& box) {
  double reach = 0.0;
  for (int axis = 0; axis < 3; ++axis) reach = std::max(reach, box.upper[axis] / 2 - box.lower[axis] / 2);
  int exponent = 0;
  (void)std::frexp(reach, &exponent);
  return PowerOfTwo(-exponent);
}

}  // namespace

ProjectedGrid::ProjectedGrid(const TriangleMesh& mesh) : unit_(0) {
  const Box box = bounding_box(mesh);
  centre_ = middle(box);
  unit_ = unit_of(box);
  lower_ = local(box.lower);
  upper_ = local(box.upper);
  codes_per_y_ = kCodesPerSide / (upper_.y - lower_.y);
  codes_per_z_ = kCodesPerSide / (upper_.z - lower_.z);
  ProjectedGridBuilder(mesh, *this).build();
  set_farthest();
}

}  // namespace raycone
