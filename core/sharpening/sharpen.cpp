#include "core/sharpening/sharpen.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/cells/surface_mesh.h"
#include "core/certificate/fault_places.h"
#include "core/machine/numbers_where.h"
#include "core/machine/threads.h"
#include "core/mesh/disjoint_sets.h"
#include "core/sharpening/strip_pulls.h"

namespace raycone {

Sharpener::Sharpener(SurfaceMesh& surface, const SharpenInput& input, const SharpenLimits& limits)
    : surface_(surface),
      first_vertices_(surface.mesh.vertices.size()),
      first_faces_(surface.mesh.triangles.size()),
      input_(input.mesh),
      distance_(input.distance),
      limits_(limits) {
  const std::vector<Placed> of_all = placements(surface, input.mesh, input.normals, limits.off);
  find_strips(of_all);
  if (strip_vertices_.empty()) return;
  now_ = first_;
  distance_.prepare_points();
}

void Sharpener::find_strips(const std::vector<Placed>& of_all) {
  const std::vector<Triangle>& triangles = surface_.mesh.triangles;
  place_.assign(first_vertices_, kNoPlace);
  const auto is_across = [&](std::uint32_t face) { return of_all[face] == Placed::kAcross; };
  for (const std::uint32_t face : numbers_where(of_all.size(), is_across)) add_to_strips(triangles[face]);
  extend_strips(triangles, of_all);
  const auto is_at_strip = [&](std::uint32_t face) {
    return std::ranges::any_of(triangles[face], [&](std::uint32_t v) { return place_[v] != kNoPlace; });
  };
  std::vector<std::uint32_t> at_strips = numbers_where(of_all.size(), is_at_strip);
  std::vector<std::uint32_t> part = find_parts(triangles, at_strips);
  // Where it is not planes that the mesh is made of, strips are looked at one by one.
  if (!are_mostly_in_planes(of_all, limits_.fewer)) drop_parts(triangles, of_all, at_strips, part);
  if (strip_vertices_.empty()) return;
  number_vertices(part, triangles, of_all, at_strips);
  add_faces(of_all, at_strips);
  for (const std::uint32_t vertex : strip_vertices_) {
    first_.into.push_back(place_[vertex]);
    first_.places.push_back(surface_.mesh.vertices[vertex]);
  }
  kept_.assign(strip_vertices_.size(), 0);
}

void Sharpener::add_to_strips(const Triangle& t) {
  for (const std::uint32_t corner : t) {
    if (place_[corner] != kNoPlace) continue;
    place_[corner] = static_cast<std::uint32_t>(strip_vertices_.size());
    strip_vertices_.push_back(corner);
  }
}

// Gaps are filled as a whole, with faces beside a strip that are hardly turned. Of fine tessellations most faces are
// such ones; gaps do not reach far there.
void Sharpener::extend_strips(const std::vector<Triangle>& triangles, const std::vector<Placed>& of_all) {
  constexpr int kRings = 4;
  std::vector<std::uint32_t> off =
      numbers_where(of_all.size(), [&](std::uint32_t face) { return of_all[face] == Placed::kOff; });
  for (int ring = 0; ring < kRings; ++ring) {
    const auto is_beside = [&](std::uint32_t face) {
      return std::ranges::count_if(triangles[face], [&](std::uint32_t v) { return place_[v] != kNoPlace; }) >= 2;
    };
    const auto beside =
        std::stable_partition(off.begin(), off.end(), [&](std::uint32_t face) { return !is_beside(face); });
    std::for_each(beside, off.end(), [&](std::uint32_t face) { add_to_strips(triangles[face]); });
    off.erase(beside, off.end());
  }
}

// Vertices with a face in common are of one part. Returns the part of each vertex of strips.
std::vector<std::uint32_t> Sharpener::find_parts(const std::vector<Triangle>& triangles,
                                                 const std::vector<std::uint32_t>& at_strips) {
  DisjointSets<> sets(strip_vertices_.size());
  for (const std::uint32_t face : at_strips) {
    std::uint32_t known = kNoPlace;
    for (const std::uint32_t corner : triangles[face]) {
      if (place_[corner] == kNoPlace) continue;
      if (known != kNoPlace) sets.join(known, place_[corner]);
      known = place_[corner];
    }
  }
  std::vector<std::uint32_t> part = sets.indices();
  parts_.resize(sets.count());
  for (const std::uint32_t of : part) ++parts_[of].vertices;
  return part;
}

// Drops parts where more than one of three faces is in no plane: much of what is pulled there would not pass the check.
void Sharpener::drop_parts(const std::vector<Triangle>& triangles, const std::vector<Placed>& of_all,
                           std::vector<std::uint32_t>& at_strips, std::vector<std::uint32_t>& part) {
  std::vector<std::int64_t> surplus(parts_.size(), 0);  // of faces in planes, which count half as much as others
  for (const std::uint32_t face : at_strips) {
    const auto corner = std::ranges::find_if(triangles[face], [&](std::uint32_t v) { return place_[v] != kNoPlace; });
    surplus[part[place_[*corner]]] += of_all[face] == Placed::kInPlane ? 1 : -2;
  }
  std::vector<std::uint32_t> number(parts_.size(), kNoPlace);
  std::uint32_t left = 0;
  for (std::size_t n = 0; n < parts_.size(); ++n) {
    if (surplus[n] < 0) continue;
    parts_[left] = parts_[n];
    number[n] = left++;
  }
  parts_.resize(left);
  const std::vector<std::uint32_t> vertices = std::exchange(strip_vertices_, {}), before = std::exchange(part, {});
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    place_[vertices[v]] = kNoPlace;
    if (number[before[v]] == kNoPlace) continue;
    place_[vertices[v]] = static_cast<std::uint32_t>(strip_vertices_.size());
    strip_vertices_.push_back(vertices[v]);
    part.push_back(number[before[v]]);
  }
  std::erase_if(at_strips, [&](std::uint32_t face) {
    return std::ranges::all_of(triangles[face], [&](std::uint32_t v) { return place_[v] == kNoPlace; });
  });
}

