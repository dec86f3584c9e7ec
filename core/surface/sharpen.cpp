#include "core/surface/sharpen.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

#include "core/machine/threads.h"
#include "core/surface/cell_creases.h"
#include "core/surface/edge_crossing.h"
#include "core/surface/edge_points.h"

namespace raycone {
namespace {

struct Plane {
  Vec3 point, normal;  // of length 1
  std::int32_t source;

  [[nodiscard]] double height(const Vec3& p) const { return dot(normal, p - point); }
};

Plane plane_of(const TriangleMesh& input, std::int32_t source) {
  const Triangle& t = input.triangles[static_cast<std::size_t>(source)];
  const Vec3 &a = input.vertices[t[0]], &b = input.vertices[t[1]], &c = input.vertices[t[2]];
  return {a, unit_normal(a, b, c), source};
}

bool has(const Triangle& t, std::uint32_t vertex) { return t[0] == vertex || t[1] == vertex || t[2] == vertex; }

}  // namespace

// Pulls strips that hang together. Faces and vertices have their places among those of all strips.
class StripPulls {
 public:
  StripPulls(const Sharpener& all, const Sharpener::Part& part, Sharpener::State& state)
      : all_(all),
        part_(part),
        state_(state),
        gone_(part.faces, 0),
        faces_(part.vertices),
        changed_in_(part.vertices, 0) {
    for (std::uint32_t v = part.first_vertex; v < part.first_vertex + part.vertices; ++v) {
      state.into[v] = v;
      state.places[v] = all.first_.places[v];
    }
    for (std::uint32_t face = part.first_face; face < part.first_face + part.faces; ++face) {
      state.triangles[face] = all.first_.triangles[face];
      if (all.placed_[face] == Placed::kAcross) across_.push_back(face);
      for (const std::uint32_t corner : state.triangles[face]) {
        if (place(corner) != Sharpener::kNoPlace) faces(corner).push_back(face);
      }
    }
  }

  // Returns the number of pulls.
  std::size_t pull_all() {
    // What leads to a corner can be pulled there only after what is before it on the edge.
    constexpr int kPasses = 32;
    std::size_t pulls = 0;
    for (pass_ = 1; pass_ <= kPasses; ++pass_) {
      const std::size_t before = pulls;
      for (const auto& [square, p, q, u, v] : edges_of_strips()) pulls += pull(last_of(u), last_of(v)) ? 1 : 0;
      if (pulls == before) break;
    }
    for (std::uint32_t v = part_.first_vertex; v < part_.first_vertex + part_.vertices; ++v)
      state_.into[v] = place(last_of(all_.strip_vertices_[v]));
    for (std::uint32_t n = 0; n < gone_.size(); ++n) {
      Triangle& t = state_.triangles[part_.first_face + n];
      if (gone_[n] != 0) t.fill(t[0]);
    }
    return pulls;
  }

 private:
  using Placed = Sharpener::Placed;
  using Place = std::array<double, 3>;
  using Edge = std::tuple<double, Place, Place, std::uint32_t, std::uint32_t>;  // square of the length, ends
  using Faces = std::vector<std::uint32_t>;

  [[nodiscard]] std::uint32_t place(std::uint32_t vertex) const { return all_.place_[vertex]; }
  [[nodiscard]] const Vec3& position(std::uint32_t vertex) const {
    return place(vertex) == Sharpener::kNoPlace ? all_.vertices_[vertex] : state_.places[place(vertex)];
  }
  [[nodiscard]] std::uint32_t last_of(std::uint32_t vertex) const {
    std::uint32_t at = place(vertex);
    while (state_.into[at] != at) at = state_.into[at];
    return all_.strip_vertices_[at];
  }

