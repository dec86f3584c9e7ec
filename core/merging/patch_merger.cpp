#include "core/merging/patch_merger.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/cells/surface_mesh.h"
#include "core/cells/triangle_shape.h"
#include "core/cells/unit_normal.h"

namespace raycone {
namespace {

// Pulls make no face of less shape_along() than this, unless there was one before.
constexpr double kLeastShape = 2e-3;

// Cosine between the fronts of two planes that are nearly back to back, with less than 30 degrees of solid between
// them. Where there are more, a point that is near to both planes is no more than four times as far from the line where
// they meet.
constexpr double kBackToBack = -0.866;  // cosine

double longest_square(const Vec3& u, const Vec3& v) {
  const Vec3 w = v - u;
  return std::max({dot(u, u), dot(v, v), dot(w, w)});
}

}  // namespace

template <class Visit>
void PatchMerger::for_each_face(std::uint32_t v, const Visit& visit) const {
  for (Corner corner = first_[v], next = kNoCorner; corner != kNoCorner; corner = next) {
    const std::uint32_t number = face_of(corner), place = place_of(corner);
    const Face& face = faces_[number];
    next = face.next[place];
    if (!visit(number, face.corners[place == 2 ? 0 : place + 1], face.corners[place == 0 ? 2 : place - 1])) return;
  }
}

PatchMerger::PatchMerger(const SurfacePatch& patch, const TriangleMesh& input, const MergeLimits& limits)
    : patch_(patch),
      limits_(limits),
      roles_(patch.roles),
      faces_(patch.triangles.size()),
      planes_(input),
      first_(patch.vertices.size(), kNoCorner),
      state_(patch.vertices.size()),
      touched_(patch.vertices.size(), 0),
      by_geometry_(patch.vertices.size(), 0),
      into_(patch.vertices.size()),
      marked_(patch.vertices.size(), 0) {
  // Backwards, so that chains are in the order of the faces.
  for (auto number = static_cast<std::uint32_t>(faces_.size()); number-- > 0;) {
    Face& face = faces_[number];
    face.corners = patch.triangles[number];
    face.is_hole = patch.sources[number] == kHole;
    for (std::uint32_t place = 3; place-- > 0;) {
      Corner& first = first_[face.corners[place]];
      face.next[place] = first;
      first = corner_of(number, place);
    }
  }
  for (std::uint32_t v = 0; v < into_.size(); ++v) into_[v] = v;
  for (std::uint32_t face = 0; face < faces_.size(); ++face) faces_[face].is_needle = is_needle(face);
  spread(VertexRole::kForeign);
  spread(VertexRole::kKept);
  for (std::uint32_t v = 0; v < state_.size(); ++v) {
    const bool is_free = roles_[v] == VertexRole::kFree;
    state_[v] = !is_free ? State::kFixed : patch_.settled[v] != 0 ? State::kSettled : State::kWaits;
  }
}

// The points at one node become one, or all of them stay: between some of them needles would be left that turn over.
void PatchMerger::spread(VertexRole role) {
  std::vector<std::uint32_t> reached;
  for (std::uint32_t v = 0; v < roles_.size(); ++v) {
    if (roles_[v] == role) reached.push_back(v);
  }
  while (!reached.empty()) {
    const std::uint32_t v = reached.back();
    reached.pop_back();
    const auto reach = [&](std::uint32_t w) {
      if (roles_[w] >= role || !is_at_node(v, w)) return;
      roles_[w] = role;
      reached.push_back(w);
    };
    for_each_face(v, [&](std::uint32_t, std::uint32_t next, std::uint32_t last) {
      reach(next);
      reach(last);
      return true;
    });
  }
}

// Faces of one source have one plane, the source's, as far as their corners are in it. Fronts are told apart. Others
// are parallel to it, where points at nodes were moved off it by as much, or have a plane of their own.
std::uint32_t PatchMerger::plane_of(std::uint32_t face) {
  const Triangle& t = faces_[face].corners;
  const Vec3 &a = position(t[0]), &b = position(t[1]), &c = position(t[2]);
  if (patch_.sources[face] != kHole) {
    const auto has_corners = [&](const PatchPlane& plane) {
      return std::ranges::all_of(t, [&](std::uint32_t v) { return plane.distance(position(v)) <= limits_.most; });
    };
    const std::uint32_t of_source = planes_.of_source(patch_.sources[face], cross(b - a, c - a));
    if (has_corners(planes_[of_source])) return of_source;
    const PatchPlane parallel{a, planes_[of_source].normal, false};
    if (has_corners(parallel)) return planes_.add(parallel);
  }
  return planes_.add({a, unit_normal(a, b, c), false});
}

// Faces change only when their planes are known: those around a vertex are looked at before it is pulled.
std::uint32_t PatchMerger::plane_at(std::uint32_t face) {
  std::uint32_t& plane = faces_[face].plane;
  if (plane == PatchPlanes::kNoPlane) plane = plane_of(face);
  return plane;
}

// Needles lie between points that are kept off one node of the lattice, where the mesh passes through it.
bool PatchMerger::is_needle(std::uint32_t face) const {
  const Triangle& t = faces_[face].corners;
  const Vec3 u = position(t[1]) - position(t[0]), v = position(t[2]) - position(t[0]), normal = cross(u, v);
  return dot(normal, normal) < limits_.needle * limits_.needle * longest_square(u, v);
}

// The points at each node first: while all of them are there, one is found that lies in all planes.
void PatchMerger::merge() {
  if (std::ranges::any_of(faces_, &Face::is_needle)) pull_all(&PatchMerger::target_at_node);
  for (State& state : state_) state = state == State::kStays ? State::kWaits : state;
  pull_all(&PatchMerger::best_target);
  for (std::uint32_t& target : into_) {
    while (into_[target] != target) target = into_[target];
  }
}

// In each pass no vertex is pulled that a neighbour was pulled into, so that faces grow evenly.
void PatchMerger::pull_all(Target target_of) {
  for (bool pulled = true; pulled;) {
    pulled = false;
    for (std::uint32_t v = 0; v < state_.size(); ++v) {
      if (state_[v] != State::kWaits) continue;
      const std::optional<std::uint32_t> target = (this->*target_of)(v);
      state_[v] = target ? State::kGone : State::kStays;
      if (!target) continue;
      pull(v, *target);
      pulled = true;
    }
    for (State& state : state_) state = state == State::kNext ? State::kWaits : state;
  }
}

// Of neighbours that are as good the first is taken: on a lattice, such choices then agree from vertex to vertex.
void PatchMerger::find_star(std::uint32_t v) {
  star_.clear();
  unsorted_.clear();
  for_each_face(v, [&](std::uint32_t face, std::uint32_t next, std::uint32_t last) {
    star_.push_back({plane_at(face), next, last, faces_[face].is_needle, faces_[face].is_hole});
    unsorted_.push_back(next);
    return true;
  });
  sort_ring();
}

// Of few, as most are, how many come before each is found without branches, which nobody could foresee.
void PatchMerger::sort_ring() {
  constexpr std::size_t kFew = 24;
  if (unsorted_.size() > kFew) {
    ring_ = unsorted_;
    std::ranges::sort(ring_);
    return;
  }
  ring_.resize(unsorted_.size());
  for (std::size_t n = 0; n < unsorted_.size(); ++n) {
    std::size_t before = 0;
    for (std::size_t other = 0; other < n; ++other) before += unsorted_[other] <= unsorted_[n] ? 1U : 0U;
    for (std::size_t other = n + 1; other < unsorted_.size(); ++other)
      before += unsorted_[other] < unsorted_[n] ? 1U : 0U;
    ring_[before] = unsorted_[n];
  }
}

// The worst of the faces, their vertex pulled into `target`, that are left. The search ends at one that is not above
// `needed`.
double PatchMerger::worst_shape(std::uint32_t target, Needles needles, double needed) const {
  double worst = std::numeric_limits<double>::infinity();
  for (const StarFace& face : star_) {
    if (face.next == target || face.last == target || (face.is_needle && needles == Needles::kLeftOut)) continue;
    worst = std::min(
        worst, shape_along(planes_[face.plane].normal, position(target), position(face.next), position(face.last)));
    if (!(worst > needed)) break;
  }
  return worst;
}

void PatchMerger::find_planes(Needles needles) {
  around_.clear();
  for (const StarFace& face : star_) {
    if (face.is_needle && needles == Needles::kLeftOut) continue;
    if (std::ranges::find(around_, face.plane) == around_.end()) around_.push_back(face.plane);
  }
}

bool PatchMerger::is_in_planes(const Vec3& p) const {
  return std::ranges::all_of(around_, [&](std::uint32_t plane) { return planes_[plane].distance(p) <= limits_.most; });
}

// Some lines hold although planes do not hold them: the rim of a fin or a blade, around which faces lie back to back;
// and the border of faces that close a hole, which may be in the plane of what is beside it. A vertex there must be on
// the straight line between its neighbours on the line, and goes to one of them.
bool PatchMerger::may_have_rim() const {
  const bool holes = star_.front().is_hole;
  if (std::ranges::any_of(star_, [&](const StarFace& face) { return face.is_hole != holes; })) return true;
  for (std::size_t i = 1; i < around_.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (dot(planes_[around_[i]].normal, planes_[around_[j]].normal) < kBackToBack) return true;
    }
  }
  return false;
}

