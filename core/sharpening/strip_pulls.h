// Strips of a surface that lead across sharp edges, pulled together and filled.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "core/cells/source_plane.h"
#include "core/sharpening/fill_gap.h"
#include "core/sharpening/gap.h"
#include "core/sharpening/sharpen.h"

namespace raycone {

// Strips that hang together. Faces have their places among those of all strips; vertices are those of the surface.
class StripPulls {
 public:
  // All three must outlive this. Puts the part's state back to what it was at first.
  StripPulls(const Sharpener& all, const Sharpener::Part& part, Sharpener::State& state);

  // Returns how many vertices were pulled and gaps filled, added up.
  std::size_t pull_all();

  // For gap.h.
  [[nodiscard]] const Triangle& triangle(std::uint32_t face) const { return state_.triangles[face]; }
  [[nodiscard]] std::int32_t source(std::uint32_t face) const { return state_.sources[face]; }
  [[nodiscard]] const Vec3& position(std::uint32_t vertex) const {
    return place(vertex) == Sharpener::kNoPlace ? all_.surface_.mesh.vertices[vertex] : state_.places[place(vertex)];
  }
  [[nodiscard]] std::uint32_t face_with(std::uint32_t from, std::uint32_t to) const;

 private:
  using Place = std::array<double, 3>;
  using Edge = std::tuple<double, Place, Place, std::uint32_t, std::uint32_t>;  // square of the length, ends
  using Faces = std::vector<std::uint32_t>;

  [[nodiscard]] std::uint32_t place(std::uint32_t vertex) const { return all_.place_[vertex]; }
  [[nodiscard]] std::uint32_t last_of(std::uint32_t vertex) const {
    std::uint32_t at = place(vertex);
    while (state_.into[at] != at) at = state_.into[at];
    return all_.strip_vertices_[at];
  }

  // Faces in no plane that hang together by sides.
  struct Gap {
    Faces faces;  // increasing
    Faces loop;   // the vertices of its border
    Faces free;   // its other vertices
    std::optional<GapFill> filled;
  };
  std::size_t fill_gaps();
  [[nodiscard]] bool is_hopeless(const Faces& gap);
  void find_fill(Gap& gap) const;
  bool fill(const Gap& gap);
  void replace(const Faces& gap, const Faces& loop, const GapFill& filled);
  [[nodiscard]] bool is_off(std::uint32_t face) const { return state_.placed[face] != Placed::kInPlane; }

  [[nodiscard]] std::vector<Edge> edges_of_strips();
  [[nodiscard]] int& changed_in(std::uint32_t vertex) { return changed_in_[place(vertex) - part_.first_vertex]; }
  [[nodiscard]] bool may_have_changed(std::uint32_t vertex) { return changed_in(vertex) >= pass_ - 1; }
  [[nodiscard]] std::uint8_t& gone(std::uint32_t face) { return gone_[face - part_.first_face]; }
  bool pull(std::uint32_t u, std::uint32_t v);
  void join(std::uint32_t u, std::uint32_t v);
  [[nodiscard]] bool is_link_sound(std::uint32_t u, std::uint32_t v) const;
  [[nodiscard]] std::optional<Vec3> place_for(std::uint32_t u, std::uint32_t v);
  [[nodiscard]] bool are_all_on_mesh(std::span<const Vec3> points) const;
  [[nodiscard]] bool keeps_fronts(std::uint32_t vertex, std::uint32_t other, const Vec3& place) const;
  [[nodiscard]] bool add_plane(std::uint32_t face, std::vector<SourcePlane>& planes) const;

  [[nodiscard]] Faces& faces(std::uint32_t vertex) { return faces_[place(vertex) - part_.first_vertex]; }
  [[nodiscard]] const Faces& faces(std::uint32_t vertex) const { return faces_[place(vertex) - part_.first_vertex]; }
  [[nodiscard]] bool has(std::uint32_t face, std::uint32_t vertex) const {
    const Triangle& t = state_.triangles[face];
    return t[0] == vertex || t[1] == vertex || t[2] == vertex;
  }

  const Sharpener& all_;
  const Sharpener::Part& part_;
  Sharpener::State& state_;
  std::vector<std::uint8_t> gone_;                         // of each face
  std::vector<std::uint32_t> across_;                      // faces that lead across, and are not gone
  std::vector<Faces> faces_;                               // of each vertex
  std::vector<int> changed_in_;                            // likewise, the last pass that changed one of its faces
  std::vector<std::uint32_t> free_vertices_, free_faces_;  // that no face uses, and that are gone
  int pass_ = 0;
};

}  // namespace raycone
