#include "core/crossings/projected_grid_builder.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/machine/buckets.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

constexpr std::size_t kTrianglesOfATask = 4096;

constexpr Interval kEverything{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};

// Not of lists, whose loops branch.
double least(double a, double b, double c) { return std::min(std::min(a, b), c); }
double largest(double a, double b, double c) { return std::max(std::max(a, b), c); }
Interval spanned(double a, double b) { return {std::min(a, b), std::max(a, b)}; }
Interval spanned(double a, double b, double c) { return {least(a, b, c), largest(a, b, c)}; }

}  // namespace

// --- Triangles ------------------------------------------------------------------------------------------------------

// An edge's projection: the line y = at_y + slope (z - at_z), and the part of it between the ends.
struct ProjectedGridBuilder::EdgeLine {
  Interval y, z;
  double at_y = 0, at_z = 0;
  double slope = 0;
  bool has_line = false;  // false: it projects to a point, which ties with every ray

  // The line's y where z is in `row`, which is bounded, up to rounding.
  [[nodiscard]] Interval along(const Interval& row) const {
    if (!has_line) return kEverything;
    if (std::isinf(slope)) return row.lower <= at_z && at_z <= row.upper ? kEverything : kEmptyInterval;
    return spanned(at_y + slope * (row.lower - at_z), at_y + slope * (row.upper - at_z));
  }
};

ProjectedGridBuilder::Footprint ProjectedGridBuilder::footprint(const Triangle& t) const {
  const Local a = result_.local(mesh_.vertices[t[0]]), b = result_.local(mesh_.vertices[t[1]]);
  const Local c = result_.local(mesh_.vertices[t[2]]);
  const Rectangle box{spanned(a.y, b.y, c.y), spanned(a.z, b.z, c.z)};
  const auto same = [](const Local& p, const Local& q) { return p.y == q.y && p.z == q.z; };
  const double area = same(a, b) || same(b, c) || same(c, a)
                          ? (box.y.upper - box.y.lower) * (box.z.upper - box.z.lower)
                          : 0.5 * std::abs((b.y - a.y) * (c.z - a.z) - (b.z - a.z) * (c.y - a.y));
  return {box, area, rounded_up(largest(a.x, b.x, c.x))};
}

// Puts the triangles in the order of one of their corners along the Z-curve.
void ProjectedGridBuilder::set_triangles() {
  constexpr std::size_t kCodesPerBucket = 16;
  const std::size_t count = mesh_.triangles.size();
  std::vector<std::uint16_t> codes(count);
  parallel_for_each(count, kTrianglesOfATask,
                    [&](std::size_t i) { codes[i] = result_.morton_code(mesh_.vertices[mesh_.triangles[i][0]]); });
  const Buckets<std::uint32_t> buckets(count, ProjectedGrid::kMortonCodes / kCodesPerBucket,
                                       [&](std::size_t begin, std::size_t end, auto emit) {
                                         for (std::size_t i = begin; i < end; ++i)
                                           emit(codes[i] / kCodesPerBucket, static_cast<std::uint32_t>(i));
                                       });
  const std::span<const std::uint32_t> in_order = buckets.all();
  result_.triangles_.assign(in_order.begin(), in_order.end());
  result_.filters_ = std::make_unique_for_overwrite<ProjectedGrid::Filter[]>(count);
  footprints_ = std::make_unique_for_overwrite<Footprint[]>(count);
  parallel_for_each(count, kTrianglesOfATask, [&](std::size_t i) {
    const Triangle& t = mesh_.triangles[in_order[i]];
    result_.filters_[i] = result_.filter_of(mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]]);
    footprints_[i] = footprint(t);
  });
}

