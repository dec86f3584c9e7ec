#include "core/orientation/mesh_defects.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <iterator>
#include <span>
#include <utility>

#include "core/data/box.h"
#include "core/exact/volume_sign.h"
#include "core/machine/floating_point.h"
#include "core/machine/threads.h"
#include "core/mesh/components.h"
#include "core/mesh/disjoint_sets.h"
#include "core/mesh/face_edges.h"
#include "core/mesh/opposite_faces.h"
#include "core/orientation/box_pairs.h"
#include "core/orientation/closed_components.h"
#include "core/orientation/nesting.h"

namespace raycone {
namespace {

// Such an edge counts twice in the boundary, so that most meshes need no look at their triangles.
std::uint64_t count_inconsistent_edges(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges) {
  struct DoubleEdge {
    std::uint32_t low, high;
    std::uint64_t uses = 0;
  };
  std::vector<DoubleEdge> doubles;
  for (const ExteriorEdge& e : edges) {
    if (std::abs(e.multiplicity) == 2) doubles.push_back({std::min(e.from, e.to), std::max(e.from, e.to)});
  }
  if (doubles.empty()) return 0;
  const auto ends = [](const DoubleEdge& e) { return std::pair(e.low, e.high); };
  std::ranges::sort(doubles, {}, ends);
  std::vector<bool> at_one(mesh.vertices.size(), false);
  for (const DoubleEdge& e : doubles) at_one[e.low] = at_one[e.high] = true;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t from = t[corner], to = t[corner < 2 ? corner + 1 : 0];
      if (!at_one[from] || !at_one[to]) continue;
      const auto edge = std::pair(std::min(from, to), std::max(from, to));
      const auto it = std::ranges::lower_bound(doubles, edge, {}, ends);
      if (it != doubles.end() && ends(*it) == edge) ++it->uses;
    }
  }
  return static_cast<std::uint64_t>(std::ranges::count(doubles, 2U, &DoubleEdge::uses));
}

// Closed components of negative volume that lie within no other one.
class ReversedComponents {
 public:
  ReversedComponents(const TriangleMesh& mesh, const Components& components, const ClosedComponents& closed)
      : mesh_(mesh), components_(components), closed_(closed) {}

  [[nodiscard]] std::uint64_t count() const {
    const std::uint64_t negative = closed_.count_negative();
    if (negative == 0 || components_.count == 1) return negative;
    std::vector<Part> parts = closed_components();
    const std::vector<std::uint32_t> outermost = outermost_negative(parts);
    if (outermost.empty()) return 0;
    const std::vector<bool> may_be_several = overlapping_another(parts);
    std::vector<std::uint32_t> in_doubt;
    std::ranges::copy_if(outermost, std::back_inserter(in_doubt), [&](std::uint32_t n) { return may_be_several[n]; });
    const std::uint64_t reversed = outermost.size() - in_doubt.size();
    return in_doubt.empty() ? reversed : reversed + count_by_parts(std::move(parts), in_doubt);
  }

 private:
  // A closed component, or faces of it that are joined through edges: a cavity may touch a solid at a vertex.
  struct Part {
    std::uint32_t component = 0;
    bool is_negative = false;
    ClosedSurface surface;
  };

  [[nodiscard]] std::uint32_t component_of(const Triangle& t) const { return components_.of_vertex[t[0]]; }

  // Of the components in doubt, by number in `parts`, those that have a part that is reversed by itself.
  [[nodiscard]] std::uint64_t count_by_parts(std::vector<Part> parts,
                                             const std::vector<std::uint32_t>& in_doubt) const {
    std::vector<Triangle> faces;
    for (const std::uint32_t n : in_doubt) {
      faces.insert(faces.end(), parts[n].surface.faces.begin(), parts[n].surface.faces.end());
      parts[n].surface.faces.clear();
    }
    std::erase_if(parts, [](const Part& part) { return part.surface.faces.empty(); });
    for (Part& part : parts) part.is_negative = false;  // settled
    std::ranges::move(parts_of(faces), std::back_inserter(parts));
    std::vector<std::uint32_t> components;
    for (const std::uint32_t n : outermost_negative(parts)) components.push_back(parts[n].component);
    std::ranges::sort(components);
    return static_cast<std::uint64_t>(std::unique(components.begin(), components.end()) - components.begin());
  }

