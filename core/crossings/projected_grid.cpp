#include "core/crossings/projected_grid.h"

#include <array>
#include <cmath>
#include <limits>

#include "core/crossings/crossings.h"
#include "core/data/interval.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// Farther out by more than the rounding to float.
float rounded_up(double x) { return static_cast<float>(x + std::abs(x) * 0x1p-22 + 0x1p-120); }

constexpr double kMortonCodesPerSide = 256;

// The lower 8 bits of v in the even places.
std::uint32_t spread(std::uint32_t v) {
  v = (v | (v << 4)) & 0x0F0FU;
  v = (v | (v << 2)) & 0x3333U;
  return (v | (v << 1)) & 0x5555U;
}

constexpr Interval kNothing{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
constexpr Interval kEverything{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};

}  // namespace

// ---- The filter ------------------------------------------------------------------------------------------------

// With v = 2^-24 and all |Y|, |Z| at most 1: a coefficient, a coordinate and their product are rounded once each, then
// the sum of the two products, its sum with `one` (rounded too) and the difference to X (rounded too, |X| <= 2). That
// is less than 6 v (|y| + |z|) + 3 v |one| + 4 v, the last term in lane 3 only. The double arithmetic behind the
// coefficients adds less than a thousandth of it; 2^-100 stands for underflow.
ProjectedGrid::Filter ProjectedGrid::filter_of(const Vec3& a, const Vec3& b, const Vec3& c) const {
  Filter filter{};
  const auto set = [&](int lane, double y, double z, double one, double error) {
    constexpr double v = 0x1p-24;
    filter.y[lane] = static_cast<float>(y);
    filter.z[lane] = static_cast<float>(z);
    filter.one[lane] = static_cast<float>(one);
    filter.error[lane] =
        rounded_up(6.01 * v * (std::abs(y) + std::abs(z)) + 3.01 * v * std::abs(one) + error + 0x1p-100);
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
  constexpr double kSteepest = 0x1p60;  // far within the range of floats
  if (error < 1.0 && std::abs(y) + std::abs(z) + std::abs(one) < kSteepest) {
    set(3, y, z, one, error);
  } else {
    filter.error[3] = std::numeric_limits<float>::infinity();
  }
  return filter;
}

// ---- The cells of a triangle -----------------------------------------------------------------------------------

namespace {

// An edge's projection: the line y = at_y + slope (z - at_z), and the part of it between the ends.
struct EdgeLine {
  Interval y, z;
  double at_y = 0, at_z = 0;
  double slope = 0;
  bool has_line = false;  // false: it projects to a point, which ties with every ray

  // The line's y where z is in `row`, which is bounded, up to rounding.
  [[nodiscard]] Interval along(const Interval& row) const {
    if (!has_line) return kEverything;
    if (std::isinf(slope)) return row.lower <= at_z && at_z <= row.upper ? kEverything : kNothing;
    const auto [lower, upper] = std::minmax({at_y + slope * (row.lower - at_z), at_y + slope * (row.upper - at_z)});
    return {lower, upper};
  }
};

struct Rectangle {
  Interval y, z;
};

// In the plane of y and z.
struct Point2 {
  double y, z;
};
using Triangle2 = std::array<Point2, 3>;

Rectangle box_of(const Triangle2& t) {
  const auto [lower_y, upper_y] = std::minmax({t[0].y, t[1].y, t[2].y});
  const auto [lower_z, upper_z] = std::minmax({t[0].z, t[1].z, t[2].z});
  return {{lower_y, upper_y}, {lower_z, upper_z}};
}

bool same(const Point2& a, const Point2& b) { return a.y == b.y && a.z == b.z; }

// Of what a triangle fills: itself, or its box if an edge ties everywhere. Without the lines of its edges.
double filled_area(const Triangle2& t, const Rectangle& box) {
  const double all = (box.y.upper - box.y.lower) * (box.z.upper - box.z.lower);
  if (same(t[0], t[1]) || same(t[1], t[2]) || same(t[2], t[0])) return all;
  return 0.5 * std::abs((t[1].y - t[0].y) * (t[2].z - t[0].z) - (t[1].z - t[0].z) * (t[2].y - t[0].y));
}

}  // namespace

// Chooses the cells and fills them.
class ProjectedGrid::Builder {
 public:
  Builder(const TriangleMesh& mesh, ProjectedGrid& result);
  void build();

 private:
  // Grids lie within one another at most this deep, and no cell is smaller than this: far above the rounding of local
  // coordinates, far below what meshes need.
  static constexpr int kMaxDepth = 4;
  static constexpr double kSmallestCell = 0x1p-30;
  // What is added to cells and triangles on all sides, in cells: rounding is far below.
  static constexpr double kMargin = 0x1p-16;

  [[nodiscard]] std::array<EdgeLine, 3> edges(std::uint32_t triangle) const;
  [[nodiscard]] std::vector<Entry> all_entries() const;
  [[nodiscard]] Grid choose(const Rectangle& box, std::span<const Entry> entries, double entries_per_triangle) const;
  void add(std::uint32_t grid_number, std::span<const Entry> entries, int depth);
  void finish(std::uint64_t cell, const Rectangle& box, std::span<const Entry> entries, int depth);

  template <class Visit>
  static void visit_row(const Grid& grid, const Rectangle& box, const std::array<EdgeLine, 3>& edges, std::uint32_t row,
                        const Visit& visit);
  // Calls visit(cell) for each cell of the grid that the triangle belongs to, counted from its first one.
  template <class Visit>
  void visit_cells(const Grid& grid, std::uint32_t triangle, const Visit& visit) const;

  const TriangleMesh& mesh_;
  ProjectedGrid& result_;
  std::vector<Triangle2> projections_;  // of result_.triangles_
};

ProjectedGrid::Builder::Builder(const TriangleMesh& mesh, ProjectedGrid& result) : mesh_(mesh), result_(result) {
  projections_.reserve(result.triangles_.size());
  for (const std::uint32_t triangle : result.triangles_) {
    Triangle2 projection;
    for (std::size_t i = 0; i < 3; ++i) {
      const Local p = result.local(mesh.vertices[mesh.triangles[triangle][i]]);
      projection[i] = {p.y, p.z};
    }
    projections_.push_back(projection);
  }
}

// The slopes from the differences of the mesh's own coordinates, which short edges need.
std::array<EdgeLine, 3> ProjectedGrid::Builder::edges(std::uint32_t triangle) const {
  const Triangle& t = mesh_.triangles[result_.triangles_[triangle]];
  const Triangle2& at = projections_[triangle];
  std::array<EdgeLine, 3> edges;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const double dy = mesh_.vertices[t[j]].y - mesh_.vertices[t[i]].y;
    const double dz = mesh_.vertices[t[j]].z - mesh_.vertices[t[i]].z;
    const auto [lower_y, upper_y] = std::minmax(at[i].y, at[j].y);
    const auto [lower_z, upper_z] = std::minmax(at[i].z, at[j].z);
    const bool has_line = std::isfinite(dy) && std::isfinite(dz) && (dy != 0.0 || dz != 0.0);
    edges[i] = {{lower_y, upper_y}, {lower_z, upper_z}, at[i].y, at[i].z, has_line ? dy / dz : 0.0, has_line};
  }
  return edges;
}

