#include "core/surface/hole_fill.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "core/boundary/boundary.h"
#include "core/boundary/caps.h"
#include "core/data/single_precision.h"
#include "core/distance/distance.h"
#include "core/surface/certificate.h"
#include "core/surface/fill_faces.h"

namespace raycone {
namespace {

using Part = FillFaces::Part;
constexpr std::uint32_t kNone = FillFaces::kNone;

// All in voxels. Faces with a longer side than kShort are divided where they are farther than kFlat from the threshold,
// others where they are farther than kFlatIfShort; but none that are thinner than that, as the faces of cracks are, or
// whose sides are all shorter than kFinest.
constexpr double kShort = 1.0, kFlat = 0x1p-6, kFlatIfShort = 0.125, kFinest = 0.25;
// How far from the threshold faces may be in the end, and what part of their area must be so near. Between teeth of the
// mesh that have no inside, and in cracks, some are not.
constexpr double kNear = 0.25, kNearly = 0.9, kNotFar = 1.0, kNearlyAll = 0.99;
// How far behind a node a vertex is where there is no threshold.
constexpr double kBeyond = 0.5;
// A node this near is on the fill, which is looked at across its face then. If nodes are too far from the fill, it is
// not why they are on the wrong side.
constexpr double kOff = 0x1p-20, kFarthest = 2.0;

// Where to look for the threshold: places from a point along a direction.
struct Line {
  Vec3 point, direction;  // of length 1; or 0, where there is none
  double reach = 0.0;
  bool has_back = true;  // goes as far the other way, too
};

Line line_through(const Vec3& point, const Vec3& direction, double reach) {
  const double size = norm(direction);
  return {point, size > 0.0 ? (1.0 / size) * direction : Vec3{}, reach};
}

// Closer together where they are near to the point; increasing. None without a direction.
std::vector<double> places_on(const Line& line, double first) {
  if (line.direction == Vec3{}) return {};
  std::vector<double> places{0.0};
  for (double place = first; place < line.reach; place *= 2.0) places.push_back(place);
  places.push_back(line.reach);
  const std::size_t count = line.has_back ? places.size() : 0;
  for (std::size_t n = 1; n < count; ++n) places.push_back(-places[n]);
  std::ranges::sort(places);
  return places;
}

bool is_inside(double value) { return value >= 0.0; }

// Of the two places next to each other, nearest to 0, between which the side changes, the second one. 0 for none.
std::size_t nearest_change(std::span<const double> places, std::span<const double> values) {
  std::size_t best = 0;
  for (std::size_t n = 1; n < places.size(); ++n) {
    const auto off = [&](std::size_t end) { return std::abs(places[end - 1] + places[end]); };
    if (is_inside(values[n - 1]) != is_inside(values[n]) && (best == 0 || off(n) < off(best))) best = n;
  }
  return best;
}

std::array<Vec3, 3> corners_of(const TriangleMesh& mesh, const Triangle& t) {
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

// By how much of each corner the nearest point of a triangle is made up, but for rounding.
Vec3 nearest_place(const std::array<Vec3, 3>& corners, const Vec3& p) {
  const Vec3 u = corners[1] - corners[0], v = corners[2] - corners[0], w = p - corners[0];
  const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), wu = dot(w, u), wv = dot(w, v);
  const double determinant = uu * vv - uv * uv;
  const double second = (vv * wu - uv * wv) / determinant, third = (uu * wv - uv * wu) / determinant;
  if (second >= 0.0 && third >= 0.0 && second + third <= 1.0) return {1.0 - second - third, second, third};
  Vec3 best{1.0, 0.0, 0.0};
  double least = HUGE_VAL;
  for (int from = 0; from < 3; ++from) {  // along its sides
    const int to = (from + 1) % 3;
    const Vec3& start = corners[static_cast<std::size_t>(from)];
    const Vec3 along = corners[static_cast<std::size_t>(to)] - start;
    const double square = dot(along, along);
    const double part = square > 0.0 ? std::clamp(dot(p - start, along) / square, 0.0, 1.0) : 0.0;
    const double distance = norm(p - start - part * along);
    if (!(distance < least)) continue;
    least = distance;
    best = {};
    best[from] = 1.0 - part;
    best[to] = part;
  }
  return best;
}

class ThresholdFit {
 public:
  ThresholdFit(SurfaceMesh& surface, const RuleAlong& along, const NodeSet& inside, const FillLimits& limits)
      : fill_(surface),
        along_(along),
        inside_(inside),
        voxel_(inside.lattice().least_spacing()),
        limits_(limits),
        is_settled_(fill_.size(), false) {
    limits_.most_faces = std::min(limits.most_faces, most_of_area());
  }