// Vertices are numbered anew, part by part, with spare ones behind those of each. Most gaps have two faces and more,
// and one corner of the mesh at most.
void Sharpener::number_vertices(const std::vector<std::uint32_t>& part, const std::vector<Triangle>& triangles,
                                const std::vector<Placed>& of_all, const std::vector<std::uint32_t>& at_strips) {
  for (const std::uint32_t face : at_strips) {
    const std::uint32_t first = place_[triangles[face][0]];
    if (of_all[face] == Placed::kAcross && first != kNoPlace) ++parts_[part[first]].spares;
  }
  for (Part& each : parts_) each.spares = each.spares / 2 + 1;
  std::vector<std::uint32_t> next;
  std::uint32_t count = 0;
  for (Part& each : parts_) {
    each.first_vertex = count;
    each.vertices += each.spares;
    next.push_back(count);
    count += each.vertices;
  }
  const std::vector<std::uint32_t> known = std::exchange(strip_vertices_, {});
  strip_vertices_.resize(count);
  part_of_.resize(count);
  const auto add = [&](std::uint32_t vertex, std::uint32_t to) {
    const std::uint32_t place = next[to]++;
    place_[vertex] = place;
    strip_vertices_[place] = vertex;
    part_of_[place] = to;
  };
  for (std::size_t v = 0; v < known.size(); ++v) add(known[v], part[v]);
  std::vector<Vec3>& vertices = surface_.mesh.vertices;
  for (std::uint32_t n = 0; n < parts_.size(); ++n) {
    for (std::uint32_t spare = 0; spare < parts_[n].spares; ++spare) {
      place_.push_back(kNoPlace);
      vertices.push_back(vertices[strip_vertices_[parts_[n].first_vertex]]);
      add(static_cast<std::uint32_t>(vertices.size() - 1), n);
    }
  }
}

// kNoPlace where it has no vertex of a strip.
std::uint32_t Sharpener::part_of_face(const Triangle& t) const {
  for (const std::uint32_t corner : t) {
    if (place_[corner] != kNoPlace) return part_of_[place_[corner]];
  }
  return kNoPlace;
}

void Sharpener::add_faces(const std::vector<Placed>& of_all, const std::vector<std::uint32_t>& at_strips) {
  for (const std::uint32_t face : at_strips) ++parts_[part_of_face(surface_.mesh.triangles[face])].faces;
  std::vector<std::uint32_t> next;
  std::uint32_t count = 0;
  for (Part& each : parts_) {
    each.first_face = count;
    each.faces += 2 * each.spares;
    next.push_back(count);
    count += each.faces;
  }
  faces_.resize(count);
  first_.triangles.assign(count, Triangle{});
  first_.sources.assign(count, kHole);
  first_.placed.assign(count, Placed::kInPlane);
  first_.hopeless.assign(count, 0);
  for (const std::uint32_t face : at_strips) {
    const std::uint32_t n = next[part_of_face(surface_.mesh.triangles[face])]++;
    faces_[n] = face;
    first_.triangles[n] = surface_.mesh.triangles[face];
    first_.sources[n] = surface_.sources[face];
    first_.placed[n] = of_all[face];
  }
  for (std::size_t part = 0; part < parts_.size(); ++part) {
    for (std::uint32_t spare = 0; spare < 2 * parts_[part].spares; ++spare) {
      faces_[next[part]++] = static_cast<std::uint32_t>(surface_.mesh.triangles.size());
      surface_.mesh.triangles.push_back({});
      surface_.sources.push_back(kHole);
    }
  }
}

void Sharpener::undo() {
  for (std::size_t v = 0; v < strip_vertices_.size(); ++v)
    surface_.mesh.vertices[strip_vertices_[v]] = first_.places[v];
  for (std::size_t n = 0; n < faces_.size(); ++n) {
    surface_.mesh.triangles[faces_[n]] = first_.triangles[n];
    surface_.sources[faces_[n]] = first_.sources[n];
  }
  surface_.mesh.vertices.resize(first_vertices_);
  surface_.mesh.triangles.resize(first_faces_);
  surface_.sources.resize(first_faces_);
}

