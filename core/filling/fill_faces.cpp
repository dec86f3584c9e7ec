#include "core/filling/fill_faces.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "core/cells/surface_mesh.h"

namespace raycone {
namespace {

// At a corner, between two others.
double cotangent(const Vec3& corner, const Vec3& a, const Vec3& b) {
  return dot(a - corner, b - corner) / norm(cross(a - corner, b - corner));
}

Vec3 normal_of(const Vec3& a, const Vec3& b, const Vec3& c) { return cross(b - a, c - a); }

}  // namespace

FillFaces::FillFaces(SurfaceMesh& surface) : surface_(surface) {
  std::vector<Triangle>& triangles = surface.mesh.triangles;
  std::vector<bool> is_used(surface.mesh.vertices.size(), false);  // by faces without source
  std::size_t others = 0;
  for (std::size_t face = 0; face < triangles.size(); ++face) {
    if (surface.sources[face] == kHole) {
      add_face(triangles[face]);
      for (const std::uint32_t corner : triangles[face]) is_used[corner] = true;
      add_edges_of(triangles[face]);
    } else {
      surface.sources[others] = surface.sources[face];
      triangles[others++] = triangles[face];
    }
  }
  triangles.resize(others);
  surface.sources.resize(others);
  for (const Triangle& t : triangles) {
    if (is_used[t[0]] + is_used[t[1]] + is_used[t[2]] > 1) add_edges_of(t);
  }
  update_edges();
}

void FillFaces::put_back() {
  surface_.mesh.triangles.insert(surface_.mesh.triangles.end(), faces_.begin(), faces_.end());
  surface_.sources.resize(surface_.mesh.triangles.size(), kHole);
  faces_.clear();
  changed_.clear();
  sides_.clear();
  inner_.clear();
}

TriangleMesh FillFaces::mesh() const {
  TriangleMesh whole = surface_.mesh;
  whole.triangles.insert(whole.triangles.end(), faces_.begin(), faces_.end());
  return whole;
}

Vec3 FillFaces::middle(std::uint32_t face) const {
  const auto [a, b, c] = faces_[face];
  return (1.0 / 3.0) * (at(a) + at(b) + at(c));
}

Vec3 FillFaces::normal(std::uint32_t face) const {
  const auto [a, b, c] = faces_[face];
  return normal_of(at(a), at(b), at(c));
}

double FillFaces::longest_side(std::uint32_t face) const {
  const auto [a, b, c] = faces_[face];
  return std::max({norm(at(b) - at(a)), norm(at(c) - at(b)), norm(at(a) - at(c))});
}

double FillFaces::length(const InnerEdge& edge) const { return norm(at(edge.to) - at(edge.from)); }

std::pair<std::uint32_t, std::uint32_t> FillFaces::faces_of(const Part& part) const {
  if (part.edge == kNone) return {part.face, part.face};
  return {inner_[part.edge].left, inner_[part.edge].right};
}

void FillFaces::add_edges_of(const Triangle& t) {
  for (std::size_t n = 0; n < 3; ++n) {
    const std::uint32_t a = t[n], b = t[(n + 1) % 3];
    edges_.insert({std::min(a, b), std::max(a, b)});
  }
}

std::uint32_t FillFaces::add_face(const Triangle& t) {
  changed_.push_back(size());
  faces_.push_back(t);
  return size() - 1;
}

void FillFaces::change(std::uint32_t face, const Triangle& t) {
  changed_.push_back(face);
  faces_[face] = t;
}

void FillFaces::divide(const Part& part, const Vec3& p) {
  const auto vertex = static_cast<std::uint32_t>(surface_.mesh.vertices.size());
  surface_.mesh.vertices.push_back(p);
  const auto replace = [&](std::uint32_t face, std::uint32_t gone) {
    Triangle t = faces_[face];
    std::ranges::replace(t, gone, vertex);
    change(face, t);
    add_edges_of(t);
  };
  const auto copy = [&](std::uint32_t face) { return add_face(Triangle{faces_[face]}); };
  if (part.edge == kNone) {
    const Triangle corners = faces_[part.face];
    const std::array faces{part.face, copy(part.face), copy(part.face)};
    for (std::size_t n = 0; n < 3; ++n) replace(faces[n], corners[n]);
    return;
  }
  const InnerEdge& edge = inner_[part.edge];
  for (const std::uint32_t face : {edge.left, edge.right}) {
    replace(copy(face), edge.from);
    replace(face, edge.to);
  }
}

void FillFaces::add_octahedron(const std::array<Vec3, 6>& tips, Fronts fronts) {
  const auto first = static_cast<std::uint32_t>(surface_.mesh.vertices.size());
  surface_.mesh.vertices.insert(surface_.mesh.vertices.end(), tips.begin(), tips.end());
  for (std::uint32_t octant = 0; octant < 8; ++octant) {
    const std::uint32_t x = octant & 1U, y = octant >> 1U & 1U, z = octant >> 2U;
    Triangle face{first + x, first + 2 + y, first + 4 + z};
    if ((x ^ y ^ z ^ static_cast<std::uint32_t>(fronts == Fronts::kOutward)) != 0) std::swap(face[1], face[2]);
    add_face(face);
    add_edges_of(face);
  }
}

// Sorts those of faces that have changed alone: mostly these are few.
void FillFaces::update_sides() {
  std::vector<bool> is_old(faces_.size(), true);
  std::vector<Side> others;
  for (const std::uint32_t face : changed_) {
    if (!is_old[face]) continue;
    is_old[face] = false;
    for (std::size_t n = 0; n < 3; ++n) {
      const std::uint32_t a = faces_[face][n], b = faces_[face][(n + 1) % 3];
      others.push_back({std::min(a, b), std::max(a, b), face, a < b});
    }
  }
  changed_.clear();
  std::erase_if(sides_, [&](const Side& s) { return !is_old[s.face]; });
  const auto place = [](const Side& s) { return std::tuple(s.low, s.high, s.face); };
  std::ranges::sort(others, {}, place);
  std::vector<Side> all(sides_.size() + others.size());
  std::ranges::merge(sides_, others, all.begin(), {}, place, place);
  sides_ = std::move(all);
}

// An edge of more than two faces, or of two in one direction, is none of them.
void FillFaces::update_edges() {
  update_sides();
  inner_.clear();
  for (std::size_t begin = 0, end = 0; begin < sides_.size(); begin = end) {
    while (end < sides_.size() && sides_[end].edge() == sides_[begin].edge()) ++end;
    const Side &one = sides_[begin], &other = sides_[end - 1];
    if (end - begin != 2 || one.is_up == other.is_up) continue;
    inner_.push_back({one.low, one.high, one.is_up ? one.face : other.face, one.is_up ? other.face : one.face});
  }
}

std::vector<std::uint32_t> FillFaces::flip_edges() {
  constexpr int kMostPasses = 32;  // some are enough; what does not lie in one plane might go on for long
  std::vector<std::uint32_t> changed;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const std::size_t before = changed.size();
    std::vector<bool> is_taken(faces_.size(), false);
    for (const InnerEdge& edge : inner_) {
      if (is_taken[edge.left] || is_taken[edge.right] || !flip(edge)) continue;
      is_taken[edge.left] = is_taken[edge.right] = true;
      changed.insert(changed.end(), {edge.left, edge.right});
    }
    if (changed.size() == before) break;
    update_edges();
  }
  return changed;
}

// The corner of a face that is not an end of the edge.
std::uint32_t FillFaces::beyond(std::uint32_t face, const InnerEdge& edge) const {
  const auto [a, b, c] = faces_[face];
  return a ^ b ^ c ^ edge.from ^ edge.to;
}

bool FillFaces::flip(const InnerEdge& edge) {
  constexpr double kBetter = -1e-6;  // more than the sum of cotangents of a square rounds
  const std::uint32_t one = beyond(edge.left, edge), other = beyond(edge.right, edge);
  const Vec3 &from = at(edge.from), &to = at(edge.to), &a = at(one), &b = at(other);
  if (!(cotangent(a, from, to) + cotangent(b, from, to) < kBetter)) return false;
  const Vec3 front = normal(edge.left) + normal(edge.right);
  if (!(dot(front, normal_of(from, b, a)) > 0.0 && dot(front, normal_of(b, to, a)) > 0.0)) return false;
  if (!edges_.insert({std::min(one, other), std::max(one, other)}).second) return false;
  change(edge.left, {edge.from, other, one});
  change(edge.right, {other, edge.to, one});
  return true;
}

}  // namespace raycone
