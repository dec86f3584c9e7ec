#include "core/surface/sharpen.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>

#include "core/distance/distance.h"
#include "core/machine/threads.h"
#include "core/surface/edge_crossing.h"
#include "core/surface/edge_points.h"

namespace raycone {
namespace {

constexpr std::uint32_t kNoPlace = UINT32_MAX;

struct Plane {
  Vec3 point, normal;  // of length 1

  [[nodiscard]] double height(const Vec3& p) const { return dot(normal, p - point); }
};

// Faces around vertices of strips, as they are pulled together.
class Sharpener {
 public:
  Sharpener(const SurfaceMesh& surface, const TriangleMesh& input, const std::vector<bool>& kept,
            const SharpenLimits& limits)
      : input_(input), kept_(kept), limits_(limits), mesh_(surface.mesh), sources_(surface.sources) {
    find_strips();
    if (has_planes()) find_faces();
  }

  SharpenedSurface sharpen() {
    std::vector<std::uint32_t> into(mesh_.vertices.size());
    std::iota(into.begin(), into.end(), 0U);
    std::size_t pulls = 0;
    // What leads to a corner can be pulled there only after what is before it on the edge.
    constexpr int kPasses = 32;
    for (int pass = 0; pass < kPasses && !faces_.empty(); ++pass) {
      const std::size_t before = pulls;
      for (const auto& [square, p, q, u, v] : edges_of_strips())
        pulls += pull(last_of(into, u), last_of(into, v), into) ? 1 : 0;
      if (pulls == before) break;
    }
    for (std::uint32_t& vertex : into) vertex = last_of(into, vertex);
    return {left(), std::move(into), pulls};
  }

 private:
  using Place = std::array<double, 3>;
  using Edge = std::tuple<double, Place, Place, std::uint32_t, std::uint32_t>;  // square of the length, ends
  using Faces = std::vector<std::uint32_t>;
  // Where a face is: in the plane of its source, or over a hole; off that plane; or so much turned against it, too,
  // that strips are looked for there. Fine tessellations are off, and hardly turned.
  enum class Placed : std::uint8_t { kInPlane, kOff, kAcross };

  static std::uint32_t last_of(const std::vector<std::uint32_t>& into, std::uint32_t vertex) {
    while (into[vertex] != vertex) vertex = into[vertex];
    return vertex;
  }

  void find_strips();
  // Whether it is planes that the mesh is made of: nine of ten faces are in one. Of CAD parts that is so of 93 to 99
  // per cent, of scans of less than 70; there, what is pulled would hardly ever pass the check.
  [[nodiscard]] bool has_planes() const {
    return 10 * std::ranges::count(placed_, Placed::kInPlane) >= 9 * std::ssize(placed_);
  }
  [[nodiscard]] Placed placed(std::size_t face) const;
  void find_faces();
  [[nodiscard]] std::vector<Edge> edges_of_strips() const;
  bool pull(std::uint32_t u, std::uint32_t v, std::vector<std::uint32_t>& into);
  [[nodiscard]] bool is_link_sound(std::uint32_t u, std::uint32_t v) const;
  [[nodiscard]] std::optional<Vec3> place_for(std::uint32_t u, std::uint32_t v);
  [[nodiscard]] bool is_on_mesh(const Vec3& p);
  [[nodiscard]] bool keeps_fronts(std::uint32_t vertex, std::uint32_t other, const Vec3& place) const;
  [[nodiscard]] bool add_plane(std::uint32_t face, std::vector<Plane>& planes) const;
  [[nodiscard]] std::optional<Vec3> meeting_point(std::span<const Plane> planes, const Vec3& near) const;
  [[nodiscard]] SurfaceMesh left() const;

  [[nodiscard]] Plane plane_of(std::int32_t source) const {
    const Triangle& t = input_.triangles[static_cast<std::size_t>(source)];
    const Vec3 &a = input_.vertices[t[0]], &b = input_.vertices[t[1]], &c = input_.vertices[t[2]];
    return {a, unit_normal(a, b, c)};
  }
  [[nodiscard]] Faces& faces(std::uint32_t vertex) { return faces_[place_[vertex]]; }
  [[nodiscard]] const Faces& faces(std::uint32_t vertex) const { return faces_[place_[vertex]]; }
  [[nodiscard]] bool has(std::uint32_t face, std::uint32_t vertex) const {
    const Triangle& t = mesh_.triangles[face];
    return t[0] == vertex || t[1] == vertex || t[2] == vertex;
  }