// A triangle belongs to the cells that it meets, and to those that the lines of its edges meet within its box: there D
// may be 0.
template <class Visit>
void ProjectedGrid::Builder::visit_row(const Grid& grid, const Rectangle& box, const std::array<EdgeLine, 3>& edges,
                                       std::uint32_t row, const Visit& visit) {
  const double height = 1.0 / grid.rows_per_unit, margin_z = kMargin * height;
  const double margin_y = kMargin / grid.columns_per_unit;
  const Interval slab{grid.lower_z + row * height - margin_z, grid.lower_z + (row + 1) * height + margin_z};
  const Interval in_box = intersection(slab, widened(box.z, margin_z));
  if (in_box.empty()) return;
  std::array<Interval, 4> parts;
  parts[3] = kNothing;  // the triangle itself
  for (std::size_t i = 0; i < 3; ++i) {
    const EdgeLine& edge = edges[i];
    parts[i] = intersection(widened(edge.along(in_box), margin_y), widened(box.y, margin_y));
    if (intersection(slab, edge.z).empty()) continue;
    parts[3] = hull(parts[3], intersection(parts[i], widened(edge.y, margin_y)));
  }
  std::sort(parts.begin(), parts.end(), [](const Interval& a, const Interval& b) { return a.lower < b.lower; });
  std::uint32_t next = 0;
  for (const Interval& part : parts) {
    if (part.empty()) continue;
    const std::uint32_t last = grid.column(part.upper);
    for (next = std::max(next, grid.column(part.lower)); next <= last; ++next) visit(row * grid.columns + next);
  }
}