  bool fit() {
    constexpr int kMostRounds = 8;
    bool fits = false;
    for (int round = 0; round < kMostRounds && !fits && limits_.most_faces > 0; ++round) {
      if (!divide_bent()) break;
      const NodeSet misplaced = misplaced_nodes(fill_.mesh(), inside_, &kNoEdges);
      fits = misplaced.empty();
      if (!fits && (misplaced.size() > limits_.most_faces || !divide_at(misplaced))) break;
    }
    fill_.put_back();
    return fits;
  }

 private:
  inline static const std::vector<ExteriorEdge> kNoEdges{};  // the surface is closed

  // How many faces there may be: some times as many as equilateral triangles with sides of a voxel would be. A fill
  // that needs more is folded. None where it is larger than most surfaces through so many cells: holes are everywhere
  // then.
  [[nodiscard]] std::size_t most_of_area() const {
    constexpr double kPerSquareVoxel = 8.0, kLargest = 0.125;  // times as many square voxels as there may be faces
    constexpr std::size_t kPerFace = 4, kAtLeast = 64;
    double area = 0.0;
    for (std::uint32_t face = 0; face < fill_.size(); ++face) area += norm(fill_.normal(face)) / (2 * voxel_ * voxel_);
    if (!(area <= kLargest * static_cast<double>(limits_.most_faces))) return 0;
    return kAtLeast + kPerFace * fill_.size() + static_cast<std::size_t>(kPerSquareVoxel * area);
  }

  // Until all faces are along the threshold, or nothing more can be done about them. Returns whether there are not too
  // many.
  bool divide_bent() {
    constexpr int kMostRounds = 64;  // some ten to twenty are enough, as sides are halved
    for (int round = 0; round < kMostRounds; ++round) {
      unsettle(fill_.flip_edges());
      const std::vector<Part> bent = without_neighbours(bent_parts());
      if (bent.empty()) return true;
      std::vector<Line> lines;
      for (const Part& part : bent) lines.push_back(across(part));
      divide(bent, nearest_roots(lines));
      if (fill_.size() > limits_.most_faces) return false;
    }
    return false;
  }

  [[nodiscard]] Vec3 rounded(const Vec3& p) const { return limits_.single_precision ? rounded_to_float(p) : p; }

  void unsettle(std::span<const std::uint32_t> faces) {
    for (const std::uint32_t face : faces) is_settled_[face] = false;
  }

  // Those without a place stay as they are from now on.
  void divide(std::span<const Part> parts, std::span<const std::optional<Vec3>> places) {
    for (std::size_t n = 0; n < parts.size(); ++n) {
      const auto [one, other] = fill_.faces_of(parts[n]);
      if (places[n]) {
        fill_.divide(parts[n], *places[n]);
        is_settled_[one] = is_settled_[other] = false;
      } else {
        is_settled_[parts[n].face] = true;
      }
    }
    is_settled_.resize(fill_.size(), false);
    fill_.update_edges();
  }