  const TriangleMesh& input_;
  const std::vector<bool>& kept_;
  const SharpenLimits& limits_;
  std::optional<DistanceEvaluator> distances_;  // made when first needed
  TriangleMesh mesh_;
  std::vector<std::int32_t> sources_;
  std::vector<Placed> placed_;        // of each face
  std::vector<std::uint8_t> gone_;    // likewise
  std::vector<std::uint32_t> place_;  // of each vertex among faces_; kNoPlace where it is of no strip
  std::vector<Faces> faces_;
};

// Faces over holes are in no plane, and belong to no strip.
Sharpener::Placed Sharpener::placed(std::size_t face) const {
  constexpr double kTurned = 0.992546151641322;  // cosine of 7 degrees
  if (sources_[face] == kHole) return Placed::kInPlane;
  const Plane plane = plane_of(sources_[face]);
  const Triangle& t = mesh_.triangles[face];
  const Vec3 &a = mesh_.vertices[t[0]], &b = mesh_.vertices[t[1]], &c = mesh_.vertices[t[2]];
  const double farthest = std::max({std::abs(plane.height(a)), std::abs(plane.height(b)), std::abs(plane.height(c))});
  if (farthest <= limits_.off) return Placed::kInPlane;
  return std::abs(dot(plane.normal, unit_normal(a, b, c))) < kTurned ? Placed::kAcross : Placed::kOff;
}

void Sharpener::find_strips() {
  placed_.resize(mesh_.triangles.size());
  gone_.assign(mesh_.triangles.size(), 0);
  parallel_for(placed_.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t face = begin; face < end; ++face) placed_[face] = placed(face);
  });
}

void Sharpener::find_faces() {
  place_.assign(mesh_.vertices.size(), kNoPlace);
  for (std::size_t face = 0; face < placed_.size(); ++face) {
    if (placed_[face] != Placed::kAcross) continue;
    for (const std::uint32_t corner : mesh_.triangles[face]) {
      if (place_[corner] != kNoPlace) continue;
      place_[corner] = static_cast<std::uint32_t>(faces_.size());
      faces_.emplace_back();
    }
  }
  for (std::uint32_t face = 0; face < placed_.size(); ++face) {
    for (const std::uint32_t corner : mesh_.triangles[face]) {
      if (place_[corner] != kNoPlace) faces(corner).push_back(face);
    }
  }
}

