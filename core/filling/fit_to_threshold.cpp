#include "core/filling/fit_to_threshold.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>

#include "core/cells/line_roots.h"
#include "core/certificate/certificate.h"
#include "core/data/coordinate_precision.h"
#include "core/distance/distance.h"
#include "core/filling/fill_faces.h"
#include "core/mesh/exterior_edges.h"
#include "core/surface/surface.h"

namespace raycone {
namespace {

using Part = FillFaces::Part;

// All in voxels. Faces with a side longer than kShort are divided where they are farther than kFlat from the threshold,
// others where they are farther than kFlatIfShort. Faces thinner than kFlatIfShort, as those of cracks are, and faces
// with no side longer than kFinest are not divided.
constexpr double kShort = 1.0, kFlat = 0x1p-6, kFlatIfShort = 0.125, kFinest = 0.25;
// How far behind a face of the mesh a vertex is put that would be on it: faces that are in one plane but for roundings
// could not be taken apart. Much less than kFlat, so that it is no reason to divide a face.
constexpr double kBehind = 0x1p-10;
// How far behind a node a vertex is put where there is no threshold.
constexpr double kBeyond = 0.5;
// A node no farther than kOff from the fill is on it. Where a node is on the wrong side, but farther than kFarthest
// from the fill, the fill is not the reason: the node gets an octahedron, which reaches kIsland of the way to the
// threshold.
constexpr double kOff = 0x1p-20, kFarthest = 2.0, kIsland = 0.875;
// The barycentric coordinate of a corner below which a point is next to the side across from it.
constexpr double kNextToSide = 0.05;

// The barycentric coordinates of the point of a triangle that is nearest to p, but for rounding.
Vec3 barycentric_of_nearest(const Corners3& corners, const Vec3& p) {
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
  ThresholdFit(SurfaceMesh& surface, const RuleAlong& along, const NodeSet& inside, const FitOptions& options)
      : fill_(surface),
        along_(along),
        inside_(inside),
        voxel_(inside.lattice().least_spacing()),
        options_(options),
        is_settled_(fill_.size(), false) {
    options_.most_faces = std::min(options.most_faces, most_of_area());
  }

  bool fit() {
    constexpr int kMostRounds = 8, kRoundsOfDivision = 5;  // a face that is folded may never have a node on its side
    bool fits = false;
    for (int round = 0; round < kMostRounds && !fits && options_.most_faces > 0; ++round) {
      if (!divide_bent()) break;
      const NodeSet misplaced = misplaced_nodes(fill_.mesh(), inside_, &kNoEdges);
      fits = misplaced.empty();
      if (fits || misplaced.size() > options_.most_faces) break;
      if (round < kRoundsOfDivision ? !divide_at(misplaced) : !add_islands(positions_of(misplaced))) break;
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
    if (!(area <= kLargest * static_cast<double>(options_.most_faces))) return 0;
    return kAtLeast + kPerFace * fill_.size() + static_cast<std::size_t>(kPerSquareVoxel * area);
  }

  // Until all faces are along the threshold, or nothing more can be done about them. Returns whether there are not too
  // many.
  bool divide_bent() {
    constexpr int kMostRounds = 64;  // ten to twenty mostly do, as sides are halved; bites out of spheres take over 32
    for (int round = 0; round < kMostRounds; ++round) {
      unsettle(fill_.flip_edges());
      const std::vector<Part> bent = without_neighbours(bent_parts());
      if (bent.empty()) return true;
      std::vector<Line> lines;
      for (const Part& part : bent) lines.push_back(across(part));
      divide(bent, nearest_roots(lines, kFlat * voxel_, kBehind * voxel_, along_));
      if (fill_.size() > options_.most_faces) return false;
    }
    return false;
  }

  void unsettle(std::span<const std::uint32_t> faces) {
    for (const std::uint32_t face : faces) is_settled_[face] = false;
  }

  // Those without a place stay as they are from now on.
  void divide(std::span<const Part> parts, std::span<const std::optional<Vec3>> places) {
    for (std::size_t n = 0; n < parts.size(); ++n) {
      const auto [one, other] = fill_.faces_of(parts[n]);
      if (places[n]) {
        fill_.divide(parts[n], rounded_to(options_.precision, *places[n]));
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
    std::vector<std::uint32_t> longest(fill_.size(), FillFaces::kNone);
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
    if (part.edge == FillFaces::kNone) {
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
    const std::vector<double> values = along_.roughly_near(points);
    const auto passes = [&](std::size_t n) { return (values[n] >= 0.0) != (values[n + 1] >= 0.0); };
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
      return part.edge == FillFaces::kNone ? 0.0 : fill_.length(fill_.inner_edges()[part.edge]);
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

  struct Misplaced {
    Vec3 point;
    bool is_inside;
  };

  // A part that is near to a node, and the way from there to the node.
  struct NearPart {
    Part part;
    Vec3 away;
  };

  // Gives the parts that are nearest to these nodes a vertex beyond them: on the threshold or, where all beyond is on
  // the node's side, as it is where a tooth of the mesh has nothing inside, a bit farther. Nodes in a plane hole are on
  // the threshold: so little beyond them that it makes no difference otherwise. Nodes that no face is near to get an
  // island. Returns whether anything has changed.
  bool divide_at(const NodeSet& nodes) {
    const std::vector<Misplaced> misplaced = positions_of(nodes);
    const std::vector<std::uint32_t> nearest = nearest_faces(misplaced);
    const std::vector<std::array<std::uint32_t, 3>> sides = inner_sides();
    const double lift = voxel_ * surface_margin(inside_.lattice(), options_.precision);
    std::vector<bool> is_taken(fill_.size(), false);
    std::vector<Part> parts;
    std::vector<Line> lines;
    std::vector<Vec3> farther;  // where there is no threshold
    std::vector<Misplaced> far_off;
    for (std::size_t n = 0; n < misplaced.size(); ++n) {
      const auto& [point, is_inside] = misplaced[n];
      const std::optional<NearPart> near = nearest.empty() ? std::nullopt : near_part(nearest[n], point, sides);
      if (!near) far_off.push_back(misplaced[n]);
      if (!near || !take(near->part, is_taken)) continue;
      parts.push_back(near->part);
      if (norm(near->away) > kOff * voxel_) {
        lines.push_back(line_through(point, near->away, kFarthest * voxel_));
        lines.back().has_back = false;
        farther.push_back(point + kBeyond * voxel_ * lines.back().direction);
      } else {
        lines.push_back({point, {}});
        farther.push_back(point + (is_inside ? lift : -lift) * across(near->part).direction);
      }
    }
    std::vector<std::optional<Vec3>> beyond = nearest_roots(lines, kFlat * voxel_, kBehind * voxel_, along_);
    for (std::size_t n = 0; n < lines.size(); ++n) beyond[n] = beyond[n].value_or(farther[n]);
    divide(parts, beyond);
    return add_islands(far_off) || !parts.empty();
  }

  // Of the face that is nearest to a point: its side, where the nearest place is next to it. None where it is far.
  [[nodiscard]] std::optional<NearPart> near_part(std::uint32_t face, const Vec3& point,
                                                  std::span<const std::array<std::uint32_t, 3>> sides) const {
    const auto [a, b, c] = fill_[face];
    const Vec3 weights = barycentric_of_nearest({fill_.at(a), fill_.at(b), fill_.at(c)}, point);
    const Vec3 away = point - (weights.x * fill_.at(a) + weights.y * fill_.at(b) + weights.z * fill_.at(c));
    if (!(norm(away) <= kFarthest * voxel_)) return std::nullopt;
    Part part{face};
    for (int corner = 0; corner < 3; ++corner) {
      if (weights[corner] < kNextToSide) part.edge = sides[face][static_cast<std::size_t>(corner)];
    }
    return NearPart{part, away};
  }

  // A sheet that hangs on the mesh separates nothing, so the caps of its rim take it away. But next to its back w may
  // be above the threshold, or below it within the solid. Where that reaches a node, it gets a small part of its own:
  // as far along each axis as the threshold, or a bit less. Returns whether there are any.
  bool add_islands(const std::vector<Misplaced>& nodes) {
    const double least = voxel_ * surface_margin(inside_.lattice(), options_.precision);
    std::vector<Line> lines;
    for (const Misplaced& node : nodes) {
      for (int axis = 0; axis < 3; ++axis) {
        for (const double way : {-1.0, 1.0}) {
          Vec3 direction;
          direction[axis] = way;
          lines.push_back({node.point, direction, voxel_, false});
        }
      }
    }
    const std::vector<std::optional<Vec3>> roots = nearest_roots(lines, kFlat * voxel_, kBehind * voxel_, along_);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      std::array<Vec3, 6> tips;
      for (std::size_t tip = 0; tip < tips.size(); ++tip) {
        const Line& line = lines[6 * n + tip];
        const std::optional<Vec3>& root = roots[6 * n + tip];
        const double reach = kIsland * (root ? norm(*root - line.point) : voxel_);
        tips[tip] = rounded_to(options_.precision, line.point + std::max(reach, least) * line.direction);
      }
      using Fronts = FillFaces::Fronts;
      fill_.add_octahedron(tips, nodes[n].is_inside ? Fronts::kOutward : Fronts::kInward);
    }
    fill_.update_edges();
    is_settled_.resize(fill_.size(), true);
    return !nodes.empty();
  }

  [[nodiscard]] std::vector<Misplaced> positions_of(const NodeSet& nodes) const {
    const Lattice& lattice = inside_.lattice();
    std::vector<Misplaced> positions;
    nodes.for_each([&](const NodeSet::Node& node) {
      std::array<std::int64_t, 3> index = node;
      for (std::size_t axis = 0; axis < 3; ++axis) index[axis] += lattice.index_min[axis];
      positions.push_back({lattice.position(index), inside_.holds(node[0], node[1], node[2])});
    });
    return positions;
  }

  // None where there are no faces.
  [[nodiscard]] std::vector<std::uint32_t> nearest_faces(const std::vector<Misplaced>& nodes) const {
    if (fill_.size() == 0) return {};
    std::vector<Vec3> points(nodes.size());
    std::ranges::transform(nodes, points.begin(), &Misplaced::point);
    TriangleMesh faces = fill_.mesh();
    faces.triangles.erase(faces.triangles.begin(), faces.triangles.end() - fill_.size());
    std::vector<std::uint32_t> nearest(points.size());
    DistanceEvaluator(faces).find_nearest(points, nearest);
    return nearest;
  }

  // Of each face the inner edges across from its corners, or FillFaces::kNone.
  [[nodiscard]] std::vector<std::array<std::uint32_t, 3>> inner_sides() const {
    std::vector<std::array<std::uint32_t, 3>> sides(fill_.size(),
                                                    {FillFaces::kNone, FillFaces::kNone, FillFaces::kNone});
    const std::vector<FillFaces::InnerEdge>& edges = fill_.inner_edges();
    for (std::uint32_t n = 0; n < edges.size(); ++n) {
      for (const std::uint32_t face : {edges[n].left, edges[n].right}) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
          const std::uint32_t vertex = fill_[face][corner];
          if (vertex != edges[n].from && vertex != edges[n].to) sides[face][corner] = n;
        }
      }
    }
    return sides;
  }

  FillFaces fill_;
  const RuleAlong& along_;
  const NodeSet& inside_;
  double voxel_;
  FitOptions options_;
  std::vector<bool> is_settled_;  // of each face, whether it is along the threshold, or not to be divided
};

}  // namespace

bool fit_to_threshold(SurfaceMesh& surface, const RuleAlong& along, const NodeSet& inside, const FitOptions& options) {
  return ThresholdFit(surface, along, inside, options).fit();
}

}  // namespace raycone