  // Across its longest side.
  [[nodiscard]] bool is_thinner(std::uint32_t face, double width) const {
    return norm(fill_.normal(face)) < width * voxel_ * fill_.longest_side(face);
  }

  // Of each face that is not settled its longest inner edge, or itself where none is long. Settles those that are
  // small.
  std::vector<Part> parts_to_ask() {
    std::vector<std::uint32_t> longest(fill_.size(), kNone);
    std::vector<double> lengths(fill_.size(), kFinest * voxel_);
    const std::vector<FillFaces::InnerEdge>& edges = fill_.inner_edges();
    for (std::uint32_t n = 0; n < edges.size(); ++n) {
      const double here = fill_.length(edges[n]);
      for (const std::uint32_t face : {edges[n].left, edges[n].right}) {
        if (here > lengths[face]) lengths[face] = here, longest[face] = n;
      }
    }
    std::vector<Part> parts;
    for (std::uint32_t face = 0; face < fill_.size(); ++face) {
      if (fill_.longest_side(face) <= kFinest * voxel_ || is_thinner(face, kFlatIfShort)) is_settled_[face] = true;
      if (!is_settled_[face]) parts.push_back({face, longest[face]});
    }
    return parts;
  }

  // Through the middle of a part, as far as a half of its side, or of the longest one.
  [[nodiscard]] Line across(const Part& part) const {
    if (part.edge == kNone) {
      return line_through(fill_.middle(part.face), fill_.normal(part.face), fill_.longest_side(part.face) / 2);
    }
    const FillFaces::InnerEdge& edge = fill_.inner_edges()[part.edge];
    return line_through(0.5 * (fill_.at(edge.from) + fill_.at(edge.to)),
                        fill_.normal(edge.left) + fill_.normal(edge.right), fill_.length(edge) / 2);
  }

  // Of faces that are not along the threshold, as their middle and that of their part tell. Settles the others.
  std::vector<Part> bent_parts() {
    const std::vector<Part> parts = parts_to_ask();
    std::vector<Vec3> points;
    for (const Part& part : parts) {
      const double flat = fill_.longest_side(part.face) > kShort * voxel_ ? kFlat : kFlatIfShort;
      for (const Line& line : {across({part.face}), across(part)}) {
        const Vec3 step = flat * voxel_ * line.direction;
        points.insert(points.end(), {line.point - step, line.point + step});
      }
    }
    const std::vector<double> values = along_.near(points);
    const auto passes = [&](std::size_t n) { return is_inside(values[n]) != is_inside(values[n + 1]); };
    std::vector<Part> bent;
    for (std::size_t n = 0; n < parts.size(); ++n) {
      if (passes(4 * n) && passes(4 * n + 2)) {
        is_settled_[parts[n].face] = true;
      } else {
        bent.push_back(parts[n]);
      }
    }
    return bent;
  }

  // No two of one face; those with the longest edges first.
  [[nodiscard]] std::vector<Part> without_neighbours(std::vector<Part> parts) const {
    const auto length = [&](const Part& part) {
      return part.edge == kNone ? 0.0 : fill_.length(fill_.inner_edges()[part.edge]);
    };
    std::ranges::sort(parts, {}, [&](const Part& p) { return std::tuple(-length(p), p.edge, p.face); });
    std::vector<bool> is_taken(fill_.size(), false);
    std::erase_if(parts, [&](const Part& part) { return !take(part, is_taken); });
    return parts;
  }

  // Whether none of the part's faces was taken; they are then.
  bool take(const Part& part, std::vector<bool>& is_taken) const {
    const auto [one, other] = fill_.faces_of(part);
    if (is_taken[one] || is_taken[other]) return false;
    is_taken[one] = is_taken[other] = true;
    return true;
  }