template <class Visit>
void ProjectedGrid::Builder::visit_cells(const Grid& grid, std::uint32_t triangle, const Visit& visit) const {
  const Rectangle box = box_of(projections_[triangle]);
  const double margin_y = kMargin / grid.columns_per_unit, margin_z = kMargin / grid.rows_per_unit;
  const std::uint32_t first_row = grid.row(box.z.lower - margin_z), last_row = grid.row(box.z.upper + margin_z);
  const std::uint32_t first = grid.column(box.y.lower - margin_y), last = grid.column(box.y.upper + margin_y);
  constexpr std::uint64_t kFew = 6;  // not worth the rows
  if (std::uint64_t{last - first + 1} * (last_row - first_row + 1) <= kFew) {
    for (std::uint32_t row = first_row; row <= last_row; ++row) {
      for (std::uint32_t column = first; column <= last; ++column) visit(row * grid.columns + column);
    }
    return;
  }
  const std::array<EdgeLine, 3> its_edges = edges(triangle);
  for (std::uint32_t row = first_row; row <= last_row; ++row) visit_row(grid, box, its_edges, row, visit);
}

// ---- The grid --------------------------------------------------------------------------------------------------

// Cells have the proportions of the triangles, w h of mean width and height, and are t times as large. A triangle of
// area A belongs to about 1 + 2 / t + A / (t^2 w h) of them: for a wanted mean, t is the root of a quadratic. There are
// not many more than two cells per entry.
ProjectedGrid::Grid ProjectedGrid::Builder::choose(const Rectangle& box, std::span<const Entry> entries,
                                                   double entries_per_triangle) const {
  const auto n = static_cast<double>(entries.size());
  const double width = box.y.upper - box.y.lower, height = box.z.upper - box.z.lower;
  double widths = 0.0, heights = 0.0, areas = 0.0;
  for (const Entry& entry : entries) {
    const Triangle2& t = projections_[entry.triangle];
    const Rectangle its_box = box_of(t);
    const Interval y = intersection(its_box.y, box.y), z = intersection(its_box.z, box.z);
    const double w = std::max(y.upper - y.lower, 0.0), h = std::max(z.upper - z.lower, 0.0);
    widths += w;
    heights += h;
    areas += std::min(w * h, filled_area(t, its_box));
  }
  const double mean_width = std::max(widths / n, kSmallestCell), mean_height = std::max(heights / n, kSmallestCell);
  const double more = entries_per_triangle - 1.0;
  double t = (1.0 + std::sqrt(1.0 + more * areas / (n * mean_width * mean_height))) / more;
  // Along each axis, too: where triangles are as high as the box, columns alone are all cells. 32 bits count them.
  const double cells = 2.0 * std::min(n, 0x1p28), across = width / mean_width, along = height / mean_height;
  t = std::max({t, std::sqrt((across + 1.0) * (along + 1.0) / cells), across / cells, along / cells});
  Grid grid{box.y.lower, box.z.lower, 1.0 / (t * mean_width), 1.0 / (t * mean_height), 1, 1, 0};
  grid.columns = static_cast<std::uint32_t>(std::max(std::ceil(width * grid.columns_per_unit), 1.0));
  grid.rows = static_cast<std::uint32_t>(std::max(std::ceil(height * grid.rows_per_unit), 1.0));
  return grid;
}

void ProjectedGrid::Builder::add(std::uint32_t grid_number, std::span<const Entry> entries, int depth) {
  const Grid grid = result_.grids_[grid_number];
  const std::size_t cells = std::size_t{grid.columns} * grid.rows;
  struct Membership {
    std::uint32_t cell, entry;
  };
  std::vector<Membership> members;
  std::vector<std::uint64_t> ends(cells + 1, 0);
  for (std::uint32_t i = 0; i < entries.size(); ++i) {
    visit_cells(grid, entries[i].triangle, [&](std::uint32_t cell) {
      members.push_back({cell, i});
      ++ends[cell + 1];
    });
  }
  for (std::size_t i = 1; i <= cells; ++i) ends[i] += ends[i - 1];
  std::vector<Entry> list(members.size());
  std::vector<std::uint64_t> next(ends.begin(), ends.end() - 1);
  for (const Membership& member : members) list[next[member.cell]++] = entries[member.entry];
  result_.grids_[grid_number].first_cell = result_.cells_.size();
  const std::uint64_t first = result_.cells_.size();
  result_.cells_.resize(first + cells);
  const double width = 1.0 / grid.columns_per_unit, height = 1.0 / grid.rows_per_unit;
  for (std::size_t i = 0; i < cells; ++i) {
    const std::size_t column = i % grid.columns, row = i / grid.columns;
    const double y = grid.lower_y + static_cast<double>(column) * width;
    const double z = grid.lower_z + static_cast<double>(row) * height;
    finish(first + i, {{y, y + width}, {z, z + height}}, std::span(list).subspan(ends[i], ends[i + 1] - ends[i]),
           depth);
  }
}

