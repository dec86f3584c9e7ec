// Sharp edges where a lattice does not see them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/cells/surface_mesh.h"
#include "core/cells/triangle_normals.h"
#include "core/certificate/surface_edit.h"
#include "core/data/coordinate_precision.h"
#include "core/data/triangle_mesh.h"
#include "core/distance/distance.h"
#include "core/sharpening/face_placement.h"

namespace raycone {

// The mesh that a surface is of.
struct SharpenInput {
  const TriangleMesh& mesh;
  const TriangleNormals& normals;     // of its triangles
  const DistanceEvaluator& distance;  // from it
};

struct SharpenLimits {
  double off = 0.0;    // a face is in its source's plane if its corners are no farther off, world units
  double reach = 0.0;  // how far a vertex is pulled at most, world units
  CoordinatePrecision precision = CoordinatePrecision::kDouble;  // of vertices
  std::uint64_t fewer = 0;                                       // faces in planes than there would be without polygons
};

// Where a sharp edge passes between outside nodes, contour() cuts it off: a strip of faces runs from a plane of the
// mesh to another one, or to several at a corner, and lies in none of them. Here, each two neighbours on different
// sides of such a strip become one vertex where their planes meet, if that is a point of the mesh. Faces in planes of
// the mesh stay in them and keep their fronts; what is left of strips between them vanishes. Where fewer than three of
// four faces are in planes, strips are judged one by one: those with too many faces in no plane stay as they are.
// Whether faces intersect afterwards, or nodes have changed sides, is not checked. Uses the threads that ThreadLimit
// allows; the same for any number of them. Needs DefaultFloatingPoint.
class Sharpener {
 public:
  // Adds spare vertices and faces to the surface, which count as gone at first. Precondition: sources are triangles of
  // the input, or kHole. Surface, mesh and distance must outlive this, and nobody else may change them.
  Sharpener(SurfaceMesh& surface, const SharpenInput& input, const SharpenLimits& limits);
  Sharpener(const Sharpener&) = delete;
  Sharpener& operator=(const Sharpener&) = delete;

  // Pulls vertices, and returns what that has changed. What is left of strips may turn over on the way, and may then
  // cross other faces.
  SurfaceEdit sharpen();
  // What keep() leaves where it was: the vertices named and those that were pulled into them; the same, where nothing
  // is wrong but that a face has left the mesh; or all vertices of the strips that hang together with those named.
  enum class Kept { kPulled, kPulledOffMesh, kStrips };
  // Changes the surface to what it is if the vertices at `vertices` are not pulled. Strips that hang together with them
  // are pulled anew; their faces may then not turn over, but for kPulledOffMesh. Numbers of vertices that are of no
  // strip are ignored. Returns what has changed, with all faces at `vertices`, so that faults there are looked for
  // again.
  SurfaceEdit keep(const std::vector<std::uint32_t>& vertices, Kept kept);

  // What has been changed of the surface as it was at first.
  [[nodiscard]] SurfaceEdit all_changes() const;

  // Call undo() or finish() last. Back to the surface as it was at first, without spare vertices and faces.
  void undo();
  // Drops faces that are gone, and vertices that no face has.
  void finish();

  [[nodiscard]] std::size_t pulls() const;
  // Calls visit(vertex, place) for each vertex of a strip that has not been pulled into another. `place`: where it is
  // now.
  template <class Visit>
  void for_each_target(const Visit& visit) const {
    for (std::uint32_t n = 0; n < strip_vertices_.size(); ++n) {
      if (now_.into[n] == n) visit(strip_vertices_[n], now_.places[n]);
    }
  }

 private:
  friend class StripPulls;
  static constexpr std::uint32_t kNoPlace = UINT32_MAX;
  static constexpr std::uint8_t kKeptFrom = 2;  // at faults once, vertices are not pulled; twice, gaps are left, too
  struct State {
    std::vector<Triangle> triangles;     // of the faces at strips; those that are gone have three equal corners
    std::vector<std::int32_t> sources;   // likewise
    std::vector<Placed> placed;          // likewise
    std::vector<std::uint8_t> hopeless;  // of each first face of a gap, whether that could not be filled
    std::vector<Vec3> places;            // of the vertices of strips
    std::vector<std::uint32_t> into;     // likewise, by their places
  };
  // Strips that hang together: pulls see nothing of others. Its faces and vertices follow each other.
  struct Part {
    std::uint32_t first_vertex = 0, vertices = 0, first_face = 0, faces = 0;
    std::uint32_t spares = 0;  // its last vertices, and half as many as there are spare faces
    std::size_t pulls = 0;
    bool may_turn = true;
  };

  void find_strips(const std::vector<Placed>& of_all);
  void add_to_strips(const Triangle& t);
  void extend_strips(const std::vector<Triangle>& triangles, const std::vector<Placed>& of_all);
  std::vector<std::uint32_t> find_parts(const std::vector<Triangle>& triangles,
                                        const std::vector<std::uint32_t>& at_strips);
  void drop_parts(const std::vector<Triangle>& triangles, const std::vector<Placed>& of_all,
                  std::vector<std::uint32_t>& at_strips, std::vector<std::uint32_t>& part);
  void number_vertices(const std::vector<std::uint32_t>& part, const std::vector<Triangle>& triangles,
                       const std::vector<Placed>& of_all, const std::vector<std::uint32_t>& at_strips);
  void add_faces(const std::vector<Placed>& of_all, const std::vector<std::uint32_t>& at_strips);
  [[nodiscard]] std::uint32_t part_of_face(const Triangle& t) const;
  [[nodiscard]] std::vector<std::uint32_t> all_parts() const;
  void pull(const std::vector<std::uint32_t>& parts);
  void keep_in(const Part& part, const std::vector<std::uint8_t>& named, Kept kept);
  [[nodiscard]] bool has_changed(const Part& part, const State& before) const;
  [[nodiscard]] SurfaceEdit changes_of(const std::vector<std::uint32_t>& parts, const State& before,
                                       const std::vector<std::uint8_t>& named) const;

  SurfaceMesh& surface_;                      // at strips as now_ has it; elsewhere as it was
  std::size_t first_vertices_, first_faces_;  // how many there are without spare ones
  const TriangleMesh& input_;
  const DistanceEvaluator& distance_;
  SharpenLimits limits_;
  std::vector<std::uint32_t> place_;  // of each vertex among strip_vertices_, or kNoPlace
  std::vector<std::uint32_t> strip_vertices_;
  std::vector<std::uint8_t> kept_;      // of each of these
  std::vector<std::uint32_t> part_of_;  // likewise
  std::vector<Part> parts_;
  std::vector<std::uint32_t> faces_;  // with a vertex of a strip
  State first_, now_;
};

}  // namespace raycone
