// The paper's method written down plainly, to be measured beside raycone: what a reader of "Fast and Exact Winding
// Numbers for Triangle Meshes" (ACM TOG 45(4), 2026) would write with Embree in an afternoon. Embree's own triangle
// hits in float are taken at face value, and each exterior edge costs one atan2 per sample. Shares no code with raycone
// but the mesh, the lattice and the thread pool. Apex at infinity along -x, as docs/method.md, "One ray and a cone".
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "core/data/lattice.h"
#include "core/data/triangle_mesh.h"

namespace raycone::bench {

class PaperTranscription {
 public:
  // `welded`: equal positions are one vertex.
  explicit PaperTranscription(const TriangleMesh& welded);
  ~PaperTranscription();
  PaperTranscription(const PaperTranscription&) = delete;
  PaperTranscription& operator=(const PaperTranscription&) = delete;

  [[nodiscard]] std::size_t exterior_edges() const;

  // Winding numbers (turns) of the whole lattice, x fastest. One ray per row.
  void evaluate(const Lattice& lattice, std::span<double> values) const;

  // Winding numbers (turns) at points. One ray each.
  void evaluate(std::span<const Vec3> points, std::span<double> values) const;

 private:
  struct Implementation;
  std::unique_ptr<const Implementation> implementation_;
};

}  // namespace raycone::bench