std::vector<std::uint32_t> PatchMerger::rim_neighbours() const {
  std::vector<std::uint32_t> neighbours;
  for (const StarFace& face : star_) {
    const auto across = std::ranges::find(star_, face.next, &StarFace::last);
    if (across == star_.end()) continue;
    const bool back_to_back = dot(planes_[face.plane].normal, planes_[across->plane].normal) < kBackToBack;
    if (back_to_back || face.is_hole != across->is_hole) neighbours.push_back(face.next);
  }
  return neighbours;
}

bool PatchMerger::keeps_rim(std::uint32_t v, std::uint32_t target, const std::vector<std::uint32_t>& rim) const {
  if (rim.empty()) return true;
  if (rim.size() != 2 || std::ranges::find(rim, target) == rim.end()) return false;
  const Vec3 &p = position(v), &a = position(rim[0]), &b = position(rim[1]);
  const Vec3 along = b - a, off = cross(along, p - a);
  const bool between = dot(p - a, along) > 0.0 && dot(p - b, along) < 0.0;
  return between && dot(off, off) <= limits_.most * limits_.most * dot(along, along);
}

// The link condition (Dey, Edelsbrunner, Guha, Nekhayev 1999): the vertex and `target` have no neighbours in common but
// those of their two faces.
bool PatchMerger::keeps_topology(std::uint32_t target) {
  ++marks_;
  for (const std::uint32_t neighbour : ring_) marked_[neighbour] = marks_;
  int common = 0;
  for_each_face(target, [&](std::uint32_t, std::uint32_t next, std::uint32_t) {
    common += marked_[next] == marks_ ? 1 : 0;
    return true;
  });
  return common == 2;
}

