#include "core/orientation/mesh_defects.h"

#include <emmintrin.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <iterator>
#include <mutex>
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

// Six times a signed volume, and what rounding may have done to it.
struct Volume {
  double sum = 0.0;
  double terms = 0.0;  // sum of the absolute values of all products
  std::uint64_t faces = 0;

  Volume& operator+=(const Volume& other) {
    sum += other.sum;
    terms += other.terms;
    faces += other.faces;
    return *this;
  }
  [[nodiscard]] int sure_sign() const { return sure_volume_sign(sum, terms, faces); }
};

// Of the prism between a face and the plane x = from.x: the sum over a closed surface does not depend on the plane.
Volume volume_of(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& from) {
  const double x1 = a.x - from.x, x2 = b.x - from.x, x3 = c.x - from.x;
  // y and z together: this is most of what it costs to tell what is reversed
  const __m128d first = _mm_loadu_pd(&a.y), second = _mm_sub_pd(_mm_loadu_pd(&b.y), first),
                third = _mm_sub_pd(_mm_loadu_pd(&c.y), first);
  const __m128d products = _mm_mul_pd(second, _mm_shuffle_pd(third, third, 1));
  const double forth = _mm_cvtsd_f64(products), back = _mm_cvtsd_f64(_mm_unpackhi_pd(products, products));
  return {(x1 + x2 + x3) * (forth - back),
          (std::abs(x1) + std::abs(x2) + std::abs(x3)) * (std::abs(forth) + std::abs(back) + kVolumeUnderflow), 1};
}

// Of a closed mesh of one component, in any order: only its sure sign is used.
Volume volume_of(const TriangleMesh& mesh) {
  constexpr std::size_t kGrain = std::size_t{1} << 14;
  constexpr std::size_t kAhead = 16;  // triangles: their vertices may be anywhere in memory
  const Vec3 from = mesh.vertices[mesh.triangles.front()[0]];
  Volume whole;
  std::mutex adding;
  parallel_for(mesh.triangles.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    Volume part;
    for (std::size_t i = begin; i < end; ++i) {
      if (i + kAhead < end) {
        for (const std::uint32_t v : mesh.triangles[i + kAhead]) __builtin_prefetch(&mesh.vertices[v]);
      }
      const Triangle& t = mesh.triangles[i];
      part += volume_of(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]], from);
    }
    const std::lock_guard lock(adding);
    whole += part;
  });
  return whole;
}

// The closed components of a mesh, and which of them are reversed.
class ClosedComponents {
 public:
  // `opposite`: opposite_faces(mesh).
  ClosedComponents(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges, const Components& components,
                   const std::vector<std::uint32_t>& opposite)
      : mesh_(mesh), opposite_(opposite), components_(components), open_(components.count, false) {
    for (const ExteriorEdge& edge : edges) open_[components_.of_vertex[edge.from]] = true;
    if (std::ranges::count(open_, false) == 0) return;
    add_volumes();
    set_signs();
  }

  [[nodiscard]] std::uint64_t count_reversed() const {
    const auto negative = static_cast<std::uint64_t>(std::ranges::count(signs_, -1));
    if (negative == 0 || components_.count == 1) return negative;
    std::vector<Part> parts = closed_components();
    const std::vector<std::uint32_t> outermost = outermost_negative(parts);
    if (outermost.empty()) return 0;
    const std::vector<bool> may_be_several = overlapping_another(parts);
    std::uint64_t reversed = 0;
    std::vector<Triangle> in_doubt;
    for (const std::uint32_t n : outermost) {
      if (!may_be_several[n]) {
        ++reversed;
        continue;
      }
      in_doubt.insert(in_doubt.end(), parts[n].surface.faces.begin(), parts[n].surface.faces.end());
      parts[n].surface.faces.clear();
    }
    if (in_doubt.empty()) return reversed;
    std::erase_if(parts, [](const Part& part) { return part.surface.faces.empty(); });
    for (Part& part : parts) part.is_negative = false;  // settled
    std::ranges::move(parts_of(in_doubt), std::back_inserter(parts));
    std::vector<std::uint32_t> components;
    for (const std::uint32_t n : outermost_negative(parts)) components.push_back(parts[n].component);
    std::ranges::sort(components);
    return reversed +
           static_cast<std::uint64_t>(std::unique(components.begin(), components.end()) - components.begin());
  }