  [[nodiscard]] std::vector<Part> closed_components() const {
    std::vector<Part> parts(components_.count);
    for (const Triangle& t : mesh_.triangles) {
      const std::uint32_t component = component_of(t);
      if (closed_.is_closed(component)) parts[component].surface.faces.push_back(t);
    }
    for (std::uint32_t c = 0; c < components_.count; ++c) {
      parts[c].component = c;
      parts[c].is_negative = closed_.is_negative(c);
    }
    std::erase_if(parts, [](const Part& part) { return part.surface.faces.empty(); });
    return parts;
  }

  // Of parts, by number, those of negative volume that lie within no other one.
  [[nodiscard]] std::vector<std::uint32_t> outermost_negative(const std::vector<Part>& parts) const {
    std::vector<const ClosedSurface*> surfaces;
    std::vector<std::uint32_t> negative;
    for (const Part& part : parts) {
      if (part.is_negative) negative.push_back(static_cast<std::uint32_t>(surfaces.size()));
      surfaces.push_back(&part.surface);
    }
    return not_surrounded(std::move(negative), surfaces, mesh_.vertices);
  }

  // Whether the box of each part meets that of another one.
  [[nodiscard]] std::vector<bool> overlapping_another(const std::vector<Part>& parts) const {
    std::vector<Box> boxes;
    for (const Part& part : parts) boxes.push_back(bounding_box(part.surface.faces, mesh_.vertices));
    std::vector<bool> overlaps(parts.size(), false);
    for_each_overlapping_pair(boxes, [&](std::uint32_t i, std::uint32_t j) { overlaps[i] = overlaps[j] = true; });
    return overlaps;
  }

  // The faces of components of negative volume, as they are joined through edges.
  [[nodiscard]] std::vector<Part> parts_of(const std::vector<Triangle>& faces) const {
    DisjointSets joined(faces.size());
    const std::vector<FaceEdge> edges = face_edges(faces);
    for_each_edge(edges, [&](std::span<const FaceEdge> at_edge) {
      for (const FaceEdge& edge : at_edge) joined.join(at_edge.front().face, edge.face);
    });
    std::vector<Part> parts(joined.count());
    const std::vector<std::uint32_t> part_of = joined.indices();
    for (std::size_t n = 0; n < faces.size(); ++n) parts[part_of[n]].surface.faces.push_back(faces[n]);
    std::vector<std::uint32_t> parts_in(components_.count, 0);
    for (Part& part : parts) ++parts_in[part.component = component_of(part.surface.faces.front())];
    for (Part& part : parts) {
      part.is_negative = parts_in[part.component] == 1 || volume_sign(part.surface.faces, mesh_.vertices) < 0;
    }
    return parts;
  }

  const TriangleMesh& mesh_;
  const Components& components_;
  const ClosedComponents& closed_;
};

}  // namespace

MeshDefects mesh_defects(const TriangleMesh& welded, const std::vector<ExteriorEdge>& edges, const VertexLinks& links) {
  if (welded.triangles.empty()) return {};
  const DefaultFloatingPoint guard;
  Components components;
  std::vector<std::uint32_t> opposite;
  parallel_for_each(2, [&](std::size_t n) {
    if (n == 0) components = components_of(welded, links);
    if (n == 1) opposite = opposite_faces(welded, links);
  });
  MeshDefects defects;
  defects.inconsistent_edges = count_inconsistent_edges(welded, edges);
  defects.cancelling_pairs = opposite.size() / 2;
  const ClosedComponents closed(welded, edges, components, opposite);
  defects.reversed_components = ReversedComponents(welded, components, closed).count();
  defects.negative_volume = edges.empty() && closed.whole_is_negative();
  return defects;
}

}  // namespace raycone
