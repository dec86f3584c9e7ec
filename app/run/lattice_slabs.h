// The writer of a lattice, and the slabs that it is handed: as large as memory allows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "app/input/run_limits.h"
#include "app/options/lattice_command.h"
#include "app/report/run_report.h"
#include "app/run/mesh_run.h"
#include "app/samples/slabs.h"
#include "core/data/placed_lattice.h"
#include "io/fields/field_writer.h"

namespace raycone {

// The slabs of a lattice, one after the other.
class Slabs {
 public:
  Slabs(const Lattice& lattice, const LatticeWriter& writer, std::int64_t samples)
      : lattice_(lattice), axis_(writer.slab_axis()), alignment_(writer.slab_alignment()), samples_(samples) {}

  [[nodiscard]] LatticeBlock first() const { return from(lattice_.index_min[static_cast<std::size_t>(axis_)]); }
  [[nodiscard]] LatticeBlock behind(const LatticeBlock& slab) const {
    const auto axis = static_cast<std::size_t>(axis_);
    return from(slab.first[axis] + slab.counts[axis]);
  }

 private:
  [[nodiscard]] LatticeBlock from(std::int64_t index) const {
    return slab_from(lattice_, axis_, alignment_, index, samples_);
  }

  const Lattice& lattice_;
  int axis_;
  std::int64_t alignment_, samples_;
};

// In what follows, the report is complete as far as mesh, edges and lattice go.

// Makes the writer. Before that, refuses what the format cannot hold and what does not fit in memory or on disk. Throws
// OutputError, LimitError.
[[nodiscard]] std::unique_ptr<LatticeWriter> open_lattice_writer(const LatticeCommand& command, MeshRun& run);

// Whether the writer is handed distances in blocks.
[[nodiscard]] bool takes_blocks(const LatticeCommand& command, const LatticeWriter& writer,
                                const PlacedLattice& lattice);

// Refuses a lattice if not even its smallest slab fits beside what is in memory. Throws LimitError.
void check_slab_memory(const LatticeCommand& command, const LatticeWriter& writer, const RunReport& report,
                       const RunLimits& limits);

// The slabs of the report's lattice, which must outlive them; as large as memory allows.
[[nodiscard]] Slabs slabs_of(const LatticeCommand& command, const LatticeWriter& writer, const RunReport& report,
                             const RunLimits& limits);

}  // namespace raycone