  // Precondition: no component is open.
  [[nodiscard]] bool whole_is_negative() const {
    if (std::ranges::count(signs_, -1) == 0) return false;
    if (std::ranges::count(signs_, 1) == 0) return true;
    Volume whole;
    for (const Volume& volume : volumes_) whole += volume;
    if (const int sign = whole.sure_sign(); sign != 0) return sign < 0;
    return volume_sign(mesh_.triangles, mesh_.vertices) < 0;
  }

 private:
  // A closed component, or faces of it that are joined through edges: a cavity may touch a solid at a vertex.
  struct Part {
    std::uint32_t component = 0;
    bool is_negative = false;
    ClosedSurface surface;
  };

  [[nodiscard]] std::uint32_t component_of(const Triangle& t) const { return components_.of_vertex[t[0]]; }

  // Each from a vertex of its own: a component far from the origin keeps its digits.
  void add_volumes() {
    volumes_.resize(components_.count);
    if (components_.count == 1) {
      volumes_[0] = volume_of(mesh_);
      return;
    }
    std::vector<Vec3> from(components_.count);
    for (const Triangle& t : mesh_.triangles) {
      const std::uint32_t component = component_of(t);
      if (open_[component]) continue;
      const Vec3& a = mesh_.vertices[t[0]];
      Volume& volume = volumes_[component];
      if (volume.faces == 0) from[component] = a;
      volume += volume_of(a, mesh_.vertices[t[1]], mesh_.vertices[t[2]], from[component]);
    }
  }

  void set_signs() {
    signs_.assign(components_.count, 0);
    std::vector<bool> in_doubt(components_.count, false);
    for (std::uint32_t c = 0; c < components_.count; ++c) {
      signs_[c] = volumes_[c].sure_sign();
      in_doubt[c] = !open_[c] && signs_[c] == 0;
    }
    if (std::ranges::count(in_doubt, true) > 0) set_signs_exactly(in_doubt);
  }

  // Faces that cancel are left out: nearly all doubt is about double-sided surfaces, where they are all.
  void set_signs_exactly(const std::vector<bool>& in_doubt) {
    std::vector<std::pair<std::uint32_t, Triangle>> faces;  // with their components
    auto left_out = opposite_.begin();
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
      const std::uint32_t component = component_of(mesh_.triangles[i]);
      const bool cancels = left_out != opposite_.end() && *left_out == i;
      if (cancels) ++left_out;
      if (!cancels && in_doubt[component]) faces.emplace_back(component, mesh_.triangles[i]);
    }
    std::ranges::sort(faces);
    for (auto it = faces.begin(); it != faces.end();) {
      const std::uint32_t component = it->first;
      std::vector<Triangle> triangles;
      for (; it != faces.end() && it->first == component; ++it) triangles.push_back(it->second);
      signs_[component] = volume_sign(triangles, mesh_.vertices);
    }
  }

  [[nodiscard]] std::vector<Part> closed_components() const {
    std::vector<Part> parts(components_.count);
    for (const Triangle& t : mesh_.triangles) {
      if (const std::uint32_t component = component_of(t); !open_[component]) {
        parts[component].surface.faces.push_back(t);
      }
    }
    for (std::uint32_t c = 0; c < components_.count; ++c) {
      parts[c].component = c;
      parts[c].is_negative = signs_[c] < 0;
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
  const std::vector<std::uint32_t>& opposite_;
  const Components& components_;
  std::vector<bool> open_;
  std::vector<Volume> volumes_;
  std::vector<int> signs_;
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
  defects.reversed_components = closed.count_reversed();
  defects.negative_volume = edges.empty() && closed.whole_is_negative();
  return defects;
}

}  // namespace raycone
