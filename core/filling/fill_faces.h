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

// The faces without source of a surface, taken out of it until put_back(). Their edges that other faces have, too, stay
// as they are; what is between two of them is an inner edge, and may change. Not thread-safe.
class FillFaces {
 public:
  static constexpr std::uint32_t kNone = UINT32_MAX;

  // `left` has from -> to, `right` the other way round.
  struct InnerEdge {
    std::uint32_t from, to, left, right;
  };
  // What may be divided: an inner edge, given by its number, or a face as a whole where that is kNone.
  struct Part {
    std::uint32_t face, edge = kNone;
  };

  // `surface` must stay, and nobody else may change it until put_back().
  explicit FillFaces(SurfaceMesh& surface);
  void put_back();  // behind the others

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
  // The faces that a division would change; twice the same of a face as a whole.
  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> faces_of(const Part& part) const;

  // Gives a part a vertex at `p`: two faces at an edge become four, a face as a whole three. The old numbers are those
  // of some of them, new ones come behind. inner_edges() stay what they were, and a face may be changed once, until
  // update_edges().
  void divide(const Part& part, const Vec3& p);
  void update_edges();

  enum class Fronts : std::uint8_t { kOutward, kInward };
  // Adds an octahedron, whose tips are below and above a point along x, then y, then z. inner_edges() stay what they
  // were until update_edges().
  void add_octahedron(const std::array<Vec3, 6>& tips, Fronts fronts);

  // Flips inner edges whose opposite angles sum up to more than 180 degrees (Delaunay), where faces do not turn over by
  // that, and no edge comes twice, or again. Returns the faces that have changed. Ends with update_edges().
  std::vector<std::uint32_t> flip_edges();

 private:
  using Edge = std::pair<std::uint32_t, std::uint32_t>;  // the smaller vertex first
  // One of the three of a face.
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
