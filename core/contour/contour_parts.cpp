#include "core/contour/contour_parts.h"

#include <algorithm>
#include <stdexcept>

#include "core/contour/cell_polygons.h"
#include "core/machine/first_touch.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// Cuts the polygons of a part into triangles, without the points that are spare.
class FanCutter {
 public:
  FanCutter(std::span<const EdgePoint> edge_points, std::span<const Vec3> face_points,
            const std::vector<std::uint8_t>& spare_edges)
      : edge_points_(edge_points), face_points_(face_points), spare_edges_(spare_edges) {}

  void cut(ContourPart& part) {
    std::size_t first = 0;
    for (const ContourPart::Polygon& polygon : part.polygons) {
      corners_.clear();
      positions_.clear();
      for (std::size_t n = first; n < first + polygon.size; ++n) {
        const std::uint32_t corner = part.polygon_corners[n];
        if (corner < edge_points_.size() && spare_edges_[corner] != 0) continue;
        corners_.push_back(corner);
        positions_.push_back(position(part, corner));
      }
      first += polygon.size;
      const std::size_t from = corners_.size() == 3 ? 0 : best_fan(positions_), size = corners_.size();
      const auto corner = [&](std::size_t at) { return corners_[at < size ? at : at - size]; };
      for (std::size_t n = 1; n + 1 < size; ++n) {
        part.triangles.push_back({corners_[from], corner(from + n), corner(from + n + 1)});
        part.sources.push_back(polygon.source);
      }
    }
    part.polygons = {};
    part.polygon_corners = {};
  }

 private:
  [[nodiscard]] const Vec3& position(const ContourPart& part, std::uint32_t corner) const {
    if (corner >= kFirstApex) return part.apexes[corner - kFirstApex];
    if (corner >= edge_points_.size()) return face_points_[corner - edge_points_.size()];
    return edge_points_[corner].position;
  }

  std::span<const EdgePoint> edge_points_;
  std::span<const Vec3> face_points_;
  const std::vector<std::uint8_t>& spare_edges_;
  std::vector<std::uint32_t> corners_;
  std::vector<Vec3> positions_;
};

// Where what a part has goes in the whole.
struct PartPlace {
  std::size_t triangles = 0, apexes = 0;
};

// The places of points among those that are left.
struct PointNumbers {
  std::vector<std::uint32_t> of;  // of edge points, then face points; empty where each is left
  std::size_t left = 0;

  PointNumbers(std::size_t edges, std::size_t faces, const SparePoints* spare) : left(edges + faces) {
    if (!spare) return;
    of = sized_on_all_threads<std::uint32_t>(left);
    std::uint32_t next = 0;
    for (std::size_t n = 0; n < edges; ++n) {
      of[n] = next;
      next += spare->edges[n] == 0 ? 1 : 0;
    }
    for (std::size_t n = 0; n < faces; ++n) {
      of[edges + n] = next;
      next += spare->faces[n] == 0 ? 1 : 0;
    }
    left = next;
  }

  [[nodiscard]] std::size_t operator()(std::size_t point) const { return of.empty() ? point : of[point]; }
};

void join_triangles(ContourPart& part, const PartPlace& place, const PointNumbers& numbers,
                    std::vector<Triangle>& all) {
  for (std::size_t i = 0; i < part.triangles.size(); ++i) {
    Triangle triangle = part.triangles[i];
    for (std::uint32_t& corner : triangle) {
      const std::size_t vertex =
          corner >= kFirstApex ? corner - kFirstApex + numbers.left + place.apexes : numbers(corner);
      corner = static_cast<std::uint32_t>(vertex);
    }
    all[place.triangles + i] = triangle;
  }
  part.triangles = {};
}

void join_points(std::span<const EdgePoint> edge_points, std::span<const Vec3> face_points, const PointNumbers& numbers,
                 const SparePoints* spare, std::vector<Vec3>& vertices) {
  parallel_for_each(edge_points.size(), 4096, [&](std::size_t n) {
    if (!spare || spare->edges[n] == 0) vertices[numbers(n)] = edge_points[n].position;
  });
  for (std::size_t n = 0; n < face_points.size(); ++n) {
    if (!spare || spare->faces[n] == 0) vertices[numbers(edge_points.size() + n)] = face_points[n];
  }
}

// Room for what Sharpener adds, as a rule: else all would be moved. Memory that nobody touches costs nothing.
std::size_t with_spares(std::size_t count) { return count + count / 8; }

template <class Item>
void join_items(std::vector<Item>& part, std::size_t place, std::vector<Item>& all) {
  std::ranges::copy(part, all.begin() + static_cast<std::ptrdiff_t>(place));
  part = {};
}

}  // namespace

std::uint64_t cut_polygons(std::vector<ContourPart>& parts, std::span<const EdgePoint> edge_points,
                           std::span<const Vec3> face_points, const SparePoints& spare) {
  std::uint64_t full = 0, cut = 0;
  for (const ContourPart& part : parts) {
    full += part.full_triangles;
    cut -= part.triangles.size();
  }
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    FanCutter cutter(edge_points, face_points, spare.edges);
    for (std::size_t part = begin; part < end; ++part) cutter.cut(parts[part]);
  });
  for (const ContourPart& part : parts) cut += part.triangles.size();
  return full - std::min(full, cut);
}

void check_point_numbers(std::size_t points) {
  if (points > kFirstApex) throw std::length_error("raycone: a surface of more than 2147483648 vertices");
}

// One kind of items after the other: the memory of parts is given back before the next one needs some.
ContouredSurface joined(std::vector<ContourPart>& parts, std::span<const EdgePoint> edge_points,
                        std::span<const Vec3> face_points, const SparePoints* spare) {
  std::vector<PartPlace> places;
  PartPlace end;
  for (const ContourPart& part : parts) {
    places.push_back(end);
    end.triangles += part.triangles.size();
    end.apexes += part.apexes.size();
  }
  check_point_numbers(edge_points.size() + face_points.size() + end.apexes);
  if (end.triangles > kMaxTriangles) throw std::length_error("raycone: a surface of more than 2147483647 faces");
  const PointNumbers numbers(edge_points.size(), face_points.size(), spare);

  ContouredSurface contoured;
  contoured.first_apex = numbers.left;
  TriangleMesh& mesh = contoured.surface.mesh;
  std::vector<std::int32_t>& sources = contoured.surface.sources;
  const auto for_each_part = [&](const auto& join) {
    parallel_for_each(parts.size(), [&](std::size_t n) { join(parts[n], places[n]); });
  };
  mesh.triangles.reserve(with_spares(end.triangles));
  resize_on_all_threads(mesh.triangles, end.triangles);
  for_each_part(
      [&](ContourPart& part, const PartPlace& place) { join_triangles(part, place, numbers, mesh.triangles); });
  sources.reserve(with_spares(end.triangles));
  resize_on_all_threads(sources, end.triangles);
  for_each_part([&](ContourPart& part, const PartPlace& place) { join_items(part.sources, place.triangles, sources); });
  mesh.vertices.reserve(with_spares(numbers.left + end.apexes));
  resize_on_all_threads(mesh.vertices, numbers.left + end.apexes);
  join_points(edge_points, face_points, numbers, spare, mesh.vertices);
  contoured.tetrahedra.resize(end.apexes);
  for_each_part([&](ContourPart& part, const PartPlace& place) {
    join_items(part.apexes, numbers.left + place.apexes, mesh.vertices);
    join_items(part.tetrahedra, place.apexes, contoured.tetrahedra);
  });
  return contoured;
}

}  // namespace raycone