void Sharpener::finish() { drop_gone(surface_); }

std::size_t Sharpener::pulls() const {
  return std::accumulate(parts_.begin(), parts_.end(), std::size_t{0},
                         [](std::size_t sum, const Part& part) { return sum + part.pulls; });
}

SurfaceEdit Sharpener::sharpen() {
  pull(all_parts());
  SurfaceEdit edit = all_changes();
  edit.apply(surface_.mesh);
  return edit;
}

SurfaceEdit Sharpener::all_changes() const {
  return changes_of(all_parts(), first_, std::vector<std::uint8_t>(strip_vertices_.size(), 0));
}

std::vector<std::uint32_t> Sharpener::all_parts() const {
  std::vector<std::uint32_t> all(parts_.size());
  std::iota(all.begin(), all.end(), 0U);
  return all;
}

SurfaceEdit Sharpener::keep(const std::vector<std::uint32_t>& vertices, Kept kept) {
  std::vector<std::uint8_t> named(strip_vertices_.size(), 0), anew(parts_.size(), 0);
  for (const std::uint32_t vertex : vertices) {
    if (vertex >= place_.size() || place_[vertex] == kNoPlace) continue;
    named[place_[vertex]] = 1;
    anew[part_of_[place_[vertex]]] = 1;
  }
  for (std::size_t v = 0; v < named.size(); ++v) named[v] = std::max(named[v], named[now_.into[v]]);
  std::vector<std::uint32_t> parts;
  for (std::uint32_t part = 0; part < parts_.size(); ++part) {
    if (anew[part] == 0) continue;
    if (kept != Kept::kPulledOffMesh) parts_[part].may_turn = false;
    parts.push_back(part);
  }
  // Where that changes nothing, more is kept: what has faults may not stay as it is.
  const State before = now_;
  std::vector<std::uint32_t> left = parts;
  for (int round = 1; !left.empty() && round <= kKeptFrom + 1; ++round) {
    if (round > kKeptFrom) kept = Kept::kStrips;
    for (const std::uint32_t part : left) keep_in(parts_[part], named, kept);
    pull(left);
    std::erase_if(left, [&](std::uint32_t part) { return has_changed(parts_[part], before); });
  }
  SurfaceEdit edit = changes_of(parts, before, named);
  edit.apply(surface_.mesh);
  return edit;
}

void Sharpener::keep_in(const Part& part, const std::vector<std::uint8_t>& named, Kept kept) {
  for (std::uint32_t v = part.first_vertex; v < part.first_vertex + part.vertices; ++v) {
    if (kept == Kept::kStrips) kept_[v] = kKeptFrom;
    if (named[v] != 0) kept_[v] = static_cast<std::uint8_t>(std::min<int>(kept_[v] + 1, kKeptFrom));
  }
}

bool Sharpener::has_changed(const Part& part, const State& before) const {
  for (std::uint32_t v = part.first_vertex; v < part.first_vertex + part.vertices; ++v) {
    if (before.places[v] != now_.places[v]) return true;
  }
  for (std::uint32_t face = part.first_face; face < part.first_face + part.faces; ++face) {
    if (before.triangles[face] != now_.triangles[face]) return true;
  }
  return false;
}

void Sharpener::pull(const std::vector<std::uint32_t>& parts) {
  parallel_for_each(parts.size(), [&](std::size_t n) {
    Part& part = parts_[parts[n]];
    part.pulls = StripPulls(*this, part, now_).pull_all();
    for (std::uint32_t face = part.first_face; face < part.first_face + part.faces; ++face)
      surface_.sources[faces_[face]] = now_.sources[face];
  });
}

// With the faces at `named` vertices, whether they have changed or not.
SurfaceEdit Sharpener::changes_of(const std::vector<std::uint32_t>& parts, const State& before,
                                  const std::vector<std::uint8_t>& named) const {
  SurfaceEdit edit;
  const auto has_moved = [&](std::uint32_t corner) {
    const std::uint32_t place = place_[corner];
    return place != kNoPlace && (before.places[place] != now_.places[place] || named[place] != 0);
  };
  for (const std::uint32_t n : parts) {
    const Part& part = parts_[n];
    for (std::uint32_t v = part.first_vertex; v < part.first_vertex + part.vertices; ++v) {
      if (before.places[v] == now_.places[v]) continue;
      edit.vertices.push_back(strip_vertices_[v]);
      edit.places.push_back({before.places[v], now_.places[v]});
    }
    for (std::uint32_t face = part.first_face; face < part.first_face + part.faces; ++face) {
      const Triangle &was = before.triangles[face], &is = now_.triangles[face];
      if (was == is && (is_gone(is) || std::ranges::none_of(is, has_moved))) continue;
      edit.faces.push_back(faces_[face]);
      edit.corners.push_back({was, is});
    }
  }
  return edit;
}

}  // namespace raycone