  [[nodiscard]] std::vector<Edge> edges_of_strips();
  [[nodiscard]] int& changed_in(std::uint32_t vertex) { return changed_in_[place(vertex) - part_.first_vertex]; }
  [[nodiscard]] bool may_have_changed(std::uint32_t vertex) { return changed_in(vertex) >= pass_ - 1; }
  [[nodiscard]] std::uint8_t& gone(std::uint32_t face) { return gone_[face - part_.first_face]; }
  bool pull(std::uint32_t u, std::uint32_t v);
  void join(std::uint32_t u, std::uint32_t v);
  [[nodiscard]] bool is_link_sound(std::uint32_t u, std::uint32_t v) const;
  [[nodiscard]] std::optional<Vec3> place_for(std::uint32_t u, std::uint32_t v);
  [[nodiscard]] bool is_on_mesh(const Vec3& p) const;
  [[nodiscard]] bool keeps_fronts(std::uint32_t vertex, std::uint32_t other, const Vec3& place) const;
  [[nodiscard]] bool add_plane(std::uint32_t face, std::vector<Plane>& planes) const;
  [[nodiscard]] std::optional<Vec3> meeting_point(std::span<const Plane> planes, const Vec3& near) const;

  [[nodiscard]] Faces& faces(std::uint32_t vertex) { return faces_[place(vertex) - part_.first_vertex]; }
  [[nodiscard]] const Faces& faces(std::uint32_t vertex) const { return faces_[place(vertex) - part_.first_vertex]; }
  [[nodiscard]] bool has(std::uint32_t face, std::uint32_t vertex) const {
    return raycone::has(state_.triangles[face], vertex);
  }