bool PatchMerger::is_at_needle(std::uint32_t v) const {
  bool found = false;
  for_each_face(v, [&](std::uint32_t face, std::uint32_t, std::uint32_t) {
    found = faces_[face].is_needle;
    return !found;
  });
  return found;
}

// A vertex at the same node of the lattice that v can be pulled into: of those in most planes there the nearest.
// Needles have no say; they vanish as all points at a node become one.
std::optional<std::uint32_t> PatchMerger::target_at_node(std::uint32_t v) {
  constexpr double kMayLose = 0.25;
  if (!is_at_needle(v)) return std::nullopt;
  find_star(v);
  find_planes(Needles::kLeftOut);
  const std::vector<std::uint32_t> faces = faces_at_node(v);
  const double before = worst_shape(v, Needles::kLeftOut, -std::numeric_limits<double>::infinity());
  const double needed = std::max(0.0, kMayLose * std::min(kLeastShape, before));
  std::optional<std::uint32_t> best;
  std::pair best_rank(planes_through(v, faces), -limits_.needle);
  for (const std::uint32_t target : ring_) {
    const std::pair rank(planes_through(target, faces), -distance(v, target));
    if (!(rank > best_rank) || roles_[target] == VertexRole::kForeign || !is_at_node(v, target)) continue;
    if (!is_in_planes(position(target))) continue;
    if (!(worst_shape(target, Needles::kLeftOut, needed) > needed) || !keeps_topology(target)) continue;
    best = target;
    best_rank = rank;
  }
  return best;
}

double PatchMerger::distance(std::uint32_t v, std::uint32_t w) const {
  const Vec3 step = position(w) - position(v);
  return std::sqrt(dot(step, step));
}

bool PatchMerger::is_at_node(std::uint32_t v, std::uint32_t w) const { return distance(v, w) < limits_.needle; }