// The slopes from the differences of the mesh's own coordinates, which short edges need.
std::array<ProjectedGridBuilder::EdgeLine, 3> ProjectedGridBuilder::edges(std::uint32_t triangle) const {
  const Triangle& t = mesh_.triangles[result_.triangles_[triangle]];
  std::array<EdgeLine, 3> edges;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 &from = mesh_.vertices[t[i]], &to = mesh_.vertices[t[i < 2 ? i + 1 : 0]];
    const Local a = result_.local(from), b = result_.local(to);
    const double dy = to.y - from.y, dz = to.z - from.z;
    const bool has_line = std::isfinite(dy) && std::isfinite(dz) && (dy != 0.0 || dz != 0.0);
    edges[i] = {spanned(a.y, b.y), spanned(a.z, b.z), a.y, a.z, has_line ? dy / dz : 0.0, has_line};
  }
  return edges;
}

// --- The size of cells ----------------------------------------------------------------------------------------------

ProjectedGridBuilder::Sizes& ProjectedGridBuilder::Sizes::operator+=(const Sizes& other) {
  triangles += other.triangles;
  widths += other.widths;
  heights += other.heights;
  areas += other.areas;
  return *this;
}

void ProjectedGridBuilder::Sizes::add(const Footprint& footprint, const Rectangle& within) {
  const Interval y = intersection(footprint.box.y, within.y), z = intersection(footprint.box.z, within.z);
  const double width = std::max(y.upper - y.lower, 0.0), height = std::max(z.upper - z.lower, 0.0);
  *this += {1.0, width, height, std::min(width * height, footprint.area)};
}

// Added up in an order that does not depend on threads.
ProjectedGridBuilder::Sizes ProjectedGridBuilder::all_sizes(const Rectangle& box) const {
  std::vector<Sizes> sizes((mesh_.triangles.size() + kTrianglesOfATask - 1) / kTrianglesOfATask);
  parallel_for_each(sizes.size(), [&](std::size_t n) {
    const std::size_t last = std::min((n + 1) * kTrianglesOfATask, mesh_.triangles.size());
    for (std::size_t i = n * kTrianglesOfATask; i < last; ++i) sizes[n].add(footprints_[i], box);
  });
  Sizes all;
  for (const Sizes& some : sizes) all += some;
  return all;
}

// Cells have the proportions of the triangles, w h of mean width and height, and are t times as large. A triangle of
// area A belongs to about 1 + 2 / t + A / (t^2 w h) of them: for a wanted mean, t is the root of a quadratic. There are
// not many more than two cells per entry.
ProjectedGridBuilder::Grid ProjectedGridBuilder::choose(const Rectangle& box, const Sizes& sizes,
                                                        double entries_per_triangle) {
  const double n = sizes.triangles;
  const double width = box.y.upper - box.y.lower, height = box.z.upper - box.z.lower;
  const double mean_width = std::max(sizes.widths / n, kSmallestCell);
  const double mean_height = std::max(sizes.heights / n, kSmallestCell);
  const double more = entries_per_triangle - 1.0;
  double t = (1.0 + std::sqrt(1.0 + more * sizes.areas / (n * mean_width * mean_height))) / more;
  // Along each axis, too: where triangles are as high as the box, columns alone are all cells. 32 bits count them.
  const double cells = 2.0 * std::min(n, 0x1p28), across = width / mean_width, along = height / mean_height;
  t = std::max({t, std::sqrt((across + 1.0) * (along + 1.0) / cells), across / cells, along / cells});
  Grid grid{box.y.lower, box.z.lower, 1.0 / (t * mean_width), 1.0 / (t * mean_height), 1, 1, 0};
  grid.columns = static_cast<std::uint32_t>(std::max(std::ceil(width * grid.columns_per_unit), 1.0));
  grid.rows = static_cast<std::uint32_t>(std::max(std::ceil(height * grid.rows_per_unit), 1.0));
  return grid;
}

// --- The cells of a triangle ----------------------------------------------------------------------------------------

// Which cells of a grid are met.
class ProjectedGridBuilder::CellFinder {
 public:
  explicit CellFinder(const Grid& grid)
      : grid_(grid),
        height_(1.0 / grid.rows_per_unit),
        margin_y_(kMargin / grid.columns_per_unit),
        margin_z_(kMargin / grid.rows_per_unit) {}

  // By a box.
  [[nodiscard]] Cells of_box(const Rectangle& box) const {
    return {grid_.column(box.y.lower - margin_y_), grid_.column(box.y.upper + margin_y_),
            grid_.row(box.z.lower - margin_z_), grid_.row(box.z.upper + margin_z_)};
  }