// Shortest first: those that lead across. Of equal ones it is places that decide, not numbers of vertices, so that a
// larger lattice with the same nodes gives the same surface.
std::vector<Sharpener::Edge> Sharpener::edges_of_strips() const {
  const auto place = [&](std::uint32_t vertex) {
    const Vec3& p = mesh_.vertices[vertex];
    return Place{p.x, p.y, p.z};
  };
  std::vector<Edge> edges;
  for (std::size_t face = 0; face < placed_.size(); ++face) {
    if (placed_[face] != Placed::kAcross || gone_[face] != 0) continue;
    const Triangle& t = mesh_.triangles[face];
    for (std::size_t i = 0; i < 3; ++i) {
      std::uint32_t u = t[i], v = t[(i + 1) % 3];
      if (place(v) < place(u)) std::swap(u, v);
      const Vec3 step = mesh_.vertices[v] - mesh_.vertices[u];
      const double square = dot(step, step);
      if (square <= 4 * limits_.reach * limits_.reach) edges.emplace_back(square, place(u), place(v), u, v);
    }
  }
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

// Pulls v into u, and both to where their planes meet, if that can be done.
bool Sharpener::pull(std::uint32_t u, std::uint32_t v, std::vector<std::uint32_t>& into) {
  if (u == v || kept_[u] || kept_[v]) return false;
  const auto leads_to_v = [&](std::uint32_t face) { return placed_[face] != Placed::kInPlane && has(face, v); };
  if (!std::ranges::any_of(faces(u), leads_to_v)) return false;
  const std::optional<Vec3> place = place_for(u, v);
  if (!place || !is_link_sound(u, v) || !keeps_fronts(u, v, *place) || !keeps_fronts(v, u, *place)) return false;
  for (const std::uint32_t face : faces(v)) {
    if (has(face, u)) {
      gone_[face] = 1;
      for (const std::uint32_t corner : mesh_.triangles[face]) {
        if (corner != v && place_[corner] != kNoPlace) std::erase(faces(corner), face);
      }
      continue;
    }
    for (std::uint32_t& corner : mesh_.triangles[face]) corner = corner == v ? u : corner;
    faces(u).push_back(face);
  }
  faces(v).clear();
  mesh_.vertices[u] = *place;
  into[v] = u;
  return true;
}

// The condition under which a closed 2-manifold stays one: the edge has two faces, and its ends no common neighbours
// but their third corners (Dey, Edelsbrunner, Guha and Nekhayev 1999).
bool Sharpener::is_link_sound(std::uint32_t u, std::uint32_t v) const {
  const auto neighbours = [&](std::uint32_t vertex) {
    std::vector<std::uint32_t> all;
    for (const std::uint32_t face : faces(vertex)) {
      for (const std::uint32_t corner : mesh_.triangles[face]) {
        if (corner != vertex) all.push_back(corner);
      }
    }
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  };
  const std::vector<std::uint32_t> of_u = neighbours(u), of_v = neighbours(v);
  std::vector<std::uint32_t> common;
  std::ranges::set_intersection(of_u, of_v, std::back_inserter(common));
  const auto shared = std::ranges::count_if(faces(u), [&](std::uint32_t face) { return has(face, v); });
  const std::size_t left = of_u.size() + of_v.size() - 4;  // neighbours of what becomes one vertex
  return shared == 2 && common.size() == 2 && left >= 3;
}

// Where the planes around both meet, on the mesh.
std::optional<Vec3> Sharpener::place_for(std::uint32_t u, std::uint32_t v) {
  std::vector<Plane> planes;
  for (const std::uint32_t vertex : {u, v}) {
    for (const std::uint32_t face : faces(vertex)) {
      if (sources_[face] == kHole) return std::nullopt;
      if (placed_[face] == Placed::kInPlane && !add_plane(face, planes)) return std::nullopt;
    }
  }
  const Vec3 &p = mesh_.vertices[u], &q = mesh_.vertices[v];
  // A vertex that is on the edge already stays: it may be where the edge bends.
  for (const Vec3& end : {p, q}) {
    const auto is_in = [&](const Plane& plane) { return std::abs(plane.height(end)) <= limits_.off; };
    if (planes.size() >= 2 && std::ranges::all_of(planes, is_in)) return end;
  }
  std::optional<Vec3> place = meeting_point(planes, 0.5 * p + 0.5 * q);
  if (!place) return std::nullopt;
  if (limits_.single_precision) {
    for (int axis = 0; axis < 3; ++axis) {
      const volatile auto single = static_cast<float>((*place)[axis]);  // as vertices of the contour are rounded
      (*place)[axis] = static_cast<double>(single);
    }
  }
  for (const Vec3& from : {p, q}) {
    const Vec3 step = *place - from;
    if (!(dot(step, step) <= limits_.reach * limits_.reach)) return std::nullopt;
  }
  return is_on_mesh(*place) ? place : std::nullopt;
}

bool Sharpener::is_on_mesh(const Vec3& p) {
  if (!distances_) distances_.emplace(input_);
  double distance = 0.0;
  distances_->evaluate({&p, 1}, {&distance, 1});
  return distance <= limits_.off;
}

// Adds a face's plane unless it is there. Planes at less than 15 degrees, where an edge is not sharp, meet nowhere for
// sure: false.
bool Sharpener::add_plane(std::uint32_t face, std::vector<Plane>& planes) const {
  constexpr double kSame = 1 - 1e-10, kSharp = 0.9659258262890683;  // cosines
  const Plane plane = plane_of(sources_[face]);
  for (const Plane& other : planes) {
    const double cosine = std::abs(dot(plane.normal, other.normal));
    const bool same_place = std::abs(other.height(mesh_.vertices[mesh_.triangles[face][0]])) <= 2 * limits_.off;
    if (cosine >= kSame && same_place) return true;
    if (cosine > kSharp) return false;
  }
  planes.push_back(plane);
  return planes.size() <= 3;
}

// The point of two or three planes that is nearest to `near`.
std::optional<Vec3> Sharpener::meeting_point(std::span<const Plane> planes, const Vec3& near) const {
  constexpr double kLeast = 1e-2;  // determinant of normals: below, the planes hardly have a point in common
  if (planes.size() < 2) return std::nullopt;
  const Vec3 &a = planes[0].normal, &b = planes[1].normal;
  const double of_a = -planes[0].height(near), of_b = -planes[1].height(near);
  if (planes.size() == 2) {
    const double k = dot(a, b), rest = 1 - k * k;
    return near + ((of_a - k * of_b) / rest) * a + ((of_b - k * of_a) / rest) * b;
  }
  const Vec3& c = planes[2].normal;
  const double of_c = -planes[2].height(near), determinant = dot(a, cross(b, c));
  if (!(std::abs(determinant) >= kLeast)) return std::nullopt;
  return near + (of_a / determinant) * cross(b, c) + (of_b / determinant) * cross(c, a) +
         (of_c / determinant) * cross(a, b);
}

// Whether the faces of a vertex that are left have an area, and are not turned over, when it moves.
bool Sharpener::keeps_fronts(std::uint32_t vertex, std::uint32_t other, const Vec3& place) const {
  return std::ranges::all_of(faces(vertex), [&](std::uint32_t face) {
    if (has(face, other)) return true;
    std::array<Vec3, 3> before, after;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t corner = mesh_.triangles[face][i];
      before[i] = mesh_.vertices[corner];
      after[i] = corner == vertex ? place : before[i];
    }
    const Vec3 was = cross(before[1] - before[0], before[2] - before[0]);
    const Vec3 is = cross(after[1] - after[0], after[2] - after[0]);
    const bool may_turn = placed_[face] != Placed::kInPlane && limits_.strips_may_turn;
    return may_turn ? dot(is, is) > 0.0 : dot(was, is) > 0.0;
  });
}

SurfaceMesh Sharpener::left() const {
  SurfaceMesh result{{mesh_.vertices, {}}, {}};
  for (std::size_t face = 0; face < gone_.size(); ++face) {
    if (gone_[face] != 0) continue;
    result.mesh.triangles.push_back(mesh_.triangles[face]);
    result.sources.push_back(sources_[face]);
  }
  return result;
}

}  // namespace

SharpenedSurface sharpened(const SurfaceMesh& surface, const TriangleMesh& input, const std::vector<bool>& kept,
                           const SharpenLimits& limits) {
  return Sharpener(surface, input, kept, limits).sharpen();
}

}  // namespace raycone