  // The place on each line that is nearest to its point, of those where the threshold is passed.
  [[nodiscard]] std::vector<std::optional<Vec3>> nearest_roots(const std::vector<Line>& lines) const {
    std::vector<std::vector<double>> places;
    std::vector<Vec3> points;
    for (const Line& line : lines) {
      places.push_back(places_on(line, kFlat * voxel_));
      for (const double place : places.back()) points.push_back(line.point + place * line.direction);
    }
    const std::vector<double> values = along_.near(points);
    std::vector<Bracket> brackets;
    std::vector<std::size_t> of_line;
    for (std::size_t n = 0, first = 0; n < lines.size(); first += places[n++].size()) {
      const std::size_t end = nearest_change(places[n], std::span(values).subspan(first, places[n].size()));
      if (end == 0) continue;
      std::size_t in = first + end, out = in - 1;
      if (!is_inside(values[in])) std::swap(in, out);
      brackets.push_back({{points[in], points[out], 0}, 0.0, 1.0});
      of_line.push_back(n);
    }
    find_roots(brackets, [&](const std::vector<Vec3>& there) { return along_.near(there); });
    std::vector<std::optional<Vec3>> roots(lines.size());
    for (std::size_t n = 0; n < brackets.size(); ++n) {
      roots[of_line[n]] = rounded(brackets[n].edge.point(brackets[n].root));
    }
    return roots;
  }

  // Gives the parts that are nearest to these nodes a vertex beyond them: on the threshold or, where all beyond is on
  // the node's side, as it is where a tooth of the mesh has nothing inside, a bit farther. Returns whether that does
  // for each.
  bool divide_at(const NodeSet& nodes) {
    const std::vector<Vec3> points = positions_of(nodes);
    const std::vector<std::uint32_t> nearest = nearest_faces(points);
    std::vector<bool> is_taken(fill_.size(), false);
    std::vector<Part> parts;
    std::vector<Line> lines;
    for (std::size_t n = 0; n < nearest.size(); ++n) {
      const auto [a, b, c] = fill_[nearest[n]];
      const Vec3 weights = nearest_place({fill_.at(a), fill_.at(b), fill_.at(c)}, points[n]);
      const Vec3 away = points[n] - (weights.x * fill_.at(a) + weights.y * fill_.at(b) + weights.z * fill_.at(c));
      if (!(norm(away) <= kFarthest * voxel_)) return false;
      const Part part{nearest[n], edge_at(nearest[n], weights)};
      if (!take(part, is_taken)) continue;
      const bool is_off = norm(away) > kOff * voxel_;
      parts.push_back(part);
      lines.push_back(line_through(points[n], is_off ? away : fill_.normal(nearest[n]), kFarthest * voxel_));
      lines.back().has_back = !is_off;
    }
    std::vector<std::optional<Vec3>> beyond = nearest_roots(lines);
    for (std::size_t n = 0; n < lines.size(); ++n) {
      if (!beyond[n] && !lines[n].has_back) beyond[n] = rounded(lines[n].point + kBeyond * voxel_ * lines[n].direction);
    }
    if (parts.empty() || !std::ranges::all_of(beyond, &std::optional<Vec3>::has_value)) return false;
    divide(parts, beyond);
    return true;
  }

  [[nodiscard]] std::vector<Vec3> positions_of(const NodeSet& nodes) const {
    const Lattice& lattice = inside_.lattice();
    std::vector<Vec3> points;
    nodes.for_each([&](NodeSet::Node node) {
      for (std::size_t axis = 0; axis < 3; ++axis) node[axis] += lattice.index_min[axis];
      points.push_back(lattice.position(node));
    });
    return points;
  }

  // None where there are no faces.
  [[nodiscard]] std::vector<std::uint32_t> nearest_faces(const std::vector<Vec3>& points) const {
    if (fill_.size() == 0) return {};
    TriangleMesh faces = fill_.mesh();
    faces.triangles.erase(faces.triangles.begin(), faces.triangles.end() - fill_.size());
    std::vector<std::uint32_t> nearest(points.size());
    DistanceEvaluator(faces).find_nearest(points, nearest);
    return nearest;
  }

