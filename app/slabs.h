// How a lattice is cut for evaluation and writing, and the memory that takes.
#pragma once

#include <cstdint>

#include "core/lattice.h"
#include "io/field_writer.h"

namespace raycone {

// The slab of `lattice` that starts at index `first` along `axis`: as many whole layers as make up about 2^22 samples,
// ending where a multiple of `alignment` begins or at the lattice's end; at least one layer, or one aligned group.
[[nodiscard]] LatticeBlock slab_from(const Lattice& lattice, int axis, std::int64_t alignment, std::int64_t first);

// Bytes that the values of a slab take, and its diagnostics.
[[nodiscard]] double slab_memory(const LatticeBlock& slab, bool diagnostics);

// Bytes that the writer of `format` surely needs for `lattice`: for VDB the grids and the blocks in the making. Values
// of an open mesh and their error bounds differ everywhere; values of a closed one only at its surface.
[[nodiscard]] double writer_memory(const Lattice& lattice, FieldFormat format, const FieldDescription& description);

}  // namespace raycone
