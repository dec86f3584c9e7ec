// Flat parts of a surface merged brick by brick.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/data/vec3.h"
#include "core/merging/patch_merger.h"
#include "core/merging/surface_bricks.h"

namespace raycone {

// What faces and vertices of a surface have become so far.
struct MergeState {
  std::vector<Triangle>& triangles;  // those that are gone have three equal corners
  const std::vector<std::int32_t>& sources;
  std::vector<std::uint32_t>& into;    // of each vertex, what it was pulled into; itself, where it stayed
  std::vector<std::uint8_t>& settled;  // of each vertex, what PatchMerger::is_settled() said
};

// Merges the faces of each brick by itself. The same for any number of threads: bricks change their own faces only, and
// where their own vertices are pulled. Uses the threads that ThreadLimit allows.
class BrickMerger {
 public:
  // Vertices of `kept` stay; `input`: what sources are numbers of. All of them must stay while this lives.
  BrickMerger(const std::vector<Vec3>& vertices, const TriangleMesh& input, const std::vector<bool>& kept,
              const MergeLimits& limits, MergeState state)
      : vertices_(vertices), input_(input), kept_(kept), limits_(limits), state_(state) {}

  void merge_all(const SurfaceBricks& bricks);

  // Merges the bricks that have a 0 in `known`. Adds to the brick's `changed` its vertices that other bricks share and
  // that have other faces in it now. Both lists have one element per brick.
  void merge_unknown(const SurfaceBricks& bricks, const std::vector<std::uint8_t>& known,
                     std::vector<std::vector<std::uint32_t>>& changed);

  // Merges anew the bricks that own a vertex of `changed`, from the triangles of `first` on; the result is that of
  // merge_all(). Whether a vertex is kept matters to no brick but the one that owns it.
  void merge_again(const SurfaceBricks& bricks, const std::vector<std::uint32_t>& changed,
                   const std::vector<Triangle>& first);

 private:
  void merge_those(const SurfaceBricks& bricks, const std::vector<std::uint32_t>& asked,
                   std::vector<std::vector<std::uint32_t>>* changed);
  void merge_one(const SurfaceBricks& bricks, std::uint32_t brick, std::vector<std::uint32_t>* changed);
  [[nodiscard]] std::vector<std::uint32_t> vertices_of(const SurfaceBricks& bricks, std::uint32_t brick);
  [[nodiscard]] SurfacePatch patch_of(const SurfaceBricks& bricks, std::uint32_t brick,
                                      const std::vector<std::uint32_t>& global);

  const std::vector<Vec3>& vertices_;
  const TriangleMesh& input_;
  const std::vector<bool>& kept_;
  MergeLimits limits_;
  MergeState state_;
  std::vector<std::uint32_t> local_;  // numbers of vertices in the bricks that have all of their faces
};

}  // namespace raycone