// A crowded cell becomes a grid where that spreads its entries.
void ProjectedGrid::Builder::finish(std::uint64_t cell, const Rectangle& box, std::span<const Entry> entries,
                                    int depth) {
  constexpr std::size_t kCrowded = 32;
  constexpr double kEntriesPerTriangle = 2.0;
  if (entries.size() > kCrowded && depth < kMaxDepth) {
    const Grid grid = choose(box, entries, kEntriesPerTriangle);
    if (std::size_t{grid.columns} * grid.rows >= 4) {
      const auto number = static_cast<std::uint32_t>(result_.grids_.size());
      result_.cells_[cell].grid = number;
      result_.grids_.push_back(grid);
      return add(number, entries, depth + 1);
    }
  }
  result_.cells_[cell].first_entry = result_.entries_.size();
  result_.cells_[cell].entries = static_cast<std::uint32_t>(entries.size());
  result_.entries_.insert(result_.entries_.end(), entries.begin(), entries.end());
  std::sort(result_.entries_.end() - static_cast<std::ptrdiff_t>(entries.size()), result_.entries_.end(),
            [](const Entry& a, const Entry& b) { return a.upper_x > b.upper_x; });
}

std::vector<ProjectedGrid::Entry> ProjectedGrid::Builder::all_entries() const {
  std::vector<Entry> entries;
  entries.reserve(projections_.size());
  for (std::uint32_t i = 0; i < projections_.size(); ++i) {
    const Triangle& t = mesh_.triangles[result_.triangles_[i]];
    const double upper = std::max({mesh_.vertices[t[0]].x, mesh_.vertices[t[1]].x, mesh_.vertices[t[2]].x});
    entries.push_back({rounded_up(result_.local({upper, 0, 0}).x), i});
  }
  return entries;
}

void ProjectedGrid::Builder::build() {
  constexpr double kEntriesPerTriangle = 8.0;
  const std::vector<Entry> entries = all_entries();
  const Rectangle box{{result_.lower_.y, result_.upper_.y}, {result_.lower_.z, result_.upper_.z}};
  result_.grids_.push_back(choose(box, entries, kEntriesPerTriangle));
  add(0, entries, 0);
}

// ---- The whole -------------------------------------------------------------------------------------------------

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
  for (int axis = 0; axis < 3; ++axis) centre_[axis] = box.lower[axis] / 2 + box.upper[axis] / 2;
  unit_ = unit_of(box);
  lower_ = local(box.lower);
  upper_ = local(box.upper);
  codes_per_y_ = kMortonCodesPerSide / (upper_.y - lower_.y);
  codes_per_z_ = kMortonCodesPerSide / (upper_.z - lower_.z);
  triangles_ = in_morton_order(mesh);
  filters_.resize(triangles_.size());
  constexpr std::size_t kTrianglesOfATask = 4096;
  parallel_for(filters_.size(), kTrianglesOfATask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Triangle& t = mesh.triangles[triangles_[i]];
      filters_[i] = filter_of(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
    }
  });
  Builder(mesh, *this).build();
}

// A counting sort by the code of one corner.
std::vector<std::uint32_t> ProjectedGrid::in_morton_order(const TriangleMesh& mesh) const {
  std::vector<std::uint32_t> order(mesh.triangles.size());
  std::vector<std::uint32_t> next(kMortonCodes + 1, 0);
  const auto code_of = [&](const Triangle& t) { return morton_code(mesh.vertices[t[0]]); };
  for (const Triangle& t : mesh.triangles) ++next[code_of(t) + 1];
  for (std::size_t i = 1; i <= kMortonCodes; ++i) next[i] += next[i - 1];
  for (std::uint32_t i = 0; i < order.size(); ++i) order[next[code_of(mesh.triangles[i])]++] = i;
  return order;
}

std::uint16_t ProjectedGrid::morton_code(const Vec3& q) const {
  const Local p = local(q);
  const auto quantized = [](double x, double lower, double codes_per_unit) {
    const double at = (x - lower) * codes_per_unit;
    return at > 0.0 ? static_cast<std::uint32_t>(std::min(at, kMortonCodesPerSide - 1)) : 0U;
  };
  return static_cast<std::uint16_t>(spread(quantized(p.y, lower_.y, codes_per_y_)) |
                                    (spread(quantized(p.z, lower_.z, codes_per_z_)) << 1));
}

}  // namespace raycone