// The faces that are no needles at v, whose star is known, and at its neighbours at the same node.
std::vector<std::uint32_t> PatchMerger::faces_at_node(std::uint32_t v) const {
  std::vector<std::uint32_t> faces;
  const auto add = [&](std::uint32_t vertex) {
    for_each_face(vertex, [&](std::uint32_t face, std::uint32_t, std::uint32_t) {
      if (!faces_[face].is_needle) faces.push_back(face);
      return true;
    });
  };
  add(v);
  for (const std::uint32_t neighbour : ring_) {
    if (is_at_node(v, neighbour)) add(neighbour);
  }
  return faces;
}

std::ptrdiff_t PatchMerger::planes_through(std::uint32_t v, const std::vector<std::uint32_t>& faces) {
  return std::ranges::count_if(
      faces, [&](std::uint32_t face) { return planes_[plane_at(face)].distance(position(v)) <= limits_.most; });
}

// The vertex that v can be pulled into with the best faces around.
std::optional<std::uint32_t> PatchMerger::best_target(std::uint32_t v) {
  find_star(v);
  find_planes(Needles::kCounted);
  const std::vector<std::uint32_t> rim = may_have_rim() ? rim_neighbours() : std::vector<std::uint32_t>();
  std::optional<std::uint32_t> best;
  bool by_geometry = true;
  std::optional<double> best_shape;  // most vertices have no target in their planes, and need none
  for (const std::uint32_t target : ring_) {
    if (!is_in_planes(position(target)) || !keeps_rim(v, target, rim)) continue;
    if (roles_[target] == VertexRole::kForeign) {
      by_geometry = false;
      continue;
    }
    if (!best_shape) {
      const double before = worst_shape(v, Needles::kCounted, -std::numeric_limits<double>::infinity());
      best_shape = std::max(0.0, std::min(kLeastShape, before));
    }
    const double worst = worst_shape(target, Needles::kCounted, *best_shape);
    if (!(worst > *best_shape)) continue;
    by_geometry = false;
    if (!keeps_topology(target)) continue;
    best = target;
    best_shape = worst;
  }
  by_geometry_[v] = by_geometry ? 1 : 0;
  return best;
}

void PatchMerger::unlink(Corner corner, std::uint32_t vertex) {
  Corner* link = &first_[vertex];
  while (*link != corner) link = &next_of(*link);
  *link = next_of(corner);
}

void PatchMerger::pull(std::uint32_t v, std::uint32_t target) {
  for_each_face(v, [&](std::uint32_t, std::uint32_t next, std::uint32_t) {
    touched_[next] = 1;
    if (state_[next] != State::kFixed) state_[next] = State::kNext;
    return true;
  });
  for (Corner corner = first_[v], following = kNoCorner; corner != kNoCorner; corner = following) {
    following = next_of(corner);
    const std::uint32_t number = face_of(corner);
    Face& face = faces_[number];
    Triangle& t = face.corners;
    if (t[0] == target || t[1] == target || t[2] == target) {
      for (std::uint32_t place = 0; place < 3; ++place) {
        if (t[place] != v) unlink(corner_of(number, place), t[place]);
      }
      t = {};
      continue;
    }
    t[place_of(corner)] = target;
    next_of(corner) = first_[target];
    first_[target] = corner;
    face.is_changed = true;
    if (!face.is_needle) continue;
    face.is_needle = is_needle(number);
    face.plane = plane_of(number);
  }
  first_[v] = kNoCorner;
  into_[v] = target;
}

// Another patch takes the planes of its faces from their corners as they are then. Those of sources stay what they
// are, but other planes of faces that have changed since would be new ones, and a face that has become a needle would
// be none here.
bool PatchMerger::is_settled(std::uint32_t v) const {
  if (state_[v] == State::kSettled) return true;
  if (state_[v] == State::kFixed) return patch_.settled[v] != 0 && touched_[v] == 0;
  if (state_[v] != State::kStays || by_geometry_[v] == 0) return false;
  bool is_same = true;
  for_each_face(v, [&](std::uint32_t number, std::uint32_t, std::uint32_t) {
    const Face& face = faces_[number];
    is_same = !face.is_needle && (!face.is_changed || (planes_[face.plane].is_of_source && !is_needle(number)));
    return is_same;
  });
  return is_same;
}

}  // namespace raycone
