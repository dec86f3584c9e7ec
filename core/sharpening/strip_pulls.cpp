#include "core/sharpening/strip_pulls.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

#include "core/cells/cell_creases.h"
#include "core/certificate/surface_edit.h"
#include "core/data/coordinate_precision.h"
#include "core/machine/threads.h"

namespace raycone {
StripPulls::StripPulls(const Sharpener& all, const Sharpener::Part& part, Sharpener::State& state)
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
    state.sources[face] = all.first_.sources[face];
    state.placed[face] = all.first_.placed[face];
    if (is_gone(state.triangles[face])) {
      gone(face) = 1;
      free_faces_.push_back(face);
      continue;
    }
    for (const std::uint32_t corner : state.triangles[face]) {
      if (place(corner) != Sharpener::kNoPlace) faces(corner).push_back(face);
    }
  }
  for (std::uint32_t v = part.vertices - part.spares; v < part.vertices; ++v)
    free_vertices_.push_back(all.strip_vertices_[part.first_vertex + v]);
}

std::size_t StripPulls::pull_all() {
  // What leads to a corner can be pulled there only after what is before it on the edge.
  constexpr int kPasses = 32;
  std::size_t pulls = fill_gaps();
  for (std::uint32_t n = 0; n < gone_.size(); ++n) {
    if (gone_[n] == 0 && state_.placed[part_.first_face + n] == Placed::kAcross)
      across_.push_back(part_.first_face + n);
  }
  for (pass_ = 1; pass_ <= kPasses; ++pass_) {
    const std::size_t before = pulls;
    for (const auto& [square, p, q, u, v] : edges_of_strips()) pulls += pull(last_of(u), last_of(v)) ? 1 : 0;
    if (pulls == before) break;
  }
  pulls += fill_gaps();
  for (std::uint32_t v = part_.first_vertex; v < part_.first_vertex + part_.vertices; ++v)
    state_.into[v] = place(last_of(all_.strip_vertices_[v]));
  for (std::uint32_t n = 0; n < gone_.size(); ++n) {
    Triangle& t = state_.triangles[part_.first_face + n];
    if (gone_[n] != 0) t.fill(t[0]);
  }
  return pulls;
}

// The face is looked for among those of one end, which must be a vertex of strips; kNoFace, too, where neither end is
// one.
std::uint32_t StripPulls::face_with(std::uint32_t from, std::uint32_t to) const {
  const std::uint32_t end = place(from) != Sharpener::kNoPlace ? from : to;
  if (place(end) == Sharpener::kNoPlace) return kNoFace;
  for (const std::uint32_t face : faces(end)) {
    if (has_side(state_.triangles[face], from, to)) return face;
  }
  return kNoFace;
}

// Returns the number of those that could be filled. What fills one does not depend on others: they have no side in
// common, and none moves a corner of another one.
std::size_t StripPulls::fill_gaps() {
  std::vector<Gap> gaps;
  std::vector<std::uint8_t> seen(gone_.size(), 0);
  for (std::uint32_t n = 0; n < gone_.size(); ++n) {
    const std::uint32_t first = part_.first_face + n;
    if (gone_[n] != 0 || seen[n] != 0 || !is_off(first)) continue;
    seen[n] = 1;
    const auto joins = [&](std::uint32_t face) {
      return is_off(face) && std::exchange(seen[face - part_.first_face], 1) == 0;
    };
    Gap gap{faces_joined_to(first, *this, joins), {}, {}, {}};
    if (!is_hopeless(gap.faces)) gaps.push_back(std::move(gap));
  }
  parallel_for_each(gaps.size(), [&](std::size_t n) { find_fill(gaps[n]); });
  std::size_t filled = 0;
  for (const Gap& gap : gaps) {
    if (fill(gap)) {
      ++filled;
    } else if (pass_ == 0) {
      state_.hopeless[gap.faces.front()] = 1;
    }
  }
  return filled;
}

// Before pulls, what could not be filled once; after pulls, what they have not changed.
bool StripPulls::is_hopeless(const Faces& gap) {
  if (pass_ == 0) return state_.hopeless[gap.front()] != 0;
  const auto is_changed = [&](std::uint32_t v) { return place(v) != Sharpener::kNoPlace && changed_in(v) > 0; };
  return std::ranges::none_of(
      gap, [&](std::uint32_t face) { return std::ranges::any_of(state_.triangles[face], is_changed); });
}

// Nothing is filled where vertices are to stay.
void StripPulls::find_fill(Gap& gap) const {
  constexpr std::size_t kMostSides = 256;
  const std::vector<GapSide> border = border_of_gap(gap.faces, *this, kMostSides);
  const auto is_kept = [&](const GapSide& side) {
    return place(side.from) != Sharpener::kNoPlace && all_.kept_[place(side.from)] >= Sharpener::kKeptFrom;
  };
  const std::optional<GapLoop> around = loop_along(border, *this);
  if (border.empty() || !around || std::ranges::any_of(border, is_kept)) return;
  for (const GapSide& side : border) gap.loop.push_back(side.from);
  const std::optional<Faces> within = vertices_within(gap.faces, border, *this);
  if (!within) return;
  gap.free = *within;
  if (std::ranges::any_of(gap.free, [&](std::uint32_t v) { return place(v) == Sharpener::kNoPlace; })) return;
  const auto are_all = [&](std::span<const Vec3> points) { return are_all_on_mesh(points); };
  gap.filled =
      fill_gap(*around, all_.input_,
               {all_.limits_.off, all_.limits_.reach, gap.free.size() + part_.spares, all_.limits_.precision, are_all});
}