  // The inner edge of a face that a place of it is next to; kNone where none is.
  [[nodiscard]] std::uint32_t edge_at(std::uint32_t face, const Vec3& weights) const {
    constexpr double kNext = 0.05;
    const std::vector<FillFaces::InnerEdge>& edges = fill_.inner_edges();
    for (std::uint32_t n = 0; n < edges.size(); ++n) {
      if (edges[n].left != face && edges[n].right != face) continue;
      for (int corner = 0; corner < 3; ++corner) {
        const std::uint32_t vertex = fill_[face][static_cast<std::size_t>(corner)];
        if (weights[corner] < kNext && vertex != edges[n].from && vertex != edges[n].to) return n;
      }
    }
    return kNone;
  }

  FillFaces fill_;
  const RuleAlong& along_;
  const NodeSet& inside_;
  double voxel_;
  FillLimits limits_;
  std::vector<bool> is_settled_;  // of each face, whether it is along the threshold, or not to be divided
};

}  // namespace

TriangleMesh closed_by_caps(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges) {
  const TriangleMesh caps = all_caps(Boundary(mesh, edges));
  std::vector<std::uint32_t> ends;
  for (const ExteriorEdge& edge : edges) ends.insert(ends.end(), {edge.from, edge.to});
  const auto is_before = [](const Vec3& a, const Vec3& b) { return lexicographic_order(a, b) < 0; };
  const auto position = [&](std::uint32_t vertex) { return mesh.vertices[vertex]; };
  std::ranges::sort(ends, is_before, position);
  const auto end_at = [&](const Vec3& p) { return *std::ranges::lower_bound(ends, p, is_before, position); };
  std::vector<std::uint32_t> number(caps.vertices.size());
  std::ranges::transform(caps.vertices, number.begin(), end_at);
  TriangleMesh closed = mesh;
  for (const auto& [a, b, c] : caps.triangles) closed.triangles.push_back({number[a], number[c], number[b]});
  return closed;
}

bool is_along_threshold(const SurfaceMesh& surface, const RuleAlong& along, double voxel) {
  constexpr std::size_t kPoints = 17;
  std::vector<Vec3> points;
  std::vector<double> areas;
  for (std::size_t face = 0; face < surface.sources.size(); ++face) {
    if (surface.sources[face] != kHole) continue;
    const auto [a, b, c] = corners_of(surface.mesh, surface.mesh.triangles[face]);
    const Vec3 normal = cross(b - a, c - a), middle = (1.0 / 3.0) * (a + b + c);
    if (norm(normal) < kFlat * voxel * std::max({norm(b - a), norm(c - b), norm(a - c)})) continue;
    areas.push_back(norm(normal));
    points.push_back(middle);
    for (const double reach : {kNear * voxel, kNotFar * voxel}) {
      for (const Vec3& way : {(1.0 / norm(normal)) * normal, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
        points.insert(points.end(), {middle - reach * way, middle + reach * way});
    }
  }
  const std::vector<double> values = along.near(points);
  double all = 0.0, near = 0.0, not_far = 0.0;
  for (std::size_t n = 0; n < areas.size(); ++n) {
    const auto passes = [&](std::size_t count) {
      const auto [least, most] = std::ranges::minmax(std::span(values).subspan(n * kPoints, count));
      return is_inside(least) != is_inside(most);
    };
    all += areas[n];
    near += passes(kPoints / 2 + 1) ? areas[n] : 0.0;
    not_far += passes(kPoints) ? areas[n] : 0.0;
  }
  return near >= kNearly * all && not_far >= kNearlyAll * all;
}

bool fit_to_threshold(SurfaceMesh& surface, const RuleAlong& along, const NodeSet& inside, const FillLimits& limits) {
  return ThresholdFit(surface, along, inside, limits).fit();
}

}  // namespace raycone