  const Sharpener& all_;
  const Sharpener::Part& part_;
  Sharpener::State& state_;
  std::vector<std::uint8_t> gone_;     // of each face
  std::vector<std::uint32_t> across_;  // faces that lead across, and are not gone
  std::vector<Faces> faces_;           // of each vertex
  std::vector<int> changed_in_;        // likewise, the last pass that changed one of its faces
  int pass_ = 0;
};

// Shortest first: those that lead across. Of equal ones it is places that decide, not numbers of vertices, so that a
// larger lattice with the same nodes gives the same surface.
// Where nothing has changed since they were looked at, they are not looked at again.
std::vector<StripPulls::Edge> StripPulls::edges_of_strips() {
  std::erase_if(across_, [&](std::uint32_t face) { return gone(face) != 0; });
  const auto ordered = [&](std::uint32_t vertex) {
    const Vec3& p = position(vertex);
    return Place{p.x, p.y, p.z};
  };
  std::vector<Edge> edges;
  for (const std::uint32_t face : across_) {
    const Triangle& t = state_.triangles[face];
    for (std::size_t i = 0; i < 3; ++i) {
      std::uint32_t u = t[i], v = t[(i + 1) % 3];
      if (!may_have_changed(u) && !may_have_changed(v)) continue;
      if (ordered(v) < ordered(u)) std::swap(u, v);
      const Vec3 step = position(v) - position(u);
      const double square = dot(step, step), reach = all_.limits_.reach;
      if (square <= 4 * reach * reach) edges.emplace_back(square, ordered(u), ordered(v), u, v);
    }
  }
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

// Pulls v into u, and both to where their planes meet, if that can be done. That depends on the faces around them.
bool StripPulls::pull(std::uint32_t u, std::uint32_t v) {
  if (u == v || all_.kept_[place(u)] != 0 || all_.kept_[place(v)] != 0) return false;
  const auto leads_to_v = [&](std::uint32_t face) { return all_.placed_[face] != Placed::kInPlane && has(face, v); };
  if (!std::ranges::any_of(faces(u), leads_to_v)) return false;
  const std::optional<Vec3> target = place_for(u, v);
  if (!target || !is_link_sound(u, v) || !keeps_fronts(u, v, *target) || !keeps_fronts(v, u, *target)) return false;
  join(u, v);
  state_.places[place(u)] = *target;
  state_.into[place(v)] = place(u);
  return true;
}

void StripPulls::join(std::uint32_t u, std::uint32_t v) {
  for (const std::uint32_t face : faces(v)) {
    if (has(face, u)) {
      gone(face) = 1;
      for (const std::uint32_t corner : state_.triangles[face]) {
        if (corner != v && place(corner) != Sharpener::kNoPlace) std::erase(faces(corner), face);
      }
      continue;
    }
    for (std::uint32_t& corner : state_.triangles[face]) corner = corner == v ? u : corner;
    faces(u).push_back(face);
  }
  faces(v).clear();
  for (const std::uint32_t face : faces(u)) {
    for (const std::uint32_t corner : state_.triangles[face]) {
      if (place(corner) != Sharpener::kNoPlace) changed_in(corner) = pass_;
    }
  }
}

// The condition under which a closed 2-manifold stays one: the edge has two faces, and its ends no common neighbours
// but their third corners (Dey, Edelsbrunner, Guha and Nekhayev 1999).
bool StripPulls::is_link_sound(std::uint32_t u, std::uint32_t v) const {
  const auto neighbours = [&](std::uint32_t vertex) {
    std::vector<std::uint32_t> all;
    for (const std::uint32_t face : faces(vertex)) {
      for (const std::uint32_t corner : state_.triangles[face]) {
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
std::optional<Vec3> StripPulls::place_for(std::uint32_t u, std::uint32_t v) {
  std::vector<Plane> planes;
  for (const std::uint32_t vertex : {u, v}) {
    for (const std::uint32_t face : faces(vertex)) {
      if (all_.sources_[face] == kHole) return std::nullopt;
      if (all_.placed_[face] == Placed::kInPlane && !add_plane(face, planes)) return std::nullopt;
    }
  }
  const Vec3 &p = position(u), &q = position(v);
  // A vertex that is on the edge already stays: it may be where the edge bends.
  for (const Vec3& end : {p, q}) {
    const auto is_in = [&](const Plane& plane) { return std::abs(plane.height(end)) <= all_.limits_.off; };
    if (planes.size() >= 2 && std::ranges::all_of(planes, is_in)) return end;
  }
  std::optional<Vec3> place = meeting_point(planes, 0.5 * p + 0.5 * q);
  if (!place) return std::nullopt;
  if (all_.limits_.single_precision) {
    for (int axis = 0; axis < 3; ++axis) {
      const volatile auto single = static_cast<float>((*place)[axis]);  // as vertices of the contour are rounded
      (*place)[axis] = static_cast<double>(single);
    }
  }
  for (const Vec3& from : {p, q}) {
    const Vec3 step = *place - from;
    if (!(dot(step, step) <= all_.limits_.reach * all_.limits_.reach)) return std::nullopt;
  }
  return is_on_mesh(*place) ? place : std::nullopt;
}

bool StripPulls::is_on_mesh(const Vec3& p) const {
  double distance = 0.0;
  all_.distances_->evaluate({&p, 1}, {&distance, 1});
  return distance <= all_.limits_.off;
}

// Adds a face's plane unless it is there. Planes at less than 15 degrees, where an edge is not sharp, meet nowhere for
// sure: false.
bool StripPulls::add_plane(std::uint32_t face, std::vector<Plane>& planes) const {
  constexpr double kSame = 1 - 1e-10;  // cosine
  const std::int32_t source = all_.sources_[face];
  if (std::ranges::find(planes, source, &Plane::source) != planes.end()) return true;
  const Plane plane = plane_of(all_.input_, source);
  for (const Plane& other : planes) {
    const double cosine = std::abs(dot(plane.normal, other.normal));
    const bool same_place = std::abs(other.height(position(state_.triangles[face][0]))) <= 2 * all_.limits_.off;
    if (cosine >= kSame && same_place) return true;
    if (cosine > kSharpCosine) return false;
  }
  planes.push_back(plane);
  return planes.size() <= 3;
}

// The point of two or three planes that is nearest to `near`.
std::optional<Vec3> StripPulls::meeting_point(std::span<const Plane> planes, const Vec3& near) const {
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
bool StripPulls::keeps_fronts(std::uint32_t vertex, std::uint32_t other, const Vec3& place) const {
  return std::ranges::all_of(faces(vertex), [&](std::uint32_t face) {
    if (has(face, other)) return true;
    std::array<Vec3, 3> before, after;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t corner = state_.triangles[face][i];
      before[i] = position(corner);
      after[i] = corner == vertex ? place : before[i];
    }
    const Vec3 was = cross(before[1] - before[0], before[2] - before[0]);
    const Vec3 is = cross(after[1] - after[0], after[2] - after[0]);
    const bool may_turn = all_.placed_[face] != Placed::kInPlane && part_.may_turn;
    return may_turn ? dot(is, is) > 0.0 : dot(was, is) > 0.0;
  });
}

Sharpener::Sharpener(const SurfaceMesh& surface, const TriangleMesh& input, const SharpenLimits& limits)
    : vertices_(surface.mesh.vertices), input_(input), limits_(limits) {
  std::vector<Placed> of_all(surface.mesh.triangles.size());
  parallel_for(of_all.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t face = begin; face < end; ++face)
      of_all[face] = placed(surface.mesh.triangles[face], surface.sources[face]);
  });
  // Whether it is planes that the mesh is made of. Of CAD parts 75 to 99 per cent of the faces are in one, of scans
  // less than 70; there, most of what is pulled would not pass the check.
  if (4 * std::ranges::count(of_all, Placed::kInPlane) < 3 * std::ssize(of_all)) return;
  find_strips(surface, of_all);
  if (strip_vertices_.empty()) return;
  now_ = first_;
  distances_.emplace(input_);
  distances_->prepare_points();
}

// Faces over holes are in no plane, and belong to no strip.
Sharpener::Placed Sharpener::placed(const Triangle& t, std::int32_t source) const {
  constexpr double kTurned = 0.992546151641322;  // cosine of 7 degrees
  if (source == kHole) return Placed::kInPlane;
  const Plane plane = plane_of(input_, source);
  const Vec3 &a = vertices_[t[0]], &b = vertices_[t[1]], &c = vertices_[t[2]];
  const double farthest = std::max({std::abs(plane.height(a)), std::abs(plane.height(b)), std::abs(plane.height(c))});
  if (farthest <= limits_.off) return Placed::kInPlane;
  return std::abs(dot(plane.normal, unit_normal(a, b, c))) < kTurned ? Placed::kAcross : Placed::kOff;
}

void Sharpener::find_strips(const SurfaceMesh& surface, const std::vector<Placed>& of_all) {
  const std::vector<Triangle>& triangles = surface.mesh.triangles;
  place_.assign(vertices_.size(), kNoPlace);
  for (std::size_t face = 0; face < of_all.size(); ++face) {
    if (of_all[face] != Placed::kAcross) continue;
    for (const std::uint32_t corner : triangles[face]) {
      if (place_[corner] != kNoPlace) continue;
      place_[corner] = static_cast<std::uint32_t>(strip_vertices_.size());
      strip_vertices_.push_back(corner);
    }
  }
  find_parts(triangles);
  add_faces(surface, of_all);
  for (const std::uint32_t vertex : strip_vertices_) {
    first_.into.push_back(place_[vertex]);
    first_.places.push_back(vertices_[vertex]);
  }
  kept_.assign(strip_vertices_.size(), 0);
}

// Vertices with a face in common are of one part. They are numbered anew, part by part.
void Sharpener::find_parts(const std::vector<Triangle>& triangles) {
  std::vector<std::uint32_t> root(strip_vertices_.size());
  std::iota(root.begin(), root.end(), 0U);
  const auto root_of = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const Triangle& t : triangles) {
    std::uint32_t known = kNoPlace;
    for (const std::uint32_t corner : t) {
      if (place_[corner] == kNoPlace) continue;
      const std::uint32_t here = root_of(place_[corner]);
      if (known != kNoPlace) root[std::max(known, here)] = std::min(known, here);
      known = known == kNoPlace ? here : std::min(known, here);
    }
  }
  std::vector<std::uint32_t> part(root.size());  // roots come first
  for (std::uint32_t v = 0; v < root.size(); ++v) {
    const std::uint32_t of = root_of(v);
    if (of == v) {
      part[v] = static_cast<std::uint32_t>(parts_.size());
      parts_.emplace_back();
    }
    part[v] = part[of];
    ++parts_[part[v]].vertices;
  }
  for (std::size_t n = 1; n < parts_.size(); ++n)
    parts_[n].first_vertex = parts_[n - 1].first_vertex + parts_[n - 1].vertices;
  std::vector<std::uint32_t> next;
  for (const Part& each : parts_) next.push_back(each.first_vertex);
  const std::vector<std::uint32_t> vertices = std::exchange(strip_vertices_, {});
  strip_vertices_.resize(vertices.size());
  part_of_.resize(vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const std::uint32_t place = next[part[v]]++;
    place_[vertices[v]] = place;
    strip_vertices_[place] = vertices[v];
    part_of_[place] = part[v];
  }
}

// kNoPlace where it has no vertex of a strip.
std::uint32_t Sharpener::part_of_face(const Triangle& t) const {
  for (const std::uint32_t corner : t) {
    if (place_[corner] != kNoPlace) return part_of_[place_[corner]];
  }
  return kNoPlace;
}

void Sharpener::add_faces(const SurfaceMesh& surface, const std::vector<Placed>& of_all) {
  std::vector<std::uint32_t> at_strips;
  for (std::uint32_t face = 0; face < of_all.size(); ++face) {
    const std::uint32_t part = part_of_face(surface.mesh.triangles[face]);
    if (part == kNoPlace) continue;
    at_strips.push_back(face);
    ++parts_[part].faces;
  }
  for (std::size_t n = 1; n < parts_.size(); ++n) parts_[n].first_face = parts_[n - 1].first_face + parts_[n - 1].faces;
  std::vector<std::uint32_t> next;
  for (const Part& each : parts_) next.push_back(each.first_face);
  faces_.resize(at_strips.size());
  for (const std::uint32_t face : at_strips) faces_[next[part_of_face(surface.mesh.triangles[face])]++] = face;
  for (const std::uint32_t face : faces_) {
    sources_.push_back(surface.sources[face]);
    placed_.push_back(of_all[face]);
    first_.triangles.push_back(surface.mesh.triangles[face]);
  }
}

std::size_t Sharpener::pulls() const {
  return std::accumulate(parts_.begin(), parts_.end(), std::size_t{0},
                         [](std::size_t sum, const Part& part) { return sum + part.pulls; });
}

SurfaceEdit Sharpener::sharpen() {
  std::vector<std::uint32_t> all(parts_.size());
  std::iota(all.begin(), all.end(), 0U);
  return pull_parts(all);
}

SurfaceEdit Sharpener::keep(const std::vector<std::uint32_t>& vertices, bool all) {
  std::vector<std::uint8_t> named(strip_vertices_.size(), 0), anew(parts_.size(), 0);
  for (const std::uint32_t vertex : vertices) {
    if (vertex >= place_.size() || place_[vertex] == kNoPlace) continue;
    named[place_[vertex]] = 1;
    anew[part_of_[place_[vertex]]] = 1;
  }
  for (std::size_t v = 0; v < kept_.size(); ++v) {
    if (named[v] != 0 || named[now_.into[v]] != 0 || (all && anew[part_of_[v]] != 0)) kept_[v] = 1;
  }
  std::vector<std::uint32_t> parts;
  for (std::uint32_t part = 0; part < parts_.size(); ++part) {
    if (anew[part] == 0) continue;
    parts_[part].may_turn = false;
    parts.push_back(part);
  }
  return pull_parts(parts);
}

SurfaceEdit Sharpener::undo() {
  std::ranges::fill(kept_, 1);
  return sharpen();
}

SurfaceEdit Sharpener::pull_parts(const std::vector<std::uint32_t>& parts) {
  const State before = now_;
  parallel_for(parts.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      Part& part = parts_[parts[n]];
      part.pulls = StripPulls(*this, part, now_).pull_all();
    }
  });
  return changes_of(parts, before);
}

SurfaceEdit Sharpener::changes_of(const std::vector<std::uint32_t>& parts, const State& before) const {
  SurfaceEdit edit;
  const auto has_moved = [&](std::uint32_t corner) {
    const std::uint32_t place = place_[corner];
    return place != kNoPlace && before.places[place] != now_.places[place];
  };
  for (const std::uint32_t n : parts) {
    const Part& part = parts_[n];
    for (std::uint32_t v = part.first_vertex; v < part.first_vertex + part.vertices; ++v) {
      if (!has_moved(strip_vertices_[v])) continue;
      edit.vertices.push_back(strip_vertices_[v]);
      edit.places.push_back({before.places[v], now_.places[v]});
    }
    for (std::uint32_t face = part.first_face; face < part.first_face + part.faces; ++face) {
      const Triangle &was = before.triangles[face], &is = now_.triangles[face];
      if (was == is && std::ranges::none_of(is, has_moved)) continue;
      edit.faces.push_back(faces_[face]);
      edit.corners.push_back({was, is});
    }
  }
  return edit;
}

}  // namespace raycone
