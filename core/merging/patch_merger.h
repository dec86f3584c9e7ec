// Pulls vertices of a piece of a surface into neighbours in the same planes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/merging/patch_planes.h"

namespace raycone {

enum class VertexRole : std::uint8_t {
  kFree,
  kKept,     // is not pulled
  kForeign,  // nor is any pulled into it: it has faces outside of the patch, or is at a node with a vertex that has
};

// A piece of a surface, with numbers of vertices of its own. Faces around a vertex that is not foreign close up to one
// fan.
struct SurfacePatch {
  std::vector<Vec3> vertices;
  std::vector<VertexRole> roles;
  std::vector<std::uint8_t> settled;  // whether an earlier PatchMerger said so, and nothing has changed there since
  std::vector<Triangle> triangles;
  std::vector<std::int32_t> sources;
};

// How far merging may go, world units.
struct MergeLimits {
  double most = 0.0;    // how far a point may be off a plane that it is in
  double needle = 0.0;  // triangles lower than this are ignored where a vertex moves by less
};

class PatchMerger {
 public:
  static constexpr std::size_t kMostFaces = 0x3FFFFFFF;  // their corners have numbers of 32 bits

  // `input`: what sources are numbers of. `patch` and `input` must outlive this, and stay as they are. Precondition: at
  // most kMostFaces.
  PatchMerger(const SurfacePatch& patch, const TriangleMesh& input, const MergeLimits& limits);

  // Pulls what can be pulled. Call it once.
  void merge();

  // After that: one of the patch's faces, {0, 0, 0} if it is gone, and of each vertex the one that it was pulled into,
  // itself where it stayed.
  [[nodiscard]] const Triangle& triangle(std::size_t face) const { return faces_[face].corners; }
  [[nodiscard]] const std::vector<std::uint32_t>& into() const { return into_; }

  // Whether a vertex of the patch that is still there would stay in any other patch, too, as long as the faces around
  // it are these.
  [[nodiscard]] bool is_settled(std::uint32_t v) const;

  // Whether the faces around a vertex are others than at first.
  [[nodiscard]] bool has_changed(std::uint32_t v) const { return touched_[v] != 0; }

 private:
  enum class State : std::uint8_t {
    kWaits,    // to be looked at
    kNext,     // in the next pass
    kStays,    // until something changes around it
    kSettled,  // so it did in an earlier patch
    kFixed,    // for ever
    kGone,
  };

  // Of a face: four times its number, and the place of the vertex in it.
  using Corner = std::uint32_t;
  static constexpr Corner kNoCorner = 0xFFFFFFFF;
  static constexpr Corner corner_of(std::uint32_t face, std::uint32_t place) { return 4 * face + place; }
  static constexpr std::uint32_t face_of(Corner corner) { return corner / 4; }
  static constexpr std::uint32_t place_of(Corner corner) { return corner % 4; }

  // All that walks around vertices ask of a face, in one line of the cache.
  struct alignas(32) Face {
    Triangle corners;
    std::uint32_t plane = PatchPlanes::kNoPlane;  // none before somebody asks
    std::array<Corner, 3> next;                   // corners behind its own in the chains of their vertices
    bool is_needle = false, is_hole = false, is_changed = false;
  };

  // At a vertex; the other corners, in order.
  struct StarFace {
    std::uint32_t plane, next, last;
    bool is_needle, is_hole;
  };
  enum class Needles : std::uint8_t { kLeftOut, kCounted };

  using Target = std::optional<std::uint32_t> (PatchMerger::*)(std::uint32_t);
  void pull_all(Target target_of);
  void pull(std::uint32_t v, std::uint32_t target);
  void unlink(Corner corner, std::uint32_t vertex);
  [[nodiscard]] Corner& next_of(Corner corner) { return faces_[face_of(corner)].next[place_of(corner)]; }

  void spread(VertexRole role);
  [[nodiscard]] std::uint32_t plane_of(std::uint32_t face);
  [[nodiscard]] std::uint32_t plane_at(std::uint32_t face);
  [[nodiscard]] bool is_needle(std::uint32_t face) const;
  [[nodiscard]] bool is_at_needle(std::uint32_t v) const;
  [[nodiscard]] std::optional<std::uint32_t> target_at_node(std::uint32_t v);
  [[nodiscard]] std::optional<std::uint32_t> best_target(std::uint32_t v);
  [[nodiscard]] double distance(std::uint32_t v, std::uint32_t w) const;
  [[nodiscard]] bool is_at_node(std::uint32_t v, std::uint32_t w) const;
  [[nodiscard]] std::vector<std::uint32_t> faces_at_node(std::uint32_t v) const;
  [[nodiscard]] std::ptrdiff_t planes_through(std::uint32_t v, const std::vector<std::uint32_t>& faces);

  [[nodiscard]] const Vec3& position(std::uint32_t v) const { return patch_.vertices[v]; }

  // Calls visit(face, next, last) for each face at v: its corners are v, next, last. As long as that returns true.
  template <class Visit>
  void for_each_face(std::uint32_t v, const Visit& visit) const;

  // What the next ones look at: the faces around `v`, and their planes.
  void find_star(std::uint32_t v);
  void sort_ring();
  void find_planes(Needles needles);
  [[nodiscard]] bool is_in_planes(const Vec3& p) const;
  [[nodiscard]] double worst_shape(std::uint32_t target, Needles needles, double needed) const;
  [[nodiscard]] bool may_have_rim() const;
  [[nodiscard]] std::vector<std::uint32_t> rim_neighbours() const;
  [[nodiscard]] bool keeps_rim(std::uint32_t v, std::uint32_t target, const std::vector<std::uint32_t>& rim) const;
  [[nodiscard]] bool keeps_topology(std::uint32_t target);

  const SurfacePatch& patch_;
  MergeLimits limits_;
  std::vector<VertexRole> roles_;
  std::vector<Face> faces_;
  PatchPlanes planes_;
  std::vector<Corner> first_;  // of each vertex; its other corners follow in a chain
  std::vector<State> state_;
  std::vector<std::uint8_t> touched_;      // vertices: their faces are others than at first
  std::vector<std::uint8_t> by_geometry_;  // when last looked at, no neighbour was fit, whatever is around that
  std::vector<std::uint32_t> into_;
  std::vector<StarFace> star_;         // of the vertex that is looked at
  std::vector<std::uint32_t> around_;  // its planes, with or without those of needles, each once
  std::vector<std::uint32_t> ring_;    // its neighbours, increasing
  std::vector<std::uint32_t> unsorted_;
  std::vector<std::uint32_t> marked_;  // of each vertex, the number of the last mark it got
  std::uint32_t marks_ = 0;
};

}  // namespace raycone