bool StripPulls::fill(const Gap& gap) {
  if (!gap.filled || gap.filled->corners.size() > gap.free.size() + free_vertices_.size() ||
      gap.filled->triangles.size() > gap.faces.size() + free_faces_.size()) {
    return false;
  }
  free_vertices_.insert(free_vertices_.end(), gap.free.begin(), gap.free.end());
  replace(gap.faces, gap.loop, *gap.filled);
  return true;
}

void StripPulls::replace(const Faces& gap, const Faces& loop, const GapFill& filled) {
  for (const std::uint32_t face : gap) {
    gone(face) = 1;
    free_faces_.push_back(face);
    for (const std::uint32_t corner : state_.triangles[face]) {
      if (place(corner) != Sharpener::kNoPlace) std::erase(faces(corner), face);
    }
  }
  Faces corners = loop;
  for (const Vec3& p : filled.corners) {
    corners.push_back(free_vertices_.back());
    free_vertices_.pop_back();
    state_.places[place(corners.back())] = p;
  }
  for (std::size_t n = 0; n < filled.triangles.size(); ++n) {
    const std::uint32_t face = free_faces_.back();
    free_faces_.pop_back();
    Triangle t = filled.triangles[n];
    for (std::uint32_t& corner : t) corner = corners[corner];
    gone(face) = 0;
    state_.triangles[face] = t;
    state_.sources[face] = filled.sources[n];
    state_.placed[face] = Placed::kInPlane;
    for (const std::uint32_t corner : t) {
      if (place(corner) == Sharpener::kNoPlace) continue;
      faces(corner).push_back(face);
      if (pass_ > 0) changed_in(corner) = pass_;
    }
  }
}

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
  const auto leads_to_v = [&](std::uint32_t face) { return state_.placed[face] != Placed::kInPlane && has(face, v); };
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
  std::vector<SourcePlane> planes;
  for (const std::uint32_t vertex : {u, v}) {
    for (const std::uint32_t face : faces(vertex)) {
      if (state_.sources[face] == kHole) return std::nullopt;
      if (state_.placed[face] == Placed::kInPlane && !add_plane(face, planes)) return std::nullopt;
    }
  }
  const Vec3 &p = position(u), &q = position(v);
  // A vertex that is on the edge already stays: it may be where the edge bends.
  for (const Vec3& end : {p, q}) {
    const auto is_in = [&](const SourcePlane& plane) { return std::abs(plane.height(end)) <= all_.limits_.off; };
    if (planes.size() >= 2 && std::ranges::all_of(planes, is_in)) return end;
  }
  std::optional<Vec3> place = meeting_point(planes, 0.5 * p + 0.5 * q);
  if (!place) return std::nullopt;
  place = rounded_to(all_.limits_.precision, *place);
  for (const Vec3& from : {p, q}) {
    const Vec3 step = *place - from;
    if (!(dot(step, step) <= all_.limits_.reach * all_.limits_.reach)) return std::nullopt;
  }
  return are_all_on_mesh({&*place, 1}) ? place : std::nullopt;
}

bool StripPulls::are_all_on_mesh(std::span<const Vec3> points) const {
  return are_on_mesh(points, all_.distance_, all_.limits_.off);
}

// Adds a face's plane unless it is there. Planes at less than 15 degrees, where an edge is not sharp, meet nowhere for
// sure: false.
bool StripPulls::add_plane(std::uint32_t face, std::vector<SourcePlane>& planes) const {
  constexpr double kSame = 1 - 1e-10;  // cosine
  const std::int32_t source = state_.sources[face];
  if (std::ranges::find(planes, source, &SourcePlane::source) != planes.end()) return true;
  const SourcePlane plane = source_plane(all_.input_, source);
  for (const SourcePlane& other : planes) {
    const double cosine = std::abs(dot(plane.normal, other.normal));
    const bool same_place = std::abs(other.height(position(state_.triangles[face][0]))) <= 2 * all_.limits_.off;
    if (cosine >= kSame && same_place) return true;
    if (cosine > kSharpCosine) return false;
  }
  planes.push_back(plane);
  return planes.size() <= 3;
}

// Whether the faces of a vertex that are left have an area, and are not turned over, when it moves.
bool StripPulls::keeps_fronts(std::uint32_t vertex, std::uint32_t other, const Vec3& place) const {
  return std::ranges::all_of(faces(vertex), [&](std::uint32_t face) {
    if (has(face, other)) return true;
    Corners3 before, after;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t corner = state_.triangles[face][i];
      before[i] = position(corner);
      after[i] = corner == vertex ? place : before[i];
    }
    const Vec3 was = cross(before[1] - before[0], before[2] - before[0]);
    const Vec3 is = cross(after[1] - after[0], after[2] - after[0]);
    const bool may_turn = state_.placed[face] != Placed::kInPlane && part_.may_turn;
    return may_turn ? dot(is, is) > 0.0 : dot(was, is) > 0.0;
  });
}

}  // namespace raycone