  // By a triangle, and by the lines of its edges within its box: there D may be 0. Calls visit(column) for those of
  // `row` from first_column to last_column.
  template <class Visit>
  void visit_row(const Rectangle& box, const std::array<EdgeLine, 3>& edges, std::uint32_t row,
                 std::uint32_t first_column, std::uint32_t last_column, const Visit& visit) const {
    const Interval slab{grid_.lower_z + row * height_ - margin_z_, grid_.lower_z + (row + 1) * height_ + margin_z_};
    const Interval in_box = intersection(slab, widened(box.z, margin_z_));
    if (in_box.empty()) return;
    std::array<Interval, 4> parts;
    parts[3] = kEmptyInterval;  // the triangle itself
    for (std::size_t i = 0; i < 3; ++i) {
      const EdgeLine& edge = edges[i];
      parts[i] = intersection(widened(edge.along(in_box), margin_y_), widened(box.y, margin_y_));
      if (intersection(slab, edge.z).empty()) continue;
      parts[3] = hull(parts[3], intersection(parts[i], widened(edge.y, margin_y_)));
    }
    const std::array<std::uint64_t, 4> ranges =
        sorted({columns(parts[0]), columns(parts[1]), columns(parts[2]), columns(parts[3])});
    std::uint32_t next = first_column;
    for (const std::uint64_t range : ranges) {
      const std::uint32_t last = std::min(static_cast<std::uint32_t>(range), last_column);
      for (next = std::max(next, static_cast<std::uint32_t>(range >> 32)); next <= last; ++next) visit(next);
    }
  }

 private:
  // The first one in the upper half, the last one in the lower half; none where the first one is behind it.
  [[nodiscard]] std::uint64_t columns(const Interval& part) const {
    constexpr std::uint64_t kNone = std::uint64_t{0xFFFFFFFF} << 32;
    return part.empty() ? kNone : std::uint64_t{grid_.column(part.lower)} << 32 | grid_.column(part.upper);
  }
  static std::array<std::uint64_t, 4> sorted(std::array<std::uint64_t, 4> n) {
    for (const auto& [i, j] : {std::pair<std::size_t, std::size_t>{0, 1}, {2, 3}, {0, 2}, {1, 3}, {1, 2}}) {
      const std::uint64_t lower = std::min(n[i], n[j]), upper = std::max(n[i], n[j]);
      n[i] = lower, n[j] = upper;
    }
    return n;
  }

  Grid grid_;
  double height_, margin_y_, margin_z_;
};

template <class Visit>
void ProjectedGridBuilder::visit_cells(const CellFinder& finder, const Cells& cells, std::uint32_t triangle,
                                       const Visit& visit) const {
  const Rectangle& box = footprints_[triangle].box;
  const Cells of_box = finder.of_box(box);
  const std::uint32_t first_row = std::max(of_box.first_row, cells.first_row);
  const std::uint32_t last_row = std::min(of_box.last_row, cells.last_row);
  const std::uint32_t first = std::max(of_box.first_column, cells.first_column);
  const std::uint32_t last = std::min(of_box.last_column, cells.last_column);
  constexpr std::uint64_t kFew = 16;  // not worth the lines
  if (of_box.size() <= kFew) {
    for (std::uint32_t row = first_row; row <= last_row; ++row) {
      for (std::uint32_t column = first; column <= last; ++column) visit(column, row);
    }
    return;
  }
  const std::array<EdgeLine, 3> its_edges = edges(triangle);
  for (std::uint32_t row = first_row; row <= last_row; ++row) {
    finder.visit_row(box, its_edges, row, first, last, [&](std::uint32_t column) { visit(column, row); });
  }
}

