// How a lattice is cut for evaluation and writing, and the memory that takes.
#pragma once

#include <cstdint>

#include "app/fields.h"
#include "core/lattice.h"
#include "io/field_writer.h"

namespace raycone {

// The slab of `lattice` that starts at index `first` along `axis`: as many whole layers as make up about 2^22 samples,
// ending where a multiple of `alignment` begins or at the lattice's end; at least one layer, or one aligned group.
[[nodiscard]] LatticeBlock slab_from(const Lattice& lattice, int axis, std::int64_t alignment, std::int64_t first);

// Bytes that the numbers of a slab take.
[[nodiscard]] double slab_memory(const LatticeBlock& slab, const FieldOptions& options);

// Bytes that the writer of `format` surely needs for `lattice`: for VDB the grids and the blocks in the making. Winding
// numbers of an open mesh and their error bounds differ everywhere; all else only at a surface.
[[nodiscard]] double writer_memory(const Lattice& lattice, FieldFormat format, const OutputDescription& description);

}  // namespace raycone
