// The faces of a surface that close holes, while they are divided.
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "core/cells/surface_mesh.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// The faces of a surface without source, taken out of it until put_back(). Edges that they share with other faces stay
// as they are. An edge between two of them is an inner edge, and may change. Not thread-safe.
class FillFaces {
 public:
  static constexpr std::uint32_t kNone = UINT32_MAX;

  // Face `left` runs along the edge from -> to, face `right` the other way.
  struct InnerEdge {
    std::uint32_t from, to, left, right;
  };
  // What may be divided: an inner edge, by its place in inner_edges(); or a whole face where `edge` is kNone.
  struct Part {
    std::uint32_t face, edge = kNone;
  };

  // `surface` must outlive this, and nobody else may change it until put_back().
  explicit FillFaces(SurfaceMesh& surface);
  void put_back();  // after the other faces; call nothing after it

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(faces_.size()); }
  [[nodiscard]] const Triangle& operator[](std::uint32_t face) const { return faces_[face]; }
  [[nodiscard]] const Vec3& at(std::uint32_t vertex) const { return surface_.mesh.vertices[vertex]; }
  [[nodiscard]] const std::vector<InnerEdge>& inner_edges() const { return inner_; }
  // The surface as a whole.
  [[nodiscard]] TriangleMesh mesh() const;

  [[nodiscard]] Vec3 middle(std::uint32_t face) const;
  [[nodiscard]] Vec3 normal(std::uint32_t face) const;  // twice the area long
  [[nodiscard]] double longest_side(std::uint32_t face) const;
  [[nodiscard]] double length(const InnerEdge& edge) const;
  // The two faces that a division would change; twice the same one where the part is a face.
  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> faces_of(const Part& part) const;

  // Gives a part a vertex at `p`. The two faces at an edge become four, a whole face three: some of them take the old
  // numbers, the others come last. Until update_edges(), inner_edges() stay as they were, and no face may be changed
  // twice.
  void divide(const Part& part, const Vec3& p);
  void update_edges();

  enum class Fronts : std::uint8_t { kOutward, kInward };
  // Adds an octahedron with these tips: below and above a point along x, then along y, then along z. Until
  // update_edges(), inner_edges() stay as they were.
  void add_octahedron(const std::array<Vec3, 6>& tips, Fronts fronts);

  // Flips inner edges whose opposite angles sum up to more than 180 degrees (Delaunay): not where that would turn a
  // face over, and not to an edge that is there or was there before. Returns the faces that have changed. Ends with
  // update_edges().
  std::vector<std::uint32_t> flip_edges();

 private:
  using Edge = std::pair<std::uint32_t, std::uint32_t>;  // the smaller vertex first
  // One of the three sides of a face.
  struct Side {
    std::uint32_t low, high, face;  // vertices
    bool is_up;                     // from low to high
    [[nodiscard]] Edge edge() const { return {low, high}; }
  };

  std::uint32_t add_face(const Triangle& t);
  void change(std::uint32_t face, const Triangle& t);
  void update_sides();
  void add_edges_of(const Triangle& t);
  [[nodiscard]] std::uint32_t beyond(std::uint32_t face, const InnerEdge& edge) const;
  bool flip(const InnerEdge& edge);

  SurfaceMesh& surface_;
  std::vector<Triangle> faces_;
  std::vector<std::uint32_t> changed_;  // faces, some of them twice, since update_edges()
  std::vector<Side> sides_;             // by edge, then by face
  std::vector<InnerEdge> inner_;
  std::set<Edge> edges_;  // all that ever were, also of other faces nearby
};

}  // namespace raycone