ProjectedGridBuilder::Lists ProjectedGridBuilder::lists_of(const Grid& grid, const Cells& cells,
                                                           std::span<const Entry> entries) const {
  struct Membership {
    std::uint32_t cell, entry;
  };
  std::vector<Membership> members;
  members.reserve(8 * entries.size());
  Lists lists{std::vector<std::uint64_t>(cells.size() + 2, 0), {}};
  const CellFinder finder(grid);
  for (std::uint32_t i = 0; i < entries.size(); ++i) {
    visit_cells(finder, cells, entries[i].triangle, [&](std::uint32_t column, std::uint32_t row) {
      const std::uint64_t cell = (row - cells.first_row) * cells.columns() + (column - cells.first_column);
      members.push_back({static_cast<std::uint32_t>(cell), i});
      ++lists.begin[cell + 2];
    });
  }
  for (std::size_t i = 2; i < lists.begin.size(); ++i) lists.begin[i] += lists.begin[i - 1];
  lists.entries.resize(members.size());
  // begin[cell + 1] is the cell's next free place, and its end when all are filled.
  for (const Membership& member : members) lists.entries[lists.begin[member.cell + 1]++] = entries[member.entry];
  return lists;
}

// --- The grids ------------------------------------------------------------------------------------------------------

namespace {

struct FallingUpperX {
  template <class Entry>
  bool operator()(const Entry& a, const Entry& b) const {
    return a.upper_x > b.upper_x;
  }
};

}  // namespace

// A crowded cell becomes a grid where that spreads its entries.
ProjectedGridBuilder::Cell ProjectedGridBuilder::finished(const Rectangle& box, std::span<const Entry> entries,
                                                          int depth, Part& part) const {
  constexpr std::size_t kCrowded = 32;
  constexpr double kEntriesPerTriangle = 2.0;
  if (entries.empty()) return {0, 0, -std::numeric_limits<float>::infinity()};
  if (entries.size() > kCrowded && depth < kMaxDepth) {
    Sizes sizes;
    for (const Entry& entry : entries) sizes.add(footprints_[entry.triangle], box);
    const Grid grid = choose(box, sizes, kEntriesPerTriangle);
    if (std::size_t{grid.columns} * grid.rows >= 4) {
      const Cell cell{part.grids.size(), Cell::kHoldsGrid, entries.front().upper_x};
      add_grid(grid, entries, depth + 1, part);
      return cell;
    }
  }
  const Cell cell{part.entries.size(), static_cast<std::uint32_t>(entries.size()), entries.front().upper_x};
  part.entries.insert(part.entries.end(), entries.begin(), entries.end());
  return cell;
}

void ProjectedGridBuilder::add_grid(const Grid& grid, std::span<const Entry> entries, int depth, Part& part) const {
  const Cells all{0, grid.columns - 1, 0, grid.rows - 1};
  const Lists lists = lists_of(grid, all, entries);
  const std::size_t first = part.cells.size();
  part.grids.push_back(grid);
  part.grids.back().first_cell = first;
  part.cells.resize(first + all.size());
  const double width = 1.0 / grid.columns_per_unit, height = 1.0 / grid.rows_per_unit;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::size_t column = i % grid.columns, row = i / grid.columns;
    const double y = grid.lower_y + static_cast<double>(column) * width;
    const double z = grid.lower_z + static_cast<double>(row) * height;
    const Cell cell = finished({{y, y + width}, {z, z + height}}, lists[i], depth, part);
    part.cells[first + i] = cell;
  }
}

// Of the first grid. Its cells count from the part's first entry or grid until join().
ProjectedGridBuilder::Part ProjectedGridBuilder::fill(const Cells& block, std::span<const std::uint32_t> triangles) {
  const Grid& grid = result_.grids_.front();
  std::vector<Entry> entries;
  entries.reserve(triangles.size());
  for (const std::uint32_t triangle : triangles) entries.push_back({footprints_[triangle].upper_x, triangle});
  std::ranges::sort(entries, FallingUpperX());
  const Lists lists = lists_of(grid, block, entries);
  Part part;
  part.entries.reserve(lists.entries.size());
  const double width = 1.0 / grid.columns_per_unit, height = 1.0 / grid.rows_per_unit;
  std::size_t i = 0;
  for (std::uint32_t row = block.first_row; row <= block.last_row; ++row) {
    for (std::uint32_t column = block.first_column; column <= block.last_column; ++column, ++i) {
      const double y = grid.lower_y + column * width, z = grid.lower_z + row * height;
      result_.cells_[std::uint64_t{row} * grid.columns + column] =
          finished({{y, y + width}, {z, z + height}}, lists[i], 0, part);
    }
  }
  return part;
}

// Blocks of the first grid are filled each for itself.
void ProjectedGridBuilder::fill_blocks() {
  const Grid& grid = result_.grids_.front();
  constexpr std::uint32_t kCells = 512, kSide = 32;
  const std::uint32_t width = std::min(grid.columns, std::max(kSide, kCells / grid.rows));
  const std::uint32_t height = std::min(grid.rows, std::max(kSide / 2, kCells / grid.columns));
  const std::uint32_t across = (grid.columns + width - 1) / width, along = (grid.rows + height - 1) / height;
  std::vector<Cells> blocks;
  for (std::uint32_t row = 0; row < grid.rows; row += height) {
    for (std::uint32_t column = 0; column < grid.columns; column += width) {
      blocks.push_back(
          {column, std::min(column + width, grid.columns) - 1, row, std::min(row + height, grid.rows) - 1});
    }
  }
  const CellFinder finder(grid);
  const Buckets<std::uint32_t> triangles(
      mesh_.triangles.size(), std::size_t{across} * along, [&](std::size_t begin, std::size_t end, auto emit) {
        for (std::size_t i = begin; i < end; ++i) {
          const auto triangle = static_cast<std::uint32_t>(i);
          const Cells cells = finder.of_box(footprints_[i].box);
          for (std::uint32_t n = cells.first_row / height; n <= cells.last_row / height; ++n) {
            for (std::uint32_t m = cells.first_column / width; m <= cells.last_column / width; ++m) {
              emit(std::size_t{n} * across + m, triangle);
            }
          }
        }
      });
  result_.cells_.resize(std::size_t{grid.columns} * grid.rows);
  std::vector<Part> parts(blocks.size());
  parallel_for_each(blocks.size(), [&](std::size_t n) { parts[n] = fill(blocks[n], triangles[n]); });
  join(blocks, parts);
}

void ProjectedGridBuilder::join(const std::vector<Cells>& blocks, const std::vector<Part>& parts) {
  struct Offset {
    std::size_t grids, cells, entries;
  };
  std::vector<Offset> offsets;
  const Grid root = result_.grids_.front();
  Offset next{1, result_.cells_.size(), 0};
  for (const Part& part : parts) {
    offsets.push_back(next);
    next = {next.grids + part.grids.size(), next.cells + part.cells.size(), next.entries + part.entries.size()};
  }
  result_.grids_.resize(next.grids);
  result_.cells_.resize(next.cells);
  result_.entries_ = std::make_unique_for_overwrite<Entry[]>(next.entries);
  parallel_for_each(parts.size(), [&](std::size_t n) {
    const Offset& at = offsets[n];
    const auto moved = [&](Cell cell) {
      cell.first += cell.holds_grid() ? at.grids : at.entries;
      return cell;
    };
    std::ranges::copy(parts[n].entries, result_.entries_.get() + at.entries);
    std::ranges::transform(parts[n].cells, result_.cells_.data() + at.cells, moved);
    std::ranges::transform(parts[n].grids, result_.grids_.data() + at.grids, [&](Grid grid) {
      grid.first_cell += at.cells;
      return grid;
    });
    for (std::uint32_t row = blocks[n].first_row; row <= blocks[n].last_row; ++row) {
      Cell* const of_row = &result_.cells_[std::uint64_t{row} * root.columns];
      for (std::uint32_t i = blocks[n].first_column; i <= blocks[n].last_column; ++i) of_row[i] = moved(of_row[i]);
    }
  });
}

void ProjectedGridBuilder::build() {
  constexpr double kEntriesPerTriangle = 8.0;
  set_triangles();
  const Rectangle box{{result_.lower_.y, result_.upper_.y}, {result_.lower_.z, result_.upper_.z}};
  result_.grids_.push_back(choose(box, all_sizes(box), kEntriesPerTriangle));
  fill_blocks();
}

}  // namespace raycone
